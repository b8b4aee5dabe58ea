"""Paints on a pair of images, as a sensor would see what is painted. Needs numpy and Pillow."""

import functools

import numpy as np
from PIL import Image, ImageDraw, ImageFont
from tum_folder import read_color, read_depth_m

COLOR_NOISE = 2.0  # levels; what is painted has the noise of a sensor, or it would be exactly the same in all frames
DEPTH_NOISE = 1.4e-3  # m at 1 m, growing with the square of the depth, as with a Kinect


class Frame:
    """A pair of images, read when something is painted on them. Those never read are unchanged."""

    def __init__(self, index, row, folder, scale):
        self.index, self.color_s, self.depth_s = index, float(row[0]), float(row[2])
        self.color_path, self.depth_path, self.scale = folder / row[1], folder / row[3], scale
        self.painted_color = self.painted_depth_m = None
        self.removed = False

    @property
    def color(self):
        if self.painted_color is None:
            self.painted_color = np.array(read_color(self.color_path))
        return self.painted_color

    @property
    def depth_m(self):
        if self.painted_depth_m is None:
            self.painted_depth_m = read_depth_m(self.depth_path, self.scale)
        return self.painted_depth_m


def resized(values, height, width):
    return np.asarray(Image.fromarray(values.astype(np.float32)).resize((width, height), Image.BILINEAR))


def texture(style, height, width, contrast, rng):
    """Levels around 128, (height, width): what corners are found on."""
    grain = max(3, width // 24)
    rows, columns = np.mgrid[:height, :width]
    if style == "checks":
        pattern = ((rows // grain + columns // grain) % 2) * 2.0 - 1
    elif style == "dots":
        pattern = np.full((height, width), -0.5)
        for y, x in rng.uniform((0, 0), (height, width), (60, 2)):
            pattern[(rows - y) ** 2 + (columns - x) ** 2 < (grain / 2) ** 2] = 1
    else:  # patches of three sizes
        pattern = np.zeros((height, width))
        for size in (grain, 2 * grain, 4 * grain):
            patches = rng.uniform(-0.6, 0.6, (height // size + 1, width // size + 1))
            pattern += np.kron(patches, np.ones((size, size)))[:height, :width]
    return 128 + 120 * contrast * pattern.clip(-1, 1)


@functools.lru_cache(maxsize=4)
def noise_field(height, width):
    return np.random.default_rng(0).standard_normal((height + 64, width + 64), np.float32)


def noise(shape, rng):
    """Normal noise: a part of a larger field at a random place, which is faster than new noise for each frame."""
    top, left = rng.integers(64, size=2)
    return noise_field(*shape)[top : top + shape[0], left : left + shape[1]]


def cover(frame, rows, columns, levels, depth_m, rng, mask=True):
    """Paints `levels` and `depth_m` with sensor noise where `mask` is set."""
    shape = levels.shape[:2]
    noisy = levels + COLOR_NOISE * noise(shape, rng)[..., None]
    measured_m = depth_m + DEPTH_NOISE * noise(shape, rng) * depth_m**2
    np.copyto(frame.color[rows, columns], noisy.clip(0, 255).astype(np.uint8), where=np.expand_dims(mask, -1))
    np.copyto(frame.depth_m[rows, columns], measured_m, where=mask)


def word_image(word, height):
    """The word as a mask of this height, from the built-in font."""
    image = Image.new("L", (200, 40))
    ImageDraw.Draw(image).text((5, 5), word, fill=255, font=ImageFont.load_default())
    image = image.crop(image.getbbox())
    return np.asarray(image.resize((max(1, image.width * height // image.height), height))) / 255


def tinted(levels, rng):
    """Grey levels with a slight colour."""
    return (levels[..., None] * rng.uniform(0.75, 1.1, 3)).clip(0, 255).astype(np.float32)


def relief_m(height, width, rng):
    """Bumps of 2 cm on what is painted."""
    return 0.02 * resized(rng.uniform(-1, 1, (6, 6)), height, width)

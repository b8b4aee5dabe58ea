"""The kinds of disturbances: things fixed to the camera, things that move, failures of a stream, other places.

In: a Frame, changed in place. Every kind has a function that prepares it for the size of the images and returns what
is done to a frame, and the parameters it takes, each with the distribution from which a seed draws it."""

import zlib
from dataclasses import dataclass
from typing import Callable

import numpy as np
from painting import COLOR_NOISE, cover, noise, relief_m, texture, tinted, word_image
from PIL import Image, ImageFilter

WORDS = ("ROBOT", "DANGER", "CART 7", "KEEP CLEAR")


@dataclass(frozen=True)
class Kind:
    """A kind of disturbance; `prepare(parameters, shape, rng)` returns `apply(frame, progress, rng)`."""

    prepare: Callable
    draws: dict  # name of a parameter -> function that draws it
    first: tuple = (0.1, 0.6)  # where it begins, as a share of the sequence
    seconds: tuple | None = None  # how long it lasts; None: to the end
    always: float = 0.0  # probability that it begins with the first frame

    @property
    def help(self):
        return self.prepare.__doc__


def uniform(low, high):
    return lambda rng: round(float(rng.uniform(low, high)), 3)


def whole(low, high):
    return lambda rng: int(rng.integers(low, high + 1))


def one_of(*values):
    return lambda rng: values[rng.integers(len(values))]


def part(p, shape, rng):
    """a grey part with screws and a word, fixed to the camera, at the bottom of the image"""
    height, width = round(p["share"] * shape[0]), shape[1]
    levels = texture("patches", height, width, p["contrast"], rng) - 10 + np.linspace(-15, 15, width)
    radius = max(2, width // 80)
    y, x = np.mgrid[:height, :width]
    for cy, cx in rng.uniform((0, 0), (height, width), (p["screws"], 2)):
        levels[(y - cy) ** 2 + (x - cx) ** 2 < radius**2] = 60
        levels[(abs(y - cy) < radius / 5) & (abs(x - cx) < radius * 0.8)] = 15
    word = word_image(WORDS[rng.integers(len(WORDS))], max(4, height // 4))[:, : width // 2]
    top, left = (height - word.shape[0]) // 2, int(rng.integers(width - word.shape[1]))
    area = levels[top : top + word.shape[0], left : left + word.shape[1]]
    area += (20 - area) * word
    depth_m = p["depth_m"] * (1 - p["slant"] * np.linspace(0, 1, height))[:, None]
    color = np.repeat(levels[..., None], 3, 2).astype(np.float32)

    def apply(frame, progress, rng):
        cover(frame, slice(shape[0] - height, None), slice(None), color, depth_m, rng)

    return apply


def object_(p, shape, rng):
    """a textured object that hovers before the camera, fixed to it"""
    area = p["share"] * shape[0] * shape[1]
    extent = np.array([np.sqrt(area / p["aspect"]), np.sqrt(area * p["aspect"])])
    if p["form"] == "ellipse":
        extent *= np.sqrt(4 / np.pi)  # the same area
    extent = np.minimum(np.maximum(extent, area / np.array(shape)[::-1]), shape)  # within the image
    height, width = extent.round().astype(int)
    top, left = round(p["y"] * (shape[0] - height)), round(p["x"] * (shape[1] - width))
    color = tinted(texture(p["texture"], height, width, p["contrast"], rng), rng)
    depth_m = p["depth_m"] + relief_m(height, width, rng)
    y, x = np.mgrid[-1 : 1 : height * 1j, -1 : 1 : width * 1j]
    mask = y**2 + x**2 <= 1 if p["form"] == "ellipse" else True

    def apply(frame, progress, rng):
        cover(frame, slice(top, top + height), slice(left, left + width), color, depth_m, rng, mask)

    return apply


def mover(p, shape, rng):
    """a textured block that crosses the view, there and back, where it is nearer than the scene"""
    height = round(max(p["tall"], p["share"]) * shape[0])
    width = round(p["share"] * shape[0] * shape[1] / height)
    color = tinted(texture(p["texture"], height, width, p["contrast"], rng), rng)
    depth_m = p["depth_m"] + relief_m(height, width, rng)
    rows = slice(shape[0] - height, None)
    sign = 1 if rng.random() < 0.5 else -1

    def apply(frame, progress, rng):
        turn = progress * p["crossings"]
        way = turn % 1 if int(turn) % 2 == 0 else 1 - turn % 1
        left = round((way if sign > 0 else 1 - way) * (shape[1] + width) - width)
        seen = slice(max(0, left), min(shape[1], left + width))
        if seen.start >= seen.stop:
            return
        own = slice(seen.start - left, seen.stop - left)
        scene_m = frame.depth_m[rows, seen]
        mask = (scene_m == 0) | (scene_m > depth_m[:, own])
        cover(frame, rows, seen, color[:, own], depth_m[:, own], rng, mask)

    return apply


def big_mover(p, shape, rng):
    """a block like mover, of 40 to 70 % of the image, for up to 5 s"""
    return mover(p, shape, rng)


def dirt(p, shape, rng):
    """spots on the lens: colour blurred and dark, depth missing if it is not only on the lens of the colour camera"""
    y, x = np.mgrid[: shape[0], : shape[1]]
    veil, light = np.zeros(shape), np.ones(shape)
    for _ in range(p["spots"]):
        cy, cx = rng.uniform((0, 0), shape)
        radius = p["radius"] * shape[1] * rng.uniform(0.5, 1.5)
        spot = ((radius - np.hypot(y - cy, x - cx)) / (0.3 * radius)).clip(0, 1)
        light = np.where(spot > veil, rng.uniform(p["light"], 1), light)
        veil = np.maximum(veil, spot)

    def apply(frame, progress, rng):
        blurred = np.asarray(Image.fromarray(frame.color).filter(ImageFilter.BoxBlur(shape[1] // 40)))
        soiled = frame.color * (1 - veil[..., None]) + blurred * (veil * light)[..., None]
        frame.color[veil > 0] = soiled[veil > 0].astype(np.uint8)
        if p["lens"] == "both":
            frame.depth_m[veil > 0.5] = 0

    return apply


def freeze(stream):
    """A kind in which the images of `stream` are those of the first frame of the disturbance."""
    path_name = f"{stream}_path"
    painted_name = "painted_color" if stream == "color" else "painted_depth_m"

    def prepare(p, shape, rng):
        held = []

        def apply(frame, progress, rng):
            if not held:
                painted = getattr(frame, painted_name)
                held.append((getattr(frame, path_name), painted if painted is None else painted.copy()))
            setattr(frame, path_name, held[0][0])
            setattr(frame, painted_name, held[0][1] if held[0][1] is None else held[0][1].copy())

        return apply

    prepare.__doc__ = f"{'colour' if stream == 'color' else stream} frozen, the other stream live"
    return prepare


def black_color(p, shape, rng):
    """colour black but for noise, depth live"""

    def apply(frame, progress, rng):
        frame.color[:] = abs(COLOR_NOISE * noise(shape, rng))[..., None].astype(np.uint8)

    return apply


def black_depth(p, shape, rng):
    """no depth, colour live"""

    def apply(frame, progress, rng):
        frame.depth_m[:] = 0

    return apply


def black(p, shape, rng):
    """colour black but for noise, no depth"""
    parts = [black_color(p, shape, rng), black_depth(p, shape, rng)]

    def apply(frame, progress, rng):
        for one in parts:
            one(frame, progress, rng)

    return apply


def blur(p, shape, rng):
    """colour blurred over a square of so many pixels, depth live"""

    def apply(frame, progress, rng):
        image = Image.fromarray(frame.color)
        frame.color[:] = np.asarray(image.filter(ImageFilter.BoxBlur((p["px"] - 1) / 2)))

    return apply


def dark(p, shape, rng):
    """colour dark, noisy and blurred, as under a desk, depth live"""
    blurred = blur(p, shape, rng)

    def apply(frame, progress, rng):
        blurred(frame, progress, rng)
        levels = p["light"] * frame.color + COLOR_NOISE * noise(shape, rng)[..., None]
        frame.color[:] = np.clip(levels, 0, 255).astype(np.uint8)

    return apply


def blank(p, shape, rng):
    """nothing but a plain wall or ceiling in view, its depth with holes, perhaps with a lamp"""
    y, x = np.mgrid[: shape[0], : shape[1]]
    light = 190 + 30 * (x / shape[1] - 0.5) * rng.uniform(-1, 1) + 30 * (y / shape[0] - 0.5) * rng.uniform(-1, 1)
    if p["lamp"]:
        cy, cx = rng.uniform(0.2, 0.8, 2) * shape
        light = light + 255 * (np.hypot(y - cy, x - cx) < shape[1] / 16)
    color = np.repeat(light[..., None], 3, 2).astype(np.float32)

    def apply(frame, progress, rng):
        cover(frame, slice(None), slice(None), color, np.full(shape, p["depth_m"]), rng)
        frame.depth_m[noise(shape, rng) < -0.84] = 0  # a fifth

    return apply


def other_room(p, shape, rng):
    """frames of another room: the mirror image of this one"""

    def apply(frame, progress, rng):
        frame.color[:] = frame.color[:, ::-1].copy()
        frame.depth_m[:] = frame.depth_m[:, ::-1].copy()

    return apply


def gap(p, shape, rng):
    """frames missing"""

    def apply(frame, progress, rng):
        frame.removed = True

    return apply


def scale(p, shape, rng):
    """all depths multiplied by a factor"""

    def apply(frame, progress, rng):
        frame.depth_m[:] *= p["factor"]

    return apply


LOOK = {"texture": one_of("patches", "checks", "dots"), "contrast": uniform(0.3, 1.0)}
MOVER = {"depth_m": uniform(0.6, 1.4), "tall": uniform(0.6, 1.0), **LOOK}

KINDS = {
    "part": Kind(part, {"share": uniform(0.1, 0.4), "depth_m": uniform(0.4, 1.0), "slant": uniform(0, 0.3),
                        "contrast": uniform(0, 0.3), "screws": whole(4, 12)}, first=(0.1, 0.4), always=0.5),
    "object": Kind(object_, {"share": uniform(0.1, 0.45), "depth_m": uniform(0.4, 0.9), "aspect": uniform(0.5, 2),
                             "x": uniform(0, 1), "y": uniform(0, 1), "form": one_of("block", "ellipse"), **LOOK},
                   seconds=(3, 12)),
    "mover": Kind(mover, {"share": uniform(0.1, 0.4), "crossings": whole(1, 6), **MOVER}, seconds=(3, 12)),
    "big_mover": Kind(big_mover, {"share": uniform(0.4, 0.7), "crossings": whole(1, 2), **MOVER}, seconds=(2, 5)),
    "dirt": Kind(dirt, {"spots": whole(15, 60), "radius": uniform(0.008, 0.03), "light": uniform(0.1, 0.7),
                         "lens": one_of("both", "color")}, always=1),
    "freeze_color": Kind(freeze("color"), {}, seconds=(1, 4)),
    "freeze_depth": Kind(freeze("depth"), {}, seconds=(1, 4)),
    "black_color": Kind(black_color, {}, seconds=(1, 5)),
    "black_depth": Kind(black_depth, {}, seconds=(1, 5)),
    "black": Kind(black, {}, seconds=(1, 5)),
    "blur": Kind(blur, {"px": whole(15, 61)}, seconds=(1, 4)),
    "dark": Kind(dark, {"px": whole(5, 25), "light": uniform(0.02, 0.1)}, seconds=(1, 4)),
    "blank": Kind(blank, {"depth_m": uniform(1, 3), "lamp": one_of(False, True)}, seconds=(2, 5)),
    "other_room": Kind(other_room, {}, seconds=(0.3, 5)),
    "gap": Kind(gap, {}, seconds=(1, 5)),
    "scale": Kind(scale, {"factor": uniform(0.85, 1.15)}),
}


class Disturbance:
    """A kind with its parameters, in the frames from `first` to `last`."""

    def __init__(self, name, given, seed, stamps_s, shape):
        self.name, self.kind, self.seed = name, KINDS[name], [seed, zlib.crc32(name.encode())]
        unknown = set(given) - {*self.kind.draws, "first", "seconds"}
        if unknown:
            known = ", ".join([*self.kind.draws, "first", "seconds"])
            raise ValueError(f"{name} has no parameter {', '.join(sorted(unknown))}, only {known}")
        rng = np.random.default_rng(self.seed)
        # All are drawn even if given, so that giving one does not change the others.
        drawn = {key: draw(rng) for key, draw in self.kind.draws.items()}
        self.parameters = {**drawn, **self.draw_time(rng, stamps_s), **given}
        self.first = min(int(self.parameters["first"]), len(stamps_s) - 1)
        end_s = stamps_s[self.first] + self.parameters.get("seconds", np.inf)
        self.last = max(self.first, int(np.searchsorted(stamps_s, end_s - 1e-6)) - 1)
        self.apply = self.kind.prepare(self.parameters, shape, rng)

    def draw_time(self, rng, stamps_s):
        """Of a sequence that is too short, at most a third is disturbed."""
        always, first = rng.random() < self.kind.always, rng.uniform(*self.kind.first)
        time = {"first": 0 if always else int(first * len(stamps_s))}
        if self.kind.seconds:
            most_s = (stamps_s[-1] - stamps_s[0]) / 3
            time["seconds"] = round(min(float(rng.uniform(*self.kind.seconds)), most_s), 2)
        return time

    def paint(self, frame):
        if self.first <= frame.index <= self.last:
            progress = (frame.index - self.first) / (self.last - self.first + 1)
            self.apply(frame, progress, np.random.default_rng([*self.seed, frame.index]))

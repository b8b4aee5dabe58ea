"""Reads and writes the files of a sequence in TUM layout, for the scripts that change one. Needs numpy and Pillow."""

import numpy as np
from PIL import Image


def rows_of(path):
    """The lines of a TUM list without comments, split."""
    return [line.split() for line in path.read_text().splitlines() if line.strip() and line[0] != "#"]


def pose_matrix(row):
    """The pose (4, 4) of a row of a trajectory: stamp, tx, ty, tz, qx, qy, qz, qw."""
    row = np.asarray(row, float)
    x, y, z, w = row[4:8] / np.linalg.norm(row[4:8])
    pose = np.eye(4)
    pose[:3, :3] = [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                    [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                    [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]
    pose[:3, 3] = row[1:4]
    return pose


def depth_scale(folder):
    """Units of the depth images per metre."""
    for line in (folder / "camera.yaml").read_text().splitlines():
        if line.startswith("depth_scale:"):
            return float(line.split()[1])
    return 5000.0


def read_color(path):
    """RGB, 8 bits."""
    return np.asarray(Image.open(path).convert("RGB"))


def read_depth_m(path, scale):
    return np.asarray(Image.open(path), float) / scale


def write_color(path, color):
    """JPEG, hardly compressed, if the name says so, else PNG."""
    image = Image.fromarray(np.asarray(color).clip(0, 255).astype(np.uint8))
    options = {"quality": 97, "subsampling": 0} if path.suffix == ".jpg" else {"compress_level": 1}
    image.save(path, **options)


def write_depth_m(path, depth_m, scale):
    units = (depth_m * scale).round().clip(0, 65535).astype(np.uint16)
    Image.fromarray(units).save(path, compress_level=1)

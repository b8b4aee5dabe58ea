"""The space in which something moved in a simulated sequence, and how many points of a cloud lie in it.

In: folders of `kinloop simulate` (Kinect 1) with what moves and of the same room without it, and clouds in the world of
their ground truth. Out: voxels that movers occupied at any time, without those next to surfaces at rest. Movers are
known where the camera saw them. Needs numpy and Pillow."""

from dataclasses import dataclass

import numpy as np
import trajectory_error
from PIL import Image, ImageFilter

VOXEL_M = 0.04
FUSED_VOXEL_M = 0.01  # that of map.ply
MOST_FUSED_M = 4.0
STEP_PX = 2
STEP_VIEWS = 3  # for what is at rest
DELAY_S = 0.015  # of simulated depth relative to its stamp
BLOCK_PX, BLOCKS = 8, 2  # depth is up to half a period from its picture of movers; pixels so near to one are unclear
MOVING = 255
BITS = 21  # of each axis in the key of a voxel
NEIGHBOURS = [(x << 2 * BITS) + (y << BITS) + z for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1)]
PLY_TYPES = {"float": "<f4", "double": "<f8", "uchar": "u1", "char": "i1", "ushort": "<u2", "short": "<i2",
             "uint": "<u4", "int": "<i4"}


def keys_of(points, voxel_m):
    """One number for the voxel of each point."""
    x, y, z = (np.floor(points / voxel_m).astype(np.int64) + (1 << (BITS - 1))).T
    return (x << 2 * BITS) + (y << BITS) + z


def grown(keys):
    """The voxels and all that touch them."""
    return np.unique(np.concatenate([keys + step for step in NEIGHBOURS]))


def united(lists):
    return np.unique(np.concatenate([np.zeros(0, np.int64), *lists]))


def share_within(points, space):
    """How many of the points are in the voxels `space`."""
    return float(np.isin(keys_of(points, VOXEL_M), space).mean()) if len(points) else 0.0


def read_settings(file):
    """The numbers of camera.yaml."""
    lines = [line.partition("#")[0].partition(":") for line in file.read_text().splitlines()]
    words = {key.strip(): value.strip() for key, _, value in lines if value.strip()}
    read = {key: float(words[key]) for key in ("width", "height", "fx", "fy", "cx", "cy", "depth_scale")}
    read["distortion"] = [float(word) for word in words.get("distortion", "[0, 0, 0, 0, 0]").strip("[]").split(",")]
    return read


def rays_of(camera):
    """The direction of each pixel, z = 1, by iterated removal of the lens distortion."""
    u, v = np.meshgrid(np.arange(camera["width"]), np.arange(camera["height"]))
    x0, y0 = (u - camera["cx"]) / camera["fx"], (v - camera["cy"]) / camera["fy"]
    k1, k2, p1, p2, k3 = camera["distortion"]
    x, y = x0, y0
    for _ in range(20):
        r2 = x * x + y * y
        radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3))
        x, y = ((x0 - 2 * p1 * x * y - p2 * (r2 + 2 * x * x)) / radial,
                (y0 - p1 * (r2 + 2 * y * y) - 2 * p2 * x * y) / radial)
    return np.stack([x, y, np.ones_like(x)], -1)


def read_list(file):
    """Stamps and names of rgb.txt or depth.txt."""
    rows = [line.split() for line in file.read_text().splitlines() if line.strip() and line[0] != "#"]
    return np.array([float(row[0]) for row in rows]), [row[1] for row in rows]


def pose_at(path, stamp_s):
    """Rotation and centre between two poses of the path, or nothing outside of it."""
    after = np.searchsorted(path.stamps_s, stamp_s)
    if after in (0, len(path)):
        return None
    before_s, after_s = path.stamps_s[after - 1:after + 1]
    weight = (stamp_s - before_s) / (after_s - before_s)
    u, _, vt = np.linalg.svd((1 - weight) * path.rotations[after - 1] + weight * path.rotations[after])
    return u @ vt, (1 - weight) * path.centers[after - 1] + weight * path.centers[after]


def unclear(moving):
    """Pixels that movers may cover in a picture taken a little earlier or later."""
    height, width = moving.shape
    blocks = moving.reshape(height // BLOCK_PX, BLOCK_PX, width // BLOCK_PX, BLOCK_PX).any((1, 3))
    near = Image.fromarray(blocks.astype(np.uint8)).filter(ImageFilter.MaxFilter(2 * BLOCKS + 1))
    return np.asarray(near).repeat(BLOCK_PX, 0).repeat(BLOCK_PX, 1) > 0


@dataclass
class View:
    """One depth image: where it is known, directions and distances there, and the pose of the camera."""

    rays: np.ndarray
    depths_m: np.ndarray
    rotation: np.ndarray
    center: np.ndarray
    moving: np.ndarray  # pixels of movers
    at_rest: np.ndarray  # surely none

    def keys(self, pixels, voxel_m=VOXEL_M):
        """The voxels that some of the pixels saw."""
        points = (self.rays[pixels] * self.depths_m[pixels][:, None]) @ self.rotation.T + self.center
        return np.unique(keys_of(points, voxel_m))


class Sequence:
    """A folder of `kinloop simulate`."""

    def __init__(self, folder):
        self.folder = folder
        self.camera = read_settings(folder / "camera.yaml")
        self.rays = rays_of(self.camera)[::STEP_PX, ::STEP_PX]
        self.truth = trajectory_error.read_path(folder / "groundtruth.txt")
        self.color_stamps_s, self.color_names = read_list(folder / "rgb.txt")

    def moving(self, stamp_s):
        """Where the movers are in the colour image next to a stamp."""
        name = self.color_names[abs(self.color_stamps_s - stamp_s).argmin()]
        file = self.folder / "movers" / name.rpartition("/")[2]
        if not file.exists():
            return np.zeros((int(self.camera["height"]), int(self.camera["width"])), bool)
        return np.asarray(Image.open(file)) == MOVING

    def views(self, step=1):
        for stamp_s, name in list(zip(*read_list(self.folder / "depth.txt")))[::step]:
            pose = pose_at(self.truth, stamp_s + DELAY_S)
            if pose:
                yield self.view(stamp_s + DELAY_S, name, *pose)

    def view(self, stamp_s, name, rotation, center):
        depths_m = np.asarray(Image.open(self.folder / name))[::STEP_PX, ::STEP_PX] / self.camera["depth_scale"]
        moving, known = self.moving(stamp_s), depths_m > 0
        at_rest = ~unclear(moving)
        return View(self.rays[known], depths_m[known], rotation, center, moving[::STEP_PX, ::STEP_PX][known],
                    at_rest[::STEP_PX, ::STEP_PX][known])


class MoverSpace:
    """What the views of a sequence with movers, and of the same room without, tell."""

    def __init__(self, crowded, empty):
        self.crowded = Sequence(crowded)
        moved = united([view.keys(view.moving) for view in self.crowded.views()])
        resting = [view.keys(view.at_rest) for view in self.crowded.views(STEP_VIEWS)]
        resting += [view.keys(view.at_rest) for view in Sequence(empty).views(STEP_VIEWS)]
        self.voxels = np.setdiff1d(moved, grown(united(resting)), assume_unique=True)
        self.kept_share = len(self.voxels) / max(1, len(moved))

    def raw_cloud(self):
        """Depth fused like a map but with nothing left out: voxels of 1 cm that two images saw."""
        lists = [view.keys(view.depths_m < MOST_FUSED_M, FUSED_VOXEL_M) for view in self.crowded.views(STEP_VIEWS)]
        keys, counts = np.unique(np.concatenate(lists), return_counts=True)
        keys = keys[counts > 1]
        indices = np.stack([keys >> 2 * BITS, keys >> BITS, keys], 1) & ((1 << BITS) - 1)
        return (indices - (1 << (BITS - 1)) + 0.5) * FUSED_VOXEL_M


def read_ply(file):
    """The points of a binary PLY file."""
    data = file.read_bytes()
    header, _, body = data.partition(b"end_header\n")
    lines = [line.split() for line in header.decode().splitlines()]
    element, count, fields = None, 0, []
    for line in lines:
        if line[0] == "element":
            element, count = line[1], int(line[2]) if line[1] == "vertex" else count
        elif line[0] == "property" and element == "vertex":
            fields.append((line[2], PLY_TYPES[line[1]]))
    rows = np.frombuffer(body, np.dtype(fields), count)
    return np.stack([rows[axis] for axis in "xyz"], 1).astype(float)


def map_in_truth(run, truth):
    """The points of map.ply of a run with --frame camera, aligned by what most frames of its trajectory agree on."""
    path, true_path = trajectory_error.matched(trajectory_error.read_path(run / "trajectory.txt"), truth)
    rotation, translation = trajectory_error.robust(path, true_path)
    return read_ply(run / "map.ply") @ rotation.T + translation

"""Worlds in which places look alike, drawn from seeds and rendered by `kinloop simulate`; two visits of each, their maps
and the loops between them. The kinds are those that bench/loops tells of. Needs numpy and Pillow."""

import json
import pathlib
import re
import subprocess

import numpy as np
from tum_folder import depth_scale, pose_matrix, read_color, read_depth_m, rows_of, write_color, write_depth_m

TRUE_KINDS = {"same", "moved", "turned", "dark"}
GAP_S = 3.0
TURNED_RAD, AHEAD_M = np.pi / 4, 2.0


def quaternion(rotation):
    """x, y, z, w of a rotation matrix."""
    w = np.sqrt(max(0.0, 1 + np.trace(rotation))) / 2
    if w > 1e-6:
        parts = np.array([rotation[2, 1] - rotation[1, 2], rotation[0, 2] - rotation[2, 0],
                          rotation[1, 0] - rotation[0, 1]]) / (4 * w)
        return np.append(parts, w)
    values, vectors = np.linalg.eigh(rotation + np.eye(3))
    return np.append(vectors[:, np.argmax(values)], 0.0)


def turn(vector):
    """The rotation about a vector by its length, rad."""
    angle = np.linalg.norm(vector)
    if angle == 0:
        return np.eye(3)
    x, y, z = vector / angle
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def motion(rotation, translation):
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = rotation, translation
    return pose


def write_path(file, stamps_s, poses):
    lines = [" ".join(f"{value:.6f}" for value in (stamp_s, *pose[:3, 3], *quaternion(pose[:3, :3])))
             for stamp_s, pose in zip(stamps_s, poses)]
    file.write_text("\n".join(lines) + "\n")


class Renderer:
    """Renders visits, 320 x 240 at 10 Hz, into a folder for scratch."""

    def __init__(self, program, scratch, frames):
        self.program, self.scratch, self.frames = program, scratch, frames

    def simulate(self, name, seed, *arguments):
        folder = self.scratch / name
        subprocess.run([self.program, "simulate", "room", "--seed", str(seed), "-o", folder, "-q", "--threads", "1",
                        *map(str, arguments)], check=True)
        return folder

    def path_of(self, seed):
        folder = self.scratch / f"path_{seed}"
        if not folder.exists():
            self.simulate(folder.name, seed, "--size", "32x24", "--fps", 10, "--frames", self.frames)
        rows = rows_of(folder / "groundtruth.txt")
        return [float(row[0]) for row in rows], [pose_matrix(row) for row in rows]

    def along(self, name, seed, stamps_s, poses, *arguments):
        file = self.scratch / f"{name}.txt"
        write_path(file, stamps_s, poses)
        return self.simulate(name, seed, "--size", "320x240", "--path", file, *arguments)


def shifted(stamps_s):
    """The stamps of the second visit."""
    return [stamp_s + stamps_s[-1] - stamps_s[0] + GAP_S for stamp_s in stamps_s]


def scale_depth(folder, factor, since_s):
    units = depth_scale(folder)
    for row in rows_of(folder / "depth.txt"):
        if float(row[0]) >= since_s:
            file = folder / row[1]
            write_depth_m(file, factor * read_depth_m(file, units), units)


def darken(folder, since_s):
    """Scales the brightness of the images since a stamp to a third, and adds noise."""
    for row in rows_of(folder / "rgb.txt"):
        if float(row[0]) < since_s:
            continue
        color = read_color(folder / row[1])
        noise = np.random.default_rng(round(1e3 * float(row[0]))).normal(0, 3, color.shape)
        write_color(folder / row[1], color / 3 + noise)


def append(first, second, prefix="second"):
    """Adds the images of a sequence to another."""
    for name in ("rgb", "depth"):
        lines = []
        for row in rows_of(second / f"{name}.txt"):
            target = f"{name}/{prefix}_{pathlib.Path(row[1]).name}"
            (second / row[1]).rename(first / target)
            lines.append(f"{row[0]} {target}\n")
        with open(first / f"{name}.txt", "a") as file:
            file.writelines(lines)
    with open(first / "groundtruth.txt", "a") as file:
        file.writelines(" ".join(row) + "\n" for row in rows_of(second / "groundtruth.txt"))
    (first / "associations.txt").unlink(missing_ok=True)


def draw_world(renderer, kind, seed):
    """The sequence, the stamp at which the second visit begins, and the scale drawn."""
    random = np.random.default_rng(seed)
    factor = random.uniform(0.85, 0.98)
    stamps_s, poses = renderer.path_of(seed)
    aside = motion(turn(random.normal(0, 0.03, 3)), random.normal(0, 0.05, 3))
    again = [pose @ aside for pose in poses]
    later_s = shifted(stamps_s)
    if kind == "floor":
        floors = [renderer.along(f"floor_{i}", seed, stamps_s + later_s, poses + again, "--set", f"floor={i}")
                  for i in (1, 2)]
        parts = [list(split(floor, later_s[0] - GAP_S / 2, floor / "parts")) for floor in floors]
        append(parts[0][0], parts[1][1])
        return parts[0][0], later_s[0], None
    if kind in ("double", "other"):
        sequence = renderer.along("visit", seed, stamps_s, poses)
        if kind == "double":
            again = [motion(pose[:3, :3], factor * pose[:3, 3]) for pose in again]
        append(sequence, renderer.along("second", seed if kind == "double" else seed + 1000, later_s, again))
        return sequence, later_s[0], factor if kind == "double" else None
    if kind == "turned":
        ahead = np.array([0, 0, AHEAD_M])
        about = motion(turn(np.array([0, TURNED_RAD * random.choice([-1, 1]), 0])), np.zeros(3))
        again = [pose @ motion(np.eye(3), ahead) @ about @ motion(np.eye(3), -ahead) for pose in again]
    chairs = ["--set", "movers.chairs=3"] if kind == "moved" else []
    sequence = renderer.along("visit", seed, stamps_s + later_s, poses + again, *chairs)
    if kind == "dark":
        darken(sequence, later_s[0] - GAP_S / 2)
    if kind != "depth":
        return sequence, later_s[0], None
    scale_depth(sequence, factor, later_s[0] - GAP_S / 2)
    return sequence, later_s[0], factor


def split(sequence, second_s, scratch):
    """A folder for each visit, with the images of the sequence."""
    for name, wanted in (("first", lambda stamp_s: stamp_s < second_s), ("second", lambda stamp_s: stamp_s >= second_s)):
        folder = scratch / f"only_{name}"
        folder.mkdir(parents=True)
        for images in ("rgb", "depth"):
            (folder / images).symlink_to(sequence / images)
        (folder / "camera.yaml").write_text((sequence / "camera.yaml").read_text())
        for table in ("rgb.txt", "depth.txt", "groundtruth.txt"):
            rows = [row for row in rows_of(sequence / table) if wanted(float(row[0]))]
            (folder / table).write_text("".join(" ".join(row) + "\n" for row in rows))
        yield folder


def run_quietly(program, sequence, out, *arguments):
    subprocess.run([program, "run", sequence, "-o", out, "-q", "--threads", "1", "--autosave", "0", *arguments],
                   stderr=subprocess.DEVNULL)
    return out


def map_both(program, sequence, second_s, out):
    """Maps both visits in one run; its loops between them, and the frames of the second located in the map of the first."""
    ended = subprocess.run([program, "run", sequence, "-o", out, "-q", "--threads", "1", "--autosave", "0"],
                           stderr=subprocess.PIPE, text=True)
    row = {"exit_code": ended.returncode}
    if not (out / "run.json").exists():
        return {**row, "error": ended.stderr.strip().splitlines()[-1:] or ["no result"]}
    row.update(count_loops(json.loads((out / "run.json").read_text()), second_s - GAP_S / 2))
    stamps_s = [float(words[0]) for words in rows_of(out / "trajectory.txt")]
    late = sum(stamp_s > second_s - GAP_S / 2 for stamp_s in stamps_s)
    row["one_world"] = 0 < late < len(stamps_s)
    row["found"] = late if row["one_world"] else 0
    return row


def map_each(program, sequence, second_s, scratch):
    """Maps each visit by itself, with the map in scratch/NAME.kinmap; the sequences of both."""
    visits = list(split(sequence, second_s - GAP_S / 2, scratch))
    for folder in visits:
        run_quietly(program, folder, scratch / f"{folder.name}_run", "--save-map", scratch / f"{folder.name}.kinmap")
    return visits


def merge(program, first, second, scratch):
    """The loops with which the maps of both visits are joined."""
    maps = [scratch / f"{folder.name}.kinmap" for folder in (first, second)]
    both = scratch / "both.kinmap"
    done = subprocess.run([program, "map", "merge", *maps, "-o", both], capture_output=True, text=True)
    found = re.search(r"(\d+) loops between", done.stdout)
    return int(found[1]) if found else 0


def false_loops(kind, row):
    """Loops of a row that join what are two places; two places in one world count as one."""
    if kind in TRUE_KINDS:
        return 0
    return row["accepted"] + row["one_world"] + row["merged"]


def count_loops(result, second_s):
    """Loops between the visits by status; a program without statuses has accepted all."""
    counts = {"accepted": 0, "provisional": 0, "rejected": 0, "withdrawn": 0, "within": 0}
    reasons = {}
    for loop in result["loops"] + result.get("other_loops", []):
        between = min(float(loop["stamp_a"]), float(loop["stamp_b"])) < second_s <= max(float(loop["stamp_a"]),
                                                                                       float(loop["stamp_b"]))
        status = loop.get("status", "accepted")
        counts[status if between else "within"] += 1
        if between:
            reasons.setdefault(status, []).append([loop.get("reason"), loop.get("scale"), loop.get("support")])
    return {**counts, "loops": reasons}

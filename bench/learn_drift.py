#!/usr/bin/env python3
"""Learns how far odometry drifts per metre of path: the constants of kinloop/belief/relative_covariance.cpp.

Runs simulated rooms, with and without people, without loops, and compares the motions between frames with the truth. The
seeds 110 to 139 are for learning: no test and no table uses them. For others it says how many motions the test of the program
refuses (the covariances of the steps, which would allow for more, left out). Needs numpy.

    bench/learn_drift.py
    bench/learn_drift.py --seeds 150-159
"""

import argparse
import pathlib
import re
import subprocess
import sys

import numpy as np

SOURCE = pathlib.Path(__file__).resolve().parent.parent
sys.path[:0] = [str(SOURCE / "scripts"), str(SOURCE / "bench")]

from rooms import simulate_room
from trajectory_error import matched, read_path

LEARNING = "110-139"
VARIANTS = ["room", "people", "room", "all"]  # by seed
LENGTHS_M = [1, 2, 4, 8, 16]
FITTED_FROM_M = 4  # shorter motions show the errors of single poses instead
STEP = 10  # frames between the beginnings of motions
QUANTILE = 0.99
SIGMAS = 3.368  # that the length of a vector exceeds with a probability of 1 %: chi with three degrees of freedom


def constant(name):
    """A constant of the program."""
    text = (SOURCE / "kinloop/belief/relative_covariance.cpp").read_text()
    return float(re.search(rf"\b{name} = ([\d.]+)", text)[1])


def angles_rad(rotations):
    return np.arccos(np.clip((np.trace(rotations, axis1=-2, axis2=-1) - 1) / 2, -1, 1))


def motions(path, begin, end):
    """The motions from frames to later ones: rotations and translations in the axes of the first."""
    back = np.swapaxes(path.rotations[begin], 1, 2)
    moved_m = path.centers[end] - path.centers[begin]
    return back @ path.rotations[end], (back @ moved_m[..., None])[..., 0]


def drift(estimate, truth):
    """Yields (length of the path, errors of translation, errors of rotation) of many motions of each length."""
    count = len(truth)
    turned, moved_m = motions(truth, np.arange(count - 1), np.arange(1, count))
    travelled_m = np.concatenate([[0], np.cumsum(np.linalg.norm(moved_m, axis=1) + angles_rad(turned))])
    for length_m in LENGTHS_M:
        begin = np.arange(0, count, STEP)
        end = np.searchsorted(travelled_m, travelled_m[begin] + length_m)
        begin, end = begin[end < count], end[end < count]
        rotations, translations = motions(estimate, begin, end)
        true_rotations, true_translations = motions(truth, begin, end)
        off_rad = angles_rad(np.swapaxes(rotations, 1, 2) @ true_rotations)
        yield length_m, np.linalg.norm(translations - true_translations, axis=1), off_rad


def run(program, seed, work):
    folder, out = work / f"room{seed}", work / f"out{seed}"
    if not folder.exists():
        size = ["--size", "320x240", "--fps", "10", "--frames", "300"]
        simulate_room(program, VARIANTS[seed % len(VARIANTS)], seed, folder, size)
    subprocess.run([program, "run", folder, "-o", out, "-q", "--no-loop"], check=False)
    return matched(read_path(out / "trajectory.txt"), read_path(folder / "groundtruth.txt"))


def per_metre(errors, measured):
    """The standard deviation per metre of path that explains the quantile of the errors of each length."""
    sigmas = {length: np.quantile(off, QUANTILE) / SIGMAS for length, off in errors.items() if len(off) > 0}
    return {length: np.sqrt(max(sigma**2 - measured**2, 0)) / length for length, sigma in sigmas.items()}


def squares(length, off_m, off_rad):
    """What the test of the program compares with its limit."""
    variances = [constant(f"kMeasured_{unit}") ** 2 + (constant(f"kDriftPerMetre_{unit}") * length) ** 2 for unit in ("m", "rad")]
    return np.square(off_m) / variances[0] + np.square(off_rad) / variances[1]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", default=SOURCE / "build/release/apps/kinloop", type=pathlib.Path)
    parser.add_argument("--seeds", default=LEARNING, help="first and last (default: %(default)s)")
    parser.add_argument("--work", default=pathlib.Path("/tmp/kinloop-drift"), type=pathlib.Path, help="rooms and results")
    args = parser.parse_args()
    args.work.mkdir(parents=True, exist_ok=True)
    off_m, off_rad = ({length: [] for length in LENGTHS_M} for _ in range(2))
    first, last = map(int, args.seeds.split("-"))
    for seed in range(first, last + 1):
        for length, metres, radians in drift(*run(args.program, seed, args.work)):
            off_m[length].extend(metres)
            off_rad[length].extend(radians)
    by_m, by_rad = per_metre(off_m, constant("kMeasured_m")), per_metre(off_rad, constant("kMeasured_rad"))
    print("path_m  motions  median_m  median_rad  sigma_m_per_m  sigma_rad_per_m  refused")
    for length in by_m:
        refused = (squares(length, off_m[length], off_rad[length]) > constant("kMaxSquare")).sum()
        print(f"{length:6} {len(off_m[length]):8} {np.median(off_m[length]):9.4f} {np.median(off_rad[length]):11.4f} "
              f"{by_m[length]:14.4f} {by_rad[length]:16.4f} {refused:8}")
    if args.seeds == LEARNING:
        fitted = [length for length in by_m if length >= FITTED_FROM_M]
        print(f"kDriftPerMetre_m = {np.mean([by_m[i] for i in fitted]):.4f}, "
              f"kDriftPerMetre_rad = {np.mean([by_rad[i] for i in fitted]):.4f}")


if __name__ == "__main__":
    main()

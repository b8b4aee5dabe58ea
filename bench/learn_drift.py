#!/usr/bin/env python3
"""Learns how far odometry drifts per metre of path: the constants of kinloop/belief/relative_covariance.cpp.

Runs simulated rooms, with and without people, without loops, and compares the motions between frames with the truth. The
seeds are for learning: no test and no table uses them. Needs numpy.

    bench/learn_drift.py --work /tmp/drift
"""

import argparse
import pathlib
import subprocess
import sys

import numpy as np

SOURCE = pathlib.Path(__file__).resolve().parent.parent
sys.path[:0] = [str(SOURCE / "scripts"), str(SOURCE / "bench")]

from rooms import simulate_room
from trajectory_error import matched, read_path

SEEDS = range(110, 140)
VARIANTS = ["room", "people", "room", "all"]  # by seed
LENGTHS_M = [1, 2, 4, 8, 16]
FITTED_FROM_M = 4  # shorter motions show the errors of single poses instead
STEP = 10  # frames between the beginnings of motions
QUANTILE = 0.99
SIGMAS = 3.368  # that the length of a vector exceeds with a probability of 1 %: chi with three degrees of freedom
MEASURED_M = MEASURED_RAD = 0.016  # of a relative pose without any drift, as in relative_covariance.cpp


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


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", default=SOURCE / "build/release/apps/kinloop", type=pathlib.Path)
    parser.add_argument("--work", default=pathlib.Path("/tmp/kinloop-drift"), type=pathlib.Path, help="rooms and results")
    args = parser.parse_args()
    args.work.mkdir(parents=True, exist_ok=True)
    off_m, off_rad = ({length: [] for length in LENGTHS_M} for _ in range(2))
    for seed in SEEDS:
        for length, metres, radians in drift(*run(args.program, seed, args.work)):
            off_m[length].extend(metres)
            off_rad[length].extend(radians)
    by_m, by_rad = per_metre(off_m, MEASURED_M), per_metre(off_rad, MEASURED_RAD)
    print("path_m  motions  median_m  median_rad  sigma_m_per_m  sigma_rad_per_m")
    for length in by_m:
        print(f"{length:6} {len(off_m[length]):8} {np.median(off_m[length]):9.4f} {np.median(off_rad[length]):11.4f} "
              f"{by_m[length]:14.4f} {by_rad[length]:16.4f}")
    fitted = [length for length in by_m if length >= FITTED_FROM_M]
    print(f"kDriftPerMetre_m = {np.mean([by_m[i] for i in fitted]):.4f}, "
          f"kDriftPerMetre_rad = {np.mean([by_rad[i] for i in fitted]):.4f}")


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""Error of the walls and of the area of `kinloop plan` in simulated rooms.

    bench/floor_plan.py KINLOOP SEED... [--folder FOLDER]

Runs the rooms `sim:room:SEED` unless FOLDER has them, draws their plans and compares these with the rooms, whose walls
are 1.45 m from the path of the camera on every side (simulator/room/room.cpp). The plan is aligned by the trajectory.
"""

import argparse
import json
import subprocess
from pathlib import Path

import numpy as np

WALL_MARGIN_M = 1.45
MIN_SIDE_M = 3.6


def read_trajectory(path):
    """Stamps and positions of a TUM file."""
    rows = np.loadtxt(path)
    return rows[:, 0], rows[:, 1:4]


def rotation_matrix(x, y, z, w):
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])


def rigid_alignment(a, b):
    """R, t with b = R a + t (Horn 1987)."""
    mean_a, mean_b = a.mean(0), b.mean(0)
    u, _, vt = np.linalg.svd((b - mean_b).T @ (a - mean_a))
    r = u @ np.diag([1, 1, np.linalg.det(u @ vt)]) @ vt
    return r, mean_b - r @ mean_a


def file_to_truth(run):
    """R, t from the frame of the plan to that of the ground truth."""
    stamps, positions = read_trajectory(run / "trajectory.txt")
    true_stamps, true_positions = read_trajectory(run / "groundtruth.txt")
    at_stamps = np.stack([np.interp(stamps, true_stamps, true_positions[:, k]) for k in range(3)], axis=1)
    figures = json.loads((run / "run.json").read_text())
    r_file = rotation_matrix(*figures["map"]["rotation_xyzw"])
    return rigid_alignment(positions @ r_file.T, at_stamps)


def compare(run, plan):
    """Errors of the walls in metres, of the area relative to the true one, and the share of the outline that no wall
    of the plan is within 10 cm of."""
    _, path = read_trajectory(run / "groundtruth.txt")
    low, high = path.min(0)[:2], path.max(0)[:2]
    middle, size = (low + high) / 2, np.maximum(high - low + 2 * WALL_MARGIN_M, MIN_SIDE_M)
    r, t = file_to_truth(run)
    to_truth = lambda p: (r @ [*p, plan["floor_z_m"]] + t)[:2] - middle
    errors = []
    for room in plan["rooms"]:
        for wall in room["walls"]:
            a, b = to_truth(wall["from"]), to_truth(wall["to"])
            axis = int(np.argmin(np.abs(b - a)))  # across the wall
            if wall["length_m"] < 0.5:
                continue
            offset = (a + b)[axis] / 2
            errors.append((abs(offset) - size[axis] / 2, wall["length_m"]))
    area = sum(room["area_m2"] for room in plan["rooms"])
    return errors, area, float(size.prod())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("kinloop")
    parser.add_argument("seeds", nargs="+", type=int)
    parser.add_argument("--folder", type=Path, default=Path("floor_plans"))
    arguments = parser.parse_args()
    print("| room | walls | largest error of a wall, cm | area, m2 | true, m2 | error, % |")
    print("|---|---|---|---|---|---|")
    for seed in arguments.seeds:
        run = arguments.folder / f"r{seed}"
        if not (run / "map.kinmap").exists():
            subprocess.run([arguments.kinloop, "run", f"sim:room:{seed}", "-q", "-o", run], check=True)
        outputs = [run / name for name in ("plan.json", "plan.svg", "plan.png", "plan.pdf")]
        options = [word for output in outputs for word in ("-o", str(output))]
        subprocess.run([arguments.kinloop, "plan", run, "-q", *options], check=True)
        errors, area, true_area = compare(run, json.loads(outputs[0].read_text()))
        worst = max((abs(error) for error, _ in errors), default=float("nan"))
        print(f"| {seed} | {len(errors)} | {100 * worst:.1f} | {area:.2f} | {true_area:.2f} "
              f"| {100 * (area / true_area - 1):+.1f} |", flush=True)
        print("   ", " ".join(f"{100 * e:+.1f}/{l:.1f}m" for e, l in errors), flush=True)


if __name__ == "__main__":
    main()

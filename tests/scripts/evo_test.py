#!/usr/bin/env python3
"""Compares kinloop eval with the package evo on ten pairs of trajectories: all statistics must agree to 1e-9.

Usage: evo_test.py KINLOOP SHARED_DATA      skipped (77) without evo, which scripts/install_test_packages.sh installs
"""

import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

try:
    import numpy as np
    from evo.core import metrics, sync, trajectory
    from evo.tools import file_interface
except ImportError as error:
    print(f"skipped: {error}; see scripts/install_test_packages.sh")
    sys.exit(77)

KINLOOP, SHARED = sys.argv[1], Path(sys.argv[2])
TOLERANCE = 1e-9
STATISTICS = ("rmse", "mean", "median", "std", "min", "max")


def quaternions(vectors):
    """Rotation vectors as quaternions w x y z."""
    angles = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.hstack([np.cos(angles / 2), vectors * np.sinc(angles / (2 * np.pi)) / 2])


def walk(seed, rate_hz, seconds=12.0, begin_s=1305031910.0):
    """A handheld path, whose stamps jitter."""
    rng = np.random.default_rng(seed)
    t = np.arange(0, seconds, 1 / rate_hz) + rng.uniform(0, 0.3 / rate_hz, int(np.ceil(seconds * rate_hz)))
    xyz = np.stack([np.sin(t), 0.5 * np.cos(1.7 * t), 0.2 * t], 1)
    turns = np.stack([0.3 * np.sin(t), 0.5 * np.cos(0.4 * t), 0.2 * np.sin(1.3 * t)], 1)
    return trajectory.PoseTrajectory3D(xyz, quaternions(turns), np.round(begin_s + t, 6))


def noisy(path, seed, scale=1.0, share=1.0, sigma_m=0.01):
    """An estimate of the path in another world, with noise, and without some poses."""
    rng = np.random.default_rng(seed)
    kept = rng.random(path.num_poses) < share
    xyz = scale * (path.positions_xyz + rng.normal(0, sigma_m, path.positions_xyz.shape))[kept]
    estimate = trajectory.PoseTrajectory3D(xyz, path.orientations_quat_wxyz[kept], path.timestamps[kept])
    world = np.eye(4)
    world[:3, :3] = trajectory.PosePath3D(np.zeros((1, 3)), quaternions(np.array([[0.4, -1.1, 0.7]]))).poses_se3[0][:3, :3]
    world[:3, 3] = (3, -2, 5)
    estimate.transform(world)
    return estimate


def pairs(folder):
    """Ten pairs as (name, estimate, truth, options of kinloop eval); without shared data, the seven made here."""
    made = []

    def add(name, estimate, truth, *options):
        files = [folder / f"{name}_{role}.txt" for role in ("estimate", "truth")]
        for file, path in zip(files, (estimate, truth)):
            file_interface.write_tum_trajectory_file(file, path)
        made.append((name, *files, list(options)))

    add("same_rate", noisy(walk(1, 30), 2), walk(1, 30))
    add("dense_truth", noisy(walk(3, 15), 4), walk(3, 100))
    add("sparse_truth", noisy(walk(5, 60), 6), walk(5, 20))
    add("dropped_frames", noisy(walk(7, 30), 8, share=0.6), walk(7, 30))
    add("scale", noisy(walk(9, 30), 10, scale=1.7), walk(9, 30), "--align", "sim3")
    add("unaligned", noisy(walk(11, 30), 12), walk(11, 30), "--align", "none")
    late = noisy(walk(13, 30), 14)
    late.timestamps = late.timestamps + 2.5
    add("offset", late, walk(13, 100), "--offset", "-2.5")
    shared = SHARED / "trajectories"
    for estimate, truth in (("fr2_desk_orbslam2", "fr2_desk"), ("fr1_xyz_rgbdslam", "fr1_xyz"),
                            ("fr1_xyz_rgbdslam_drift", "fr1_xyz")):
        files = shared / "known_ate" / f"{estimate}.txt", shared / "tum_groundtruth" / f"{truth}.txt"
        if files[0].exists():
            made.append((estimate, *files, []))
    return made


def option(options, name, otherwise):
    return options[options.index(name) + 1] if name in options else otherwise


def figures_of_evo(estimate, truth, options):
    """Statistics by the names of evo: ATE in m, RPE over 1 frame, 10 frames and 1 m in m and degrees."""
    truth, estimate = (file_interface.read_tum_trajectory_file(file) for file in (truth, estimate))
    truth, estimate = sync.associate_trajectories(truth, estimate, max_diff=float(option(options, "--max-difference", 0.02)),
                                                  offset_2=float(option(options, "--offset", 0)))
    alignment = option(options, "--align", "se3")
    if alignment != "none":
        estimate.align(truth, correct_scale=alignment == "sim3")
    relation, unit = metrics.PoseRelation, metrics.Unit

    def statistics(metric):
        metric.process_data((truth, estimate))
        return metric.get_all_statistics()

    found = {"ate": statistics(metrics.APE(relation.translation_part))}
    for name, delta, of in (("1 f", 1, unit.frames), ("10 f", 10, unit.frames), ("1 m", 1.0, unit.meters)):
        found[f"rpe {name} m"] = statistics(metrics.RPE(relation.translation_part, delta, of, all_pairs=True))
        found[f"rpe {name} deg"] = statistics(metrics.RPE(relation.rotation_angle_deg, delta, of, all_pairs=True))
    return found


def figures_of_kinloop(estimate, truth, options):
    """The same by kinloop eval."""
    done = subprocess.run([KINLOOP, "eval", estimate, truth, *options, "--convention", "evo", "--json", "--rpe", "10f",
                           "--rpe", "1m"], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(done.stderr)
    e = json.loads(done.stdout)

    def statistics(figures, unit):
        return {name: figures[f"{name}_{unit}"] for name in STATISTICS}

    found = {"ate": statistics(e["ate"], "m")}
    for name, error in [("1 f", e["rpe_1frame"]), *((asked["delta"], asked["error"]) for asked in e["rpe"])]:
        found[f"rpe {name} m"] = statistics(error["translation"], "m")
        found[f"rpe {name} deg"] = statistics(error["rotation"], "deg")
    return found


class Agreement(unittest.TestCase):
    def test_all_statistics_of_all_pairs(self):
        with tempfile.TemporaryDirectory() as folder:
            worst = 0
            for name, estimate, truth, options in pairs(Path(folder)):
                with self.subTest(name):
                    ours, theirs = (of(estimate, truth, options) for of in (figures_of_kinloop, figures_of_evo))
                    self.assertEqual(ours.keys(), theirs.keys())
                    for measure, statistics in ours.items():
                        for statistic, value in statistics.items():
                            difference = abs(value - theirs[measure][statistic])
                            worst = max(worst, difference)
                            self.assertLessEqual(difference, TOLERANCE, f"{measure}, {statistic}")
            print(f"largest difference of all pairs: {worst:.1e}")

    def test_formats(self):
        """Our EuRoC, KITTI and CSV reading against evo's, and what evo writes read by us."""
        with tempfile.TemporaryDirectory() as folder:
            folder = Path(folder)
            truth, estimate = walk(21, 30), noisy(walk(21, 30), 22)
            file_interface.write_tum_trajectory_file(folder / "truth.txt", truth)
            file_interface.write_tum_trajectory_file(folder / "estimate.txt", estimate)
            rows = np.column_stack([estimate.timestamps * 1e9, estimate.positions_xyz, estimate.orientations_quat_wxyz])
            (folder / "euroc.csv").write_text("#timestamp [ns],p_x,p_y,p_z,q_w,q_x,q_y,q_z\n" + "".join(
                f"{row[0]:.0f}," + ",".join(f"{value:.17g}" for value in row[1:]) + "\n" for row in rows))
            file_interface.write_kitti_poses_file(folder / "kitti.txt", estimate)
            expected = figures_of_evo(folder / "estimate.txt", folder / "truth.txt", [])["ate"]["rmse"]
            for name in ("euroc.csv", "kitti.txt"):
                found = figures_of_kinloop(folder / name, folder / "truth.txt", [])["ate"]["rmse"]
                self.assertLessEqual(abs(found - expected), TOLERANCE, name)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])

#!/usr/bin/env python3
"""Compares kinloop optimize with g2o's Python package, on standard pose graphs and on one of a run of kinloop: chi2
before and after, and poses.

Usage: g2o_test.py KINLOOP SHARED_DATA      skipped (77) without g2opy, which scripts/install_test_packages.sh installs
"""

import json
import sys
import tempfile
import unittest
from pathlib import Path

from program import kinloop

try:
    import g2opy as g2o
    import numpy as np
except ImportError as error:
    print(f"skipped: {error}; see scripts/install_test_packages.sh")
    sys.exit(77)

GRAPHS = Path(sys.argv[2]) / "pose_graphs"
# Those that g2o's solver for Eigen takes at most seconds for.
STANDARD = ("intel", "MIT", "smallGrid3D")
FAR_STARTS = ("MIT",)  # from the poses in the file, g2o ends at a chi2 of 526.3; from its spanning tree at the best, 41.2
CHI2_TOLERANCE = 1e-6  # relative; files have six digits, and g2o takes the quaternions of vertices as printed
POSE_TOLERANCE = 2e-3  # m and rad, after steps that gain less than 1e-9 of chi2


def solvers():
    """Of this build, other than those for comparison with the built-in one."""
    has_g2o = "g2o solver: yes" in kinloop("--version")
    return ("builtin", "g2o") if has_g2o else ("builtin",)


def load(file):
    optimizer = g2o.SparseOptimizer()
    optimizer.set_algorithm(g2o.OptimizationAlgorithmLevenberg(g2o.BlockSolverX(g2o.LinearSolverEigenX())))
    if not optimizer.load(str(file)):
        raise RuntimeError(f"g2o cannot read {file}")
    vertices = optimizer.vertices()
    if not any(vertex.fixed() for vertex in vertices.values()):
        vertices[min(vertices)].set_fixed(True)
    optimizer.initialize_optimization()
    return optimizer


def chi2(optimizer):
    optimizer.compute_active_errors()
    return optimizer.chi2()


def poses(optimizer):
    """Matrices by vertex: 4 x 4, in the plane 3 x 3."""
    found = {}
    for index, vertex in optimizer.vertices().items():
        pose = vertex.estimate()
        found[index] = np.asarray((pose.to_isometry() if isinstance(pose, g2o.SE2) else pose).matrix())
    return found


def largest_difference(ours, theirs):
    """Of positions in m and of angles in rad."""
    largest = 0.0
    for index, pose in ours.items():
        difference = np.linalg.inv(theirs[index]) @ pose
        d = len(difference) - 1
        angle = np.linalg.norm(difference[:d, :d] - np.eye(d)) / np.sqrt(2)  # for small ones
        largest = max(largest, np.linalg.norm(difference[:d, d]), angle)
    return largest


class Agreement(unittest.TestCase):
    def check(self, graph, folder):
        theirs = load(graph)
        before = chi2(theirs)
        if graph.stem in FAR_STARTS:
            theirs.compute_initial_guess()
        stop_when_flat = g2o.SparseOptimizerTerminateAction()
        stop_when_flat.set_gain_threshold(1e-12)
        theirs.add_post_iteration_action(stop_when_flat)
        theirs.optimize(100)
        after = chi2(theirs)
        for solver in solvers():
            with self.subTest(f"{graph.stem} by {solver}"):
                solved = folder / f"{solver}.g2o"
                ours = json.loads(kinloop("optimize", graph, "-o", solved, "--solver", solver, "--json",
                                          "--start", "tree" if solver == "g2o" and graph.stem in FAR_STARTS else "auto"))
                self.assertEqual(ours["solver"], solver)
                self.assertEqual((ours["vertices"], ours["edges"]), (len(theirs.vertices()), len(theirs.edges())))
                self.assertAlmostEqual(ours["chi2_before"] / before, 1, delta=CHI2_TOLERANCE)
                self.assertAlmostEqual(ours["chi2_after"] / after, 1, delta=CHI2_TOLERANCE)
                written = load(solved)
                self.assertAlmostEqual(chi2(written) / after, 1, delta=CHI2_TOLERANCE)
                difference = largest_difference(poses(written), poses(theirs))
                print(f"{graph.stem}, {solver}: chi2 {ours['chi2_after']:.9g}, g2o {after:.9g}, poses {difference:.1e}")
                self.assertLess(difference, POSE_TOLERANCE)

    def test_standard_graphs(self):
        graphs = [GRAPHS / f"{name}.g2o" for name in STANDARD if (GRAPHS / f"{name}.g2o").exists()]
        if not graphs:
            self.skipTest(f"none of them in {GRAPHS}")
        for graph in graphs:
            with tempfile.TemporaryDirectory() as folder:
                self.check(graph, Path(folder))

    def test_graph_of_a_run(self):
        """Of a room with a loop, before the last optimization of the run."""
        with tempfile.TemporaryDirectory() as folder:
            folder = Path(folder)
            kinloop("simulate", "room", "--size", "320x240", "--fps", "15", "-o", folder / "room", "-q")
            kinloop("run", folder / "room", "-o", folder / "out", "-q")
            self.check(folder / "out" / "graph.g2o", folder)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])

"""Tests of bench/trajectory_error.py; skipped (77) without numpy."""

import pathlib
import sys
import tempfile
import unittest

try:
    import numpy as np
except ImportError as error:
    print(f"skipped: {error}")
    sys.exit(77)

SOURCE = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(SOURCE / "bench"))
import trajectory_error as te  # noqa: E402


def random_rotation(rng):
    return te.rotations_of(rng.normal(size=(1, 4)))[0]


def wavy_path(count):
    """A path of some metres with turns."""
    t = np.linspace(0, 6, count)
    quaternions = np.stack([0.1 * np.sin(t), np.sin(t / 2), 0.1 * np.cos(t), np.cos(t / 2)], 1)
    return te.Path(t, np.stack([2 * np.sin(t), np.cos(2 * t), 0.3 * t], 1), te.rotations_of(quaternions))


def moved(path, rotation, translation):
    """The path in another world, in which `rotation` and `translation` lead to that of `path`."""
    return te.Path(path.stamps_s, (path.centers - translation) @ rotation, rotation.T @ path.rotations)


def write_path(file, path, quaternion="0 0 0 1"):
    file.write_text("".join(f"{s:.6f} {x:.9f} {y:.9f} {z:.9f} {quaternion}\n"
                            for s, (x, y, z) in zip(path.stamps_s, path.centers)))


class Alignment(unittest.TestCase):
    def setUp(self):
        self.rng = np.random.default_rng(4)
        self.truth = wavy_path(400)
        self.motion = random_rotation(self.rng), self.rng.normal(size=3)
        self.estimate = moved(self.truth, *self.motion)
        self.estimate.centers = self.estimate.centers + self.rng.normal(0, 0.005, (400, 3))

    def expect_recovered(self, motion, at_most_m=0.006):
        far = np.abs(self.truth.centers @ (motion[0] @ self.motion[0].T - np.eye(3)).T).max()
        self.assertLess(far, at_most_m)
        errors = te.errors_m(motion, moved(self.truth, *self.motion), self.truth)
        self.assertLess(errors.max(), at_most_m)

    def test_no_outliers(self):
        self.expect_recovered(te.robust(self.estimate, self.truth))
        self.expect_recovered(te.least_squares(self.estimate, self.truth))

    def test_scattered_outliers(self):
        wrong = self.rng.random(400) < 0.3
        self.estimate.centers[wrong] += self.rng.normal(0, 1, (wrong.sum(), 3))
        motion = te.robust(self.estimate, self.truth)
        self.expect_recovered(motion)
        errors = te.errors_m(motion, self.estimate, self.truth)
        self.assertLess(errors[~wrong].max(), 0.03)
        self.assertGreater(np.median(errors[wrong]), 0.5)

    def test_outliers_that_agree(self):
        self.estimate.centers[250:] += (0.4, 0, 0.1)
        self.expect_recovered(te.robust(self.estimate, self.truth))
        bent = te.errors_m(te.least_squares(self.estimate, self.truth), self.estimate, self.truth)
        self.assertGreater(np.median(bent[:250]), 0.1)  # least squares share the error out

    def test_a_frozen_part_does_not_count_as_agreeing(self):
        self.estimate.centers[100:350] = self.estimate.centers[100]
        errors = te.errors_m(te.robust(self.estimate, self.truth), self.estimate, self.truth)
        self.assertLess(errors[:100].max(), 0.03)
        self.assertLess(errors[350:].max(), 0.03)
        self.assertGreater(np.median(errors[100:350]), 0.5)

    def test_a_straight_line_is_aligned_by_its_orientations(self):
        line = te.Path(self.truth.stamps_s, np.outer(self.truth.stamps_s, (0.3, 0, 0)), self.truth.rotations)
        rotation, _ = te.robust(moved(line, *self.motion), line)
        np.testing.assert_allclose(rotation, self.motion[0], atol=1e-6)

    def test_an_uncertain_majority_does_not_decide_where_the_world_is(self):
        self.estimate.centers[150:] += (0.2, 0, 0.1)
        sigmas_m = np.where(np.arange(400) < 150, 0.01, 0.15)
        self.expect_recovered(te.robust(self.estimate, self.truth, sigmas_m), 0.05)  # not 0.22

    def test_components_are_aligned_by_themselves(self):
        self.estimate.centers[200:] += (3, 0, 0)
        components = np.arange(400) // 200
        self.assertLess(te.component_errors_m(self.estimate, self.truth, components).max(), 0.03)


class SilentErrors(unittest.TestCase):
    def test_counts_what_is_called_tracked_and_beyond_both_limits(self):
        errors = np.array([0.04, 0.06, 0.06, 0.06, 0.5])
        sigmas_m = np.array([0.0, 0.0, 0.0, 0.02, 0.1])
        tracked = np.array([True, True, False, True, True])
        self.assertEqual(te.silent_errors(errors, sigmas_m, tracked).tolist(), [False, True, False, False, True])

    def evaluate(self, header, row):
        """A run of 100 frames, of which 20 are .3 m off."""
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            truth = wavy_path(100)
            write_path(folder / "groundtruth.txt", truth)
            truth.centers[40:60, 0] += 0.3
            write_path(folder / "trajectory.txt", truth)
            rows = "".join(row(i, f"{stamp:.6f}") + "\n" for i, stamp in enumerate(truth.stamps_s))
            (folder / "frames.txt").write_text(header + "\n" + rows)
            interval_s = (truth.stamps_s[40], truth.stamps_s[59])
            return te.evaluate(folder, folder / "groundtruth.txt", interval_s)

    def test_error_at_coverage_takes_the_most_certain_frames_first(self):
        errors, sigmas_m = np.array([0.4, 0.1, 0.2, 0.3]), np.array([0.04, 0.01, 0.02, 0.03])
        doubtful = np.array([True, False, False, False])
        found = te.errors_at_coverage_m(errors, sigmas_m, doubtful, 4)
        self.assertAlmostEqual(found["50%"], np.sqrt((0.1**2 + 0.2**2) / 2))
        self.assertAlmostEqual(found["80%"], np.sqrt((0.1**2 + 0.2**2 + 0.3**2) / 3))
        self.assertIsNone(found["100%"])

    def test_without_sigma(self):
        result = self.evaluate("# stamp_s status features tracked ms", lambda i, s: f"{s} tracked 900 300 1.0")
        self.assertEqual((result["frames"], result["tracked"], result["silent"]), (100, 100, 20))
        self.assertAlmostEqual(result["silent_share"], 0.2)
        self.assertAlmostEqual(result["worst_m"], 0.3, places=2)
        self.assertGreater(result["ate_m"], 0.1)
        self.assertLess(result["ate_outside_m"], 1e-3)
        self.assertEqual(result["marked_share"], 0)

    def test_doubtful_frames_are_not_silent(self):
        result = self.evaluate("# stamp_s status ms", lambda i, s: f"{s} {'doubtful' if 40 <= i < 55 else 'tracked'} 1")
        self.assertEqual((result["tracked"], result["doubtful"], result["silent"]), (85, 15, 5))
        self.assertEqual(result["available"], 80)
        self.assertAlmostEqual(result["marked_share"], 0.75)

    def test_frames_are_available_if_they_are_posed_right_and_not_in_doubt(self):
        result = self.evaluate("# stamp_s status", lambda i, s: f"{s} {'doubtful' if i < 10 else 'lost' if i < 15 else 'tracked'}")
        self.assertEqual(result["available"], 70)  # a pose is one, however it was found

    def test_columns_are_found_by_their_names(self):
        result = self.evaluate("# stamp_s sigma_m status", lambda i, s: f"{s} {0.2 if i < 50 else 0.01} tracked")
        self.assertEqual(result["silent"], 10)

    def test_frames_without_truth_are_left_out(self):
        truth = wavy_path(100)
        estimate, at = te.matched(truth, truth.of(np.r_[0:40, 60:100]))
        self.assertEqual(len(estimate), 80)
        np.testing.assert_allclose(estimate.centers, at.centers)


if __name__ == "__main__":
    unittest.main()

"""Tests of scripts/disturb_sequence.py and bench/robustness; skipped (77) without numpy or Pillow."""

import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

try:
    import numpy as np
    from PIL import Image
except ImportError as error:
    print(f"skipped: {error}")
    sys.exit(77)

SOURCE = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(SOURCE / "scripts"))
from disturb_sequence import disturb, parse_step  # noqa: E402
from disturbances import KINDS  # noqa: E402
from tum_folder import read_color, read_depth_m, rows_of  # noqa: E402

HEIGHT, WIDTH, FRAMES, SCENE_M = 60, 80, 60, 2.0
NEAR_ROWS = slice(40, 50)  # where the scene is nearer than what is painted

# Stands for kinloop: ground truth as its trajectory, with the second half of it 1 m off.
FAKE_PROGRAM = """#!/usr/bin/env python3
import pathlib, sys
sequence, out = pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[4])
out.mkdir(parents=True)
stamps = [line.split()[0] for line in (sequence / "rgb.txt").read_text().splitlines()]
disturbed = (sequence / "disturbance.json").exists()
poses = [line.split() for line in (sequence / "groundtruth.txt").read_text().splitlines()]
for i, pose in enumerate(poses):
    pose[2] = str(float(pose[2]) + (disturbed and i >= 36))
(out / "trajectory.txt").write_text("".join(" ".join(p) + "\\n" for p in poses if p[0] in stamps))
(out / "frames.txt").write_text("# stamp_s status\\n" + "".join(s + " tracked\\n" for s in stamps))
(out / "run.json").write_text('{"loops": []}')
"""


def write_sequence(folder):
    """A scene 2 m away, with a strip at 0.2 m."""
    rng = np.random.default_rng(0)
    rows, poses = [], []
    for name in ("rgb", "depth"):
        (folder / name).mkdir(parents=True)
    for i in range(FRAMES):
        stamp = f"{10 + i / 30:.6f}"
        depth = np.full((HEIGHT, WIDTH), int(SCENE_M * 5000) + i, np.uint16)
        depth[NEAR_ROWS] = 1000
        color = rng.integers(0, 256, (HEIGHT, WIDTH, 3), np.uint8)
        Image.fromarray(color).save(folder / f"rgb/{stamp}.png")
        Image.fromarray(depth).save(folder / f"depth/{stamp}.png")
        rows.append(f"{stamp} rgb/{stamp}.png {stamp} depth/{stamp}.png\n")
        poses.append(f"{stamp} {i * 0.02:.3f} {(i % 7) * 0.01:.3f} {(i % 5) * 0.01:.3f} 0 0 0 1\n")
    (folder / "associations.txt").write_text("".join(rows))
    (folder / "rgb.txt").write_text("".join(" ".join(row.split()[:2]) + "\n" for row in rows))
    (folder / "groundtruth.txt").write_text("".join(poses))
    (folder / "camera.yaml").write_text(f"width: {WIDTH}\nheight: {HEIGHT}\ndepth_scale: 5000\n")


class WithSequence(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.scratch.cleanup)
        cls.sequence = pathlib.Path(cls.scratch.name) / "sequence"
        write_sequence(cls.sequence)

    def disturb(self, step, seed=1):
        """(folder, its disturbance)"""
        folder = pathlib.Path(tempfile.mkdtemp(dir=self.scratch.name))
        record = disturb(self.sequence, folder, [parse_step(step)], seed)
        return folder, record["disturbances"][0]

    def images(self, folder, index):
        row = rows_of(self.sequence / "associations.txt")[index]
        return read_color(folder / row[1]), read_depth_m(folder / row[3], 5000)

    def changed(self, folder, index):
        """The pixels that differ, in colour and in depth."""
        (color, depth_m), (old, old_m) = self.images(folder, index), self.images(self.sequence, index)
        return (color != old).any(2), depth_m != old_m


class Disturbances(WithSequence):
    def test_a_part_covers_its_share_of_both_images_from_its_first_frame_on(self):
        folder, _ = self.disturb("part:share=0.25,depth_m=0.6,slant=0,first=20")
        for index, share in ((0, 0), (19, 0), (20, 0.25), (59, 0.25)):
            for changed in self.changed(folder, index):
                self.assertAlmostEqual(changed.mean(), share, delta=0.01)
        self.assertAlmostEqual(np.median(self.images(folder, 30)[1][HEIGHT * 3 // 4 :]), 0.6, delta=0.002)

    def test_an_object_covers_its_share_whatever_its_form(self):
        for form in ("block", "ellipse"):
            folder, _ = self.disturb(f"object:share=0.3,form={form},aspect=1.2,first=10,seconds=1")
            for changed in self.changed(folder, 20):
                self.assertAlmostEqual(changed.mean(), 0.3, delta=0.02)
            self.assertEqual([changed.sum() for changed in self.changed(folder, 45)], [0, 0])

    def test_a_mover_crosses_and_stays_behind_what_is_nearer(self):
        folder, _ = self.disturb("mover:share=0.3,tall=1,crossings=2,first=0,seconds=2,depth_m=1")
        shares, centers = [], []
        for index in range(FRAMES):
            color, depth = self.changed(folder, index)
            self.assertFalse(depth[NEAR_ROWS].any() or color[NEAR_ROWS].any())
            shares.append(depth.mean() * HEIGHT / (HEIGHT - 10))
            centers.append(np.nonzero(depth)[1].mean() if depth.any() else np.nan)
        self.assertAlmostEqual(max(shares), 0.3, delta=0.02)
        steps = np.sign(np.diff(centers))
        there, back = np.nansum(steps[:28]), np.nansum(steps[-28:])
        self.assertTrue(abs(there) > 25 and abs(back) > 25 and there * back < 0, (there, back))

    def test_dirt_hides_depth_in_the_same_places_of_all_frames(self):
        folder, _ = self.disturb("dirt:spots=10,radius=0.05,lens=both")
        color, depth = self.changed(folder, 0)
        self.assertTrue(0.02 < depth.mean() < 0.3)
        self.assertTrue((color | ~depth).mean() > 0.99)  # colour changes where depth does
        np.testing.assert_array_equal(depth, self.changed(folder, 50)[1])
        self.assertTrue((self.images(folder, 50)[1][depth] == 0).all())

    def test_dirt_on_the_lens_of_the_colour_camera_only(self):
        color, depth = self.changed(self.disturb("dirt:spots=10,radius=0.05,lens=color")[0], 30)
        self.assertTrue(color.mean() > 0.02 and not depth.any())

    def test_a_frozen_stream_repeats_its_first_image(self):
        for kind, stream, other in (("freeze_color", 0, 1), ("freeze_depth", 1, 0)):
            folder, _ = self.disturb(f"{kind}:first=10,seconds=1")
            np.testing.assert_array_equal(self.images(folder, 39)[stream], self.images(self.sequence, 10)[stream])
            np.testing.assert_array_equal(self.images(folder, 39)[other], self.images(self.sequence, 39)[other])
            self.assertFalse(self.changed(folder, 40)[stream].any())

    def test_black_blur_and_scale(self):
        color, depth_m = self.images(self.disturb("black:first=10,seconds=1")[0], 20)
        self.assertTrue(color.max() < 15 and depth_m.max() == 0)
        color, depth_m = self.images(self.disturb("black_color:first=10,seconds=1")[0], 20)
        self.assertTrue(color.max() < 15 and depth_m.min() > 0)
        color, depth_m = self.images(self.disturb("blur:px=15,first=10,seconds=1")[0], 20)
        self.assertTrue(color.std() < 20 and depth_m.min() > 0)
        color, depth_m = self.images(self.disturb("scale:factor=0.85,first=10")[0], 20)
        self.assertAlmostEqual(depth_m.max(), 0.85 * (SCENE_M + 20 / 5000), delta=1e-3)

    def test_blank_and_other_rooms(self):
        color, depth_m = self.images(self.disturb("blank:depth_m=1.5,lamp=0,first=10,seconds=1")[0], 20)
        self.assertTrue(color.std() < 15)
        self.assertAlmostEqual((depth_m == 0).mean(), 0.2, delta=0.04)
        self.assertAlmostEqual(np.median(depth_m[depth_m > 0]), 1.5, delta=0.01)
        folder, _ = self.disturb("other_room:first=10,seconds=1")
        for mirrored, image in zip(self.images(folder, 20), self.images(self.sequence, 20)):
            np.testing.assert_array_equal(mirrored, image[:, ::-1])

    def test_a_gap_removes_frames_from_all_lists(self):
        folder, done = self.disturb("gap:first=10,seconds=1")
        for name in ("rgb.txt", "depth.txt", "associations.txt"):
            stamps = [float(row[0]) for row in rows_of(folder / name)]
            self.assertEqual(len(stamps), 30)
            self.assertFalse([s for s in stamps if done["begin_s"] <= s <= done["end_s"]])

    def test_every_kind_changes_what_it_tells_and_links_the_rest(self):
        rows = rows_of(self.sequence / "associations.txt")
        for kind in KINDS:
            for seed in (0, 1):
                folder, done = self.disturb(kind, seed)
                self.assertEqual(json.loads((folder / "disturbance.json").read_text())["disturbances"], [done])
                for row in rows:
                    during = done["begin_s"] <= float(row[0]) <= done["end_s"]
                    links = [(folder / row[i]).is_symlink() and (folder / row[i]).resolve() == self.sequence / row[i]
                             for i in (1, 3)]
                    self.assertTrue(during or all(links), (kind, seed, row))
                self.assertEqual((folder / "groundtruth.txt").read_text(),
                                 (self.sequence / "groundtruth.txt").read_text())

    def test_the_seed_decides(self):
        def content(folder):
            return {path.relative_to(folder): path.read_bytes() for path in folder.rglob("*") if path.is_file()}

        for kind in ("part", "mover", "dirt", "black"):
            once, again, other = (self.disturb(kind, seed) for seed in (3, 3, 4))
            self.assertEqual(content(once[0]), content(again[0]))
            self.assertNotEqual(once[1]["parameters"], other[1]["parameters"])

    def test_a_given_parameter_does_not_change_the_others(self):
        drawn, given = (self.disturb(step)[1]["parameters"] for step in ("object", "object:share=0.2"))
        self.assertEqual({**drawn, "share": 0.2}, given)
        with self.assertRaisesRegex(ValueError, "object has no parameter size, only share, .*seconds"):
            self.disturb("object:size=3")


class Robustness(WithSequence):
    def run_bench(self, *words):
        program = pathlib.Path(self.scratch.name) / "fake_program"
        program.write_text(FAKE_PROGRAM)
        program.chmod(0o755)
        call = [sys.executable, SOURCE / "bench/robustness", "--program", program, "--sequences", self.sequence, *words]
        return subprocess.run(call, capture_output=True, text=True)

    def test_finds_silent_errors_and_leaves_unseen_seeds_alone(self):
        file = pathlib.Path(self.scratch.name) / "rows.jsonl"
        done = self.run_bench("--kinds", "blur", "--seeds", "0-2", "--json", file, "--summary")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("left out without --unseen: seeds 2", done.stderr)
        clean, *rows = map(json.loads, file.read_text().splitlines())
        self.assertEqual((clean["kind"], clean["silent"], clean["missed"]), ("none", 0, []))
        self.assertEqual([row["seed"] for row in rows], [0, 1])
        for row in rows:
            self.assertEqual((row["frames"], row["silent"], row["available"], row["false_loops"]), (60, 24, 36, 0))
            self.assertIn("silent", row["missed"])
        self.assertIn("silent errors in 2 runs: 48 frames, 40.000% of those tracked", done.stdout)
        self.assertIn("within their aims: 0 of 2 runs", done.stdout)
        self.assertEqual(self.run_bench("--read", file).stdout.splitlines()[1:4], done.stdout.splitlines()[1:4])

    def test_unseen_seeds_are_reported_apart(self):
        done = self.run_bench("--kinds", "gap:first=40,seconds=5", "--seeds", "1-2", "--unseen")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("\nseen seeds: 1 runs", done.stdout)
        self.assertIn("\nunseen seeds: 1 runs", done.stdout)

    def test_unknown_kinds_are_refused(self):
        done = self.run_bench("--kinds", "flood")
        self.assertEqual(done.returncode, 2)
        self.assertIn("no kind flood; there are part, ", done.stderr)


if __name__ == "__main__":
    unittest.main()

"""Tests of bench/contradictions with a stand-in for the program; skipped (77) without numpy or Pillow."""

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
FRAMES, SCALE = 70, 5000

# Keeps the copy that it is given, and refuses depth whose left half is nearer.
FAKE_PROGRAM = f"#!{sys.executable}" + """
import json, pathlib, shutil, sys
import numpy as np
from PIL import Image
copy, out = pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[4])
kept = pathlib.Path(__file__).parent / "kept"
shutil.rmtree(kept, ignore_errors=True)
shutil.copytree(copy, kept)
depth = np.asarray(Image.open(copy / "depth/000000.png"), float)
if depth[:, 0].mean() < depth[:, -1].mean():
    sys.exit(print("error: mirrored", file=sys.stderr) or 3)
out.mkdir()
warnings = [{"kind": "depth_values", "evidence": "constant"}] if depth.std() == 0 else []
(out / "run.json").write_text(json.dumps({"warnings": warnings, "quality": {"verdict": "good"},
                                          "evaluation": {"ate": {"rmse_m": 0.5 if warnings else 0.25}}}))
"""


class Contradictions(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.temporary.name)
        self.sequence = self.folder / "sequence"
        rows = []
        for name in ("rgb", "depth"):
            (self.sequence / name).mkdir(parents=True)
        depth = np.tile(np.linspace(4, 1, 40), (30, 1))
        for i in range(FRAMES):
            Image.fromarray(np.full((30, 40, 3), i, np.uint8)).save(self.sequence / f"rgb/{i}.png")
            Image.fromarray((depth * SCALE + i).astype(np.uint16)).save(self.sequence / f"depth/{i}.png")
            rows.append(f"{100 + i / 10} rgb/{i}.png {100 + i / 10} depth/{i}.png\n")
        (self.sequence / "associations.txt").write_text("".join(rows))
        (self.sequence / "groundtruth.txt").write_text("")
        (self.sequence / "camera.yaml").write_text(f"fx: 50\nfy: 50\ncx: 20\ncy: 15\ndepth_scale: {SCALE}\nfps: 10\n"
                                                   "depth: {fx: 30}\n")
        self.program = self.folder / "program"
        self.program.write_text(FAKE_PROGRAM)
        self.program.chmod(0o755)

    def tearDown(self):
        self.temporary.cleanup()

    def rows_of(self, *faults):
        """The rows of a run; self.folder / "kept" has the last copy."""
        file = self.folder / "rows.json"
        subprocess.run([sys.executable, SOURCE / "bench/contradictions", self.sequence, "--program", self.program,
                        "--faults", ",".join(faults), "--json", file], check=True, stdout=subprocess.DEVNULL)
        return json.loads(file.read_text())

    def depth(self, index):
        return np.asarray(Image.open(self.folder / f"kept/depth/{index:06d}.png"), float) / SCALE

    def test_a_row_has_what_was_said_and_the_error(self):
        clean, constant, mirrored = self.rows_of("none", "constant", "mirror")
        self.assertEqual((clean["exit_code"], clean["kinds"], clean["ate_m"]), (0, [], 0.25))
        self.assertEqual((constant["kinds"], constant["message"], constant["ate_m"]), (["depth_values"], "constant", 0.5))
        self.assertEqual((mirrored["exit_code"], mirrored["message"], mirrored["ate_m"]), (3, "error: mirrored", None))

    def test_depth_is_changed_as_its_fault_says(self):
        self.rows_of("clip")
        self.assertAlmostEqual(self.depth(0).max(), 1.5, places=3)
        self.rows_of("shift")
        self.assertAlmostEqual(self.depth(0)[15, 20], np.linspace(4, 1, 40)[18], places=3)
        self.rows_of("shrink")
        self.assertEqual(self.depth(0)[0, 0], 0)
        self.assertAlmostEqual(self.depth(0)[15, 20], np.linspace(4, 1, 40)[20], delta=0.1)

    def test_camera_and_stamps_are_changed_as_their_fault_says(self):
        self.rows_of("half_camera")
        camera = (self.folder / "kept/camera.yaml").read_text()
        self.assertIn("fx: 100.0000\nfy: 100.0000\ncx: 40.0000\ncy: 30.0000\n", camera)
        self.assertIn("depth: {fx: 30}", camera)
        self.rows_of("late")
        self.assertTrue((self.folder / "kept/depth.txt").read_text().startswith("101.000000 "))
        self.assertTrue((self.folder / "kept/rgb.txt").read_text().startswith("100.000000 "))

    def test_frozen_depth_repeats_one_image(self):
        self.rows_of("frozen_depth")
        np.testing.assert_array_equal(self.depth(40), self.depth(64))
        self.assertNotEqual(self.depth(39).mean(), self.depth(40).mean())
        self.assertNotEqual(self.depth(64).mean(), self.depth(65).mean())


if __name__ == "__main__":
    unittest.main()

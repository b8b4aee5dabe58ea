"""Maps a simulated room in every layout of bench/layouts; skipped (77) without numpy or Pillow."""

import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

try:
    import numpy  # noqa: F401
    import PIL  # noqa: F401
except ImportError as error:
    print(f"skipped: {error}")
    sys.exit(77)

SOURCE = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = sys.argv.pop(1)


class Layouts(unittest.TestCase):
    def test_every_row_is_mapped_or_refused_as_it_should_be(self):
        with tempfile.TemporaryDirectory() as folder:
            room, file = pathlib.Path(folder) / "room", pathlib.Path(folder) / "rows.json"
            subprocess.run([PROGRAM, "simulate", "room", "--seed", "47", "--size", "320x240", "--frames", "10",
                            "--fps", "8", "--set", "lens_distortion=false", "-q", "-o", room], check=True)
            ended = subprocess.run([sys.executable, SOURCE / "bench/layouts", room, "--program", PROGRAM, "--step", "1",
                                    "--json", file], capture_output=True, text=True)
            self.assertEqual(ended.returncode, 0, ended.stdout + ended.stderr)
            rows = json.loads(file.read_text())
            self.assertGreaterEqual(len(rows), 60)
            said = {row["row"]: " ".join(row["said"]) for row in rows}
            self.assertIn("reduced to 8", said["colour of 16 bits per channel"])
            self.assertIn("OpenGL", said["truth: `traj.txt`, 12 columns, axes of OpenGL"])
            self.assertIn("raw disparity", said["depth as `png`, raw disparity of a Kinect 1"])
            self.assertIn("camera.yaml", said["no camera"])
            self.assertNotIn("warning", said["half the size of depth"])


if __name__ == "__main__":
    unittest.main()

"""For tests whose first argument is the program."""

import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

PROGRAM = sys.argv[1]
SMALL = ("--set", "sim.frames=40", "--set", "sim.width=320", "--set", "sim.height=240")  # for sim:room


def kinloop(*arguments):
    """Runs the program and returns its standard output."""
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(f"kinloop {' '.join(map(str, arguments))}\n{done.stdout}{done.stderr}")
    return done.stdout


class SmallRunTest(unittest.TestCase):
    """Tests of what is made of a run in the simulated room: `run_folder`, in a `folder` for the other files."""

    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.temporary.name)
        cls.run_folder = cls.folder / "run"
        kinloop("run", "sim:room", "-q", "-o", cls.run_folder, *SMALL)

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

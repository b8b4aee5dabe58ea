"""For tests whose first argument is the program."""

import subprocess
import sys

PROGRAM = sys.argv[1]
SMALL = ("--set", "sim.frames=40", "--set", "sim.width=320", "--set", "sim.height=240")  # for sim:room


def kinloop(*arguments):
    """Runs the program and returns its standard output."""
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(f"kinloop {' '.join(map(str, arguments))}\n{done.stdout}{done.stderr}")
    return done.stdout

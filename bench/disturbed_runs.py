"""Runs of the program on disturbed copies of sequences, with their errors. Needs numpy and Pillow."""

import pathlib
import subprocess
import sys
import tempfile
import time

import trajectory_error
from degrade_sequence import DEGRADATIONS
from disturb_sequence import disturb, parse_step
from loop_error import count_false_loops
from runs import is_unseen

SOURCE = pathlib.Path(__file__).resolve().parent.parent
EVERY = "every"  # every:6 is every sixth frame: another speed of the camera


class Bench:
    """Runs the program on disturbed copies in a folder that is emptied for each run."""

    def __init__(self, program, options):
        self.program = program
        self.options = options

    def run(self, sequence, kind, seed):
        """The row of one run; with `error` if there is no result."""
        name = kind.partition(":")[0]
        row = {"sequence": sequence.name, "kind": name, "case": kind, "seed": seed, "unseen": is_unseen(seed)}
        began = time.monotonic()
        with tempfile.TemporaryDirectory(prefix="robustness_") as scratch:
            copy, out = pathlib.Path(scratch) / "copy", pathlib.Path(scratch) / "out"
            interval_s, options = None, self.options
            if name == "none":
                copy = sequence
            elif name == EVERY:
                copy, options = sequence, [*options, "--every", kind.partition(":")[2]]
            elif name in DEGRADATIONS:
                degrade(sequence, copy, name, seed)
            else:
                done = disturb(sequence, copy, [parse_step(kind)], seed)["disturbances"][0]
                row["parameters"], interval_s = done["parameters"], (done["begin_s"], done["end_s"])
            call = [self.program, "run", copy, "-o", out, "-q", *options]
            ended = subprocess.run(call, stderr=subprocess.PIPE, text=True)
            row["exit_code"] = ended.returncode
            if (out / "frames.txt").exists() and (out / "trajectory.txt").exists():
                row.update(trajectory_error.evaluate(out, sequence / "groundtruth.txt", interval_s))
                row["false_loops"] = count_false_loops(out, sequence / "groundtruth.txt")
            else:
                row["error"] = ended.stderr.strip().splitlines()[-1:] or ["no result"]
        row["seconds"] = round(time.monotonic() - began, 1)
        return row


def degrade(sequence, copy, name, seed):
    script = SOURCE / "scripts/degrade_sequence.py"
    subprocess.run([sys.executable, script, sequence, copy, "--do", name, "--seed", str(seed)], check=True)

#!/usr/bin/env python3
"""Kills parts of a batch at random until it has been killed often enough, and compares what comes of it.

    build/test_packages/bin/python bench/batch/kill.py PROGRAM FOLDER [--kills 100] [--rooms 20] [--dask] [--longest-pause 5]

FOLDER gets the results of a batch that nobody disturbs, and of two batches that share a folder, or with --dask of one by a
scheduler with two workers. Of the latter, a batch, the scheduler, a worker or a run of kinloop is killed (SIGKILL) again and
again, and started anew. Prints what was killed, and whether tables (but for times) and all other files are the same. Needs PyYAML, and
distributed with --dask. Exit code 1: they differ."""

import argparse
import collections
import json
import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

PACKAGE = Path(__file__).resolve().parents[2] / "python" / "kinloop" / "batch"
SUITE = """name: killed
sequences: ['sim:room:1..{rooms}']
variants:
  default: {{set: {{sim.width: 160, sim.height: 120, sim.frames: 25}}}}
  no_loop: {{arguments: [--no-loop], set: {{sim.width: 160, sim.height: 120, sim.frames: 25}}}}
"""
PORT = 8791


class Cluster:
    """The batches and what works for them; what is dead is started again."""

    def __init__(self, program, folder, results, dask):
        self.folder, self.results, self.processes = folder, results, {}
        call = [sys.executable, str(PACKAGE), str(folder / "suite.yaml"), "-o", str(results), "--program", program]
        local = [*call, "--workers", "1"]
        self.calls = self._with_dask(call) if dask else {"batch 1": local, "batch 2": local}

    @staticmethod
    def _with_dask(call):
        address = f"tcp://127.0.0.1:{PORT}"
        worker = [sys.executable, "-m", "distributed.cli.dask_worker", address, "--nthreads", "1", "--no-dashboard", "--no-nanny"]
        return {
            "scheduler": [sys.executable, "-m", "distributed.cli.dask_scheduler", "--port", str(PORT), "--no-dashboard"],
            "worker 1": worker, "worker 2": worker,
            "batch": [*call, "--scheduler", address],
        }  # fmt: skip

    def start_dead(self):
        for name, call in self.calls.items():
            ended = self.processes[name].poll() if name in self.processes else 1
            if ended is not None and not (ended == 0 and name.startswith("batch")):
                with open(self.folder / f"{name}.log", "a") as log:
                    self.processes[name] = subprocess.Popen(call, cwd=self.folder, stdout=log, stderr=log)

    def finished(self):
        return all(name in self.processes and self.processes[name].poll() == 0 for name in self.calls if name.startswith("batch"))

    def runs(self):
        """The processes of kinloop that work for the results."""
        found = []
        for path in Path("/proc").glob("[0-9]*"):
            try:
                words = (path / "cmdline").read_bytes().split(b"\0")
            except OSError:
                continue
            if len(words) > 4 and words[1] == b"run" and any(word.startswith(os.fsencode(self.results) + b"/") for word in words):
                found.append(int(path.name))
        return found

    def kill(self, name):
        """Returns whether there was something to kill."""
        if name == "run":
            for pid in self.runs()[:1]:
                os.kill(pid, signal.SIGKILL)
                return True
            return False
        process = self.processes[name]
        if process.poll() is not None:
            return False
        process.kill()
        process.wait()
        return True

    def end(self):
        for process in self.processes.values():
            process.kill()
            process.wait()


def batch(*words):
    subprocess.run([sys.executable, str(PACKAGE), *map(str, words)], check=True)


def table_of(results):
    """runs.csv without what differs from run to run."""
    lines = [line.split(",") for line in (results / "runs.csv").read_text().splitlines()]
    return [line[: lines[0].index("key") + 1] for line in lines]


def hashes_of(results):
    return {path.parent.name: json.loads(path.read_text())["files"] for path in (results / "runs").glob("*/result.json")}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--kills", type=int, default=100)
    parser.add_argument("--rooms", type=int, default=20)
    parser.add_argument("--dask", action="store_true")
    parser.add_argument("--longest-pause", metavar="SECONDS", type=float, default=5.0)
    arguments = parser.parse_args()
    folder = arguments.folder.resolve()
    folder.mkdir(parents=True)
    (folder / "suite.yaml").write_text(SUITE.format(rooms=arguments.rooms))
    batch(folder / "suite.yaml", "-o", folder / "undisturbed", "--program", arguments.program, "--workers", 1)

    cluster = Cluster(arguments.program, folder, folder / "killed", arguments.dask)
    targets, rng, killed, begin = [*cluster.calls, "run", "run"], random.Random(1), collections.Counter(), time.time()
    try:
        while not cluster.finished():
            cluster.start_dead()
            time.sleep(rng.uniform(0.04, 1) * arguments.longest_pause)
            name = rng.choice(targets)
            if killed.total() < arguments.kills and not cluster.finished() and cluster.kill(name):
                killed[name] += 1
    finally:
        cluster.end()
    # Runs that were killed three times in a row are left to the next batch.
    batch(folder / "suite.yaml", "-o", folder / "killed", "--program", arguments.program, "--workers", 1)
    attempts = [json.loads(path.read_text())["attempts"] for path in (folder / "killed" / "runs").glob("*/result.json")]
    same = table_of(folder / "undisturbed") == table_of(folder / "killed")
    files = hashes_of(folder / "undisturbed")
    same_files = files == hashes_of(folder / "killed")
    print(f"killed {killed.total()} times in {time.time() - begin:.0f} s: {dict(killed)}")
    print(f"{len(attempts)} runs, {sum(n > 1 for n in attempts)} with more than one attempt")
    print(f"table {'the same' if same else 'DIFFERS'}, {sum(map(len, files.values()))} files {'the same' if same_files else 'DIFFER'}")
    return 0 if same and same_files else 1


if __name__ == "__main__":
    sys.exit(main())

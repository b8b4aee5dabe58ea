#!/usr/bin/env python3
"""How busy kinloop batch keeps the workers of a simulated cluster.

    bench/batch/efficiency.py RUNS.csv [--spread 0.1]

RUNS.csv has measured runs: frames, pixels of an image, whether it is simulated, CPU seconds. They are drawn at random and
given to workers as kinloop batch does it; the functions that put them in order are its own. Printed is the share of time
that workers are busy until 98 % of the work is done. --spread: standard deviation of the logarithm of the ratio of two CPU
times of the same run, for orders by earlier results."""

import argparse
import csv
import heapq
import random
import sys
import types
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
package = types.ModuleType("kinloop")  # without its compiled module
package.__path__ = [str(ROOT / "python" / "kinloop")]
sys.modules["kinloop"] = package

from kinloop.batch.durations import by_size  # noqa: E402
from kinloop.batch.workers import longest_first, shard_of  # noqa: E402

CLUSTERS = ((64, 640), (64, 6400), (1000, 10_000), (1000, 100_000))
UNTIL = 0.98  # of the work
DRAWS = 5


@dataclass
class Run:
    key: str
    cpu_s: float
    expected_s: float


def read_pool(path):
    """(CPU seconds, those expected by size) of each measured run."""
    pool = []
    with open(path, newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            frames, pixels = float(row["frames"]), float(row["pixels"])
            simulated = row["simulated"] == "1"
            options = {"sim.frames": frames, "sim.width": pixels**0.5, "sim.height": pixels**0.5} if simulated else {}
            recording = types.SimpleNamespace(path="sim:room" if simulated else "x", pixels=frames * pixels)
            pool.append((float(row["cpu_s"]), by_size(recording, options, 1)))
    return pool


def draw(pool, count, rng, expect):
    chosen = [rng.choice(pool) for _ in range(count)]
    return [Run(str(i), cpu_s, expect(cpu_s, by_size_s)) for i, (cpu_s, by_size_s) in enumerate(chosen)]


def busy_share(ends, workers):
    """Of (end, seconds) of all runs: the share of the time of all workers that is work, until 98 % of it is done."""
    total, done = sum(seconds for _, seconds in ends), 0.0
    for end, seconds in sorted(ends):
        done += seconds
        if done >= UNTIL * total:
            started = sum(max(0.0, seconds - max(0.0, later - end)) for later, seconds in ends if later > end)
            return (done + started) / (workers * end)
    return 0.0


def queue(runs, workers):
    """A queue that all workers take from: local workers, Dask."""
    free, ends = [0.0] * workers, []
    for run in runs:
        end = free[0] + run.cpu_s
        heapq.heapreplace(free, end)
        ends.append((end, run.cpu_s))
    return ends


def shards(runs, workers, help_others):
    """A shard a worker; with `help_others`, one that is through takes the longest run that nobody has begun."""
    own = [list(reversed(lot)) for lot in deal(runs, workers)]
    rest, begun, ends = iter(longest_first(runs)), set(), []
    free = [(0.0, worker) for worker in range(workers)]
    while free:
        time, worker = free[0]
        run = next_of(own[worker], begun)
        if run is None and help_others:
            run = next((other for other in rest if other.key not in begun), None)
        if run is None:
            heapq.heappop(free)
            continue
        begun.add(run.key)
        ends.append((time + run.cpu_s, run.cpu_s))
        heapq.heapreplace(free, (time + run.cpu_s, worker))
    return ends


def deal(runs, count):
    """All shards of shard_of() at once."""
    if count * len(runs) <= 1_000_000:
        return [shard_of(runs, number, count) for number in range(1, count + 1)]
    loads, lots = [(0.0, lot) for lot in range(count)], [[] for _ in range(count)]
    for run in longest_first(runs):
        load, lot = loads[0]
        heapq.heapreplace(loads, (load + run.expected_s, lot))
        lots[lot].append(run)
    return lots


def next_of(own, begun):
    while own and own[-1].key in begun:
        own.pop()
    return own.pop() if own else None


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("runs")
    parser.add_argument("--spread", type=float, default=0.1)
    arguments = parser.parse_args()
    pool = read_pool(arguments.runs)
    times = sorted(cpu_s for cpu_s, _ in pool)
    print(f"{len(pool)} runs: median {times[len(times) // 2]:.1f} s, mean {sum(times) / len(times):.1f} s, "
          f"95 % {times[int(0.95 * len(times))]:.1f} s, longest {times[-1]:.1f} s")  # fmt: skip
    rng = random.Random(1)
    size = lambda _, by_size_s: by_size_s  # noqa: E731
    exact = lambda cpu_s, _: cpu_s  # noqa: E731
    earlier = lambda cpu_s, _: cpu_s * rng.lognormvariate(0, arguments.spread)  # noqa: E731
    ways = (
        ("queue, order of the suite", size, queue),
        ("queue, longest first by size", size, lambda runs, n: queue(longest_first(runs), n)),
        ("queue, longest first by earlier results", earlier, lambda runs, n: queue(longest_first(runs), n)),
        ("a shard a worker, by size", size, lambda runs, n: shards(runs, n, False)),
        ("a shard a worker, by size, helping others", size, lambda runs, n: shards(runs, n, True)),
        ("a shard a worker, by earlier results, helping others", earlier, lambda runs, n: shards(runs, n, True)),
        ("queue, times known", exact, lambda runs, n: queue(longest_first(runs), n)),
    )
    print("| workers, runs | " + " | ".join(name for name, *_ in ways) + " |")
    for workers, count in CLUSTERS:
        cells = []
        for _, expect, give in ways:
            shares = [busy_share(give(draw(pool, count, rng, expect), workers), workers) for _ in range(DRAWS)]
            cells.append(f"{min(shares):.2f}")
        print(f"| {workers}, {count} | " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()

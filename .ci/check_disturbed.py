#!/usr/bin/python3
"""Maps the short disturbed runs of a table and fails if one is worse than it says: more silent errors, more false loops,
or fewer available frames. After a change that is meant to alter them: .ci/check_disturbed.py --update

usage: .ci/check_disturbed.py [TABLE] [--update] [--program PROGRAM]

TABLE is bench/suites/disturbed.csv, or bench/suites/disturbed_nightly.csv with more seeds. Its first columns say what is
run, the others are counts of frames and loops:

  room         one of bench/rooms.py, in which something moves or not; look-alike: a world of bench/loops, of two visits
  case         how the images are disturbed (scripts/disturb_sequence.py, degrade_sequence.py; none), or the kind of world
  seed         of the room and of the disturbance; none of those that are unseen (bench/runs.py)
  length       frames that are rendered, 320 x 240 at 10 Hz; of each visit
  frames       that were processed
  silent       called tracked, and more than 5 cm and 4 sigma off (bench/trajectory_error.py)
  false_loops  that measure another pose than the true one (bench/loop_error.py), or join what are two places
  available    with a pose that is not doubtful and at most 5 cm off

Runs are deterministic, so any count that is worse is a failure. Needs numpy and Pillow."""

import argparse
import concurrent.futures
import csv
import os
import pathlib
import sys
import tempfile

SOURCE = pathlib.Path(__file__).resolve().parent.parent
sys.path[:0] = [str(SOURCE / "scripts"), str(SOURCE / "bench")]

import look_alikes  # noqa: E402
import trajectory_error  # noqa: E402
from disturbed_runs import Bench  # noqa: E402
from rooms import simulate_room  # noqa: E402
from runs import is_unseen  # noqa: E402

COLUMNS = ["room", "case", "seed", "length"]
COUNTS = ["frames", "silent", "false_loops", "available"]
LOOK_ALIKE = "look-alike"


def look_alike(program, kind, seed, length, scratch):
    """Two visits of a world, in one run and as two maps that are merged."""
    renderer = look_alikes.Renderer(program, scratch, length)
    sequence, second_s, _ = look_alikes.draw_world(renderer, kind, seed)
    row = look_alikes.map_both(program, sequence, second_s, scratch / "out")
    if "error" in row:
        return row
    row.update(trajectory_error.evaluate(scratch / "out", sequence / "groundtruth.txt"))
    visits = look_alikes.map_each(program, sequence, second_s, scratch)
    row["merged"] = look_alikes.merge(program, *visits, scratch)
    return {**row, "false_loops": look_alikes.false_loops(kind, row)}


def measure(run, program):
    """The counts of a row of the table; with `error` if there is no result."""
    case, seed, length = run["case"], int(run["seed"]), int(run["length"])
    with tempfile.TemporaryDirectory(prefix="disturbed_") as scratch:
        scratch = pathlib.Path(scratch)
        if run["room"] == LOOK_ALIKE:
            return look_alike(program, case, seed, length, scratch)
        rendered = ["--size", "320x240", "--fps", "10", "--frames", str(length), "--threads", "1"]
        sequence = simulate_room(program, run["room"], seed, scratch / "room", rendered)
        return Bench(program, ["--threads", "1", "--autosave", "0"]).run(sequence, case, seed)


def changes(before, now):
    """What is worse, and what is only different, in words."""
    worse, other = [], []
    for name in COUNTS:
        if before[name] == now[name]:
            continue
        is_worse = now[name] < before[name] if name == "available" else now[name] > before[name]
        is_worse = is_worse or name == "frames"  # then the others cannot be compared
        (worse if is_worse else other).append(f"{name} {before[name]} -> {now[name]}")
    return worse, other


def read_table(path):
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    if not rows:
        raise SystemExit(f"{path}: no runs")
    for row in rows:
        if is_unseen(int(row["seed"])):
            raise SystemExit(f"{path}: seed {row['seed']} is unseen; take another")
        row.update({name: int(row.get(name) or 0) for name in COUNTS})
    return rows


def write_table(path, rows):
    with open(path, "w", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS + COUNTS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def run_all(rows, program):
    """The rows with the counts of today, and how many are worse."""
    found, failed = [], 0
    with concurrent.futures.ProcessPoolExecutor(os.cpu_count()) as pool:
        for row, result in zip(rows, pool.map(measure, rows, [program] * len(rows))):
            name = " ".join(row[column] for column in COLUMNS)
            if "error" in result:
                print(f"{name}: {' '.join(result['error'])}", flush=True)
                found.append(row)
                failed += 1
                continue
            now = {name: int(result[name]) for name in COUNTS}
            worse, other = changes(row, now)
            failed += bool(worse)
            words = [f"WORSE: {', '.join(worse)}"] * bool(worse) + [f"changed: {', '.join(other)}"] * bool(other)
            print(f"{name}: " + ("; ".join(words) or ", ".join(f"{value} {key}" for key, value in now.items())), flush=True)
            found.append({**row, **now})
    return found, failed


def totals(rows):
    return ", ".join(f"{sum(row[name] for row in rows)} {name}" for name in COUNTS)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("table", type=pathlib.Path, nargs="?", default=SOURCE / "bench/suites/disturbed.csv")
    parser.add_argument("--update", action="store_true", help="write what was found into the table")
    parser.add_argument("--program", type=pathlib.Path, default=SOURCE / "build/release/apps/kinloop")
    arguments = parser.parse_args()

    rows = read_table(arguments.table)
    found, failed = run_all(rows, arguments.program.resolve())
    print(f"{len(rows)} runs: {totals(found)}; the table has {totals(rows)}; {failed} runs are worse")
    if arguments.update:
        write_table(arguments.table, found)
        return 0
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())

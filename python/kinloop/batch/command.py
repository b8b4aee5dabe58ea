"""The command line of kinloop batch. The program declares the same options for its help (apps/command_batch.cpp)."""

import argparse
import json
import os
import random
import sys
import threading

from .cluster import write_scripts
from .compare import REGRESSION_EXIT_CODE, Thresholds, compare, read_summaries
from .errors import BatchError, Interrupted, UsageError
from .execute import execute, verify
from .jobs import Job, Planner
from .program import find_program
from .progress import Progress
from .recordings import find_recordings
from .report import write_report
from .store import Heartbeat, Store
from .suite import read_suite
from .workers import end_with_parent, run_by_dask, run_locally, shard_of, stopping_by_signals, unfinished, without_repetition

MAX_WORKERS = 10_000
VERIFY_EXIT_CODE = REGRESSION_EXIT_CODE


class Parser(argparse.ArgumentParser):
    def __init__(self, name):
        super().__init__(f"kinloop batch {name}".strip(), add_help=False, allow_abbrev=False)
        self.add_argument("-q", "--quiet", action="store_true")

    def error(self, message):
        raise UsageError(f"{message}; see {self.prog} --help")


def number_from(lowest, highest, kind=int):
    """The type of an argument that is a number in a range."""

    def parse(text):
        try:
            value = kind(text)
        except ValueError:
            value = None
        if value is None or not lowest <= value <= highest:
            raise argparse.ArgumentTypeError(f"'{text}': expected a {'whole ' * (kind is int)}number from {lowest:g} to {highest:g}")
        return value

    return parse


def say(arguments, text):
    if not arguments.quiet:
        print(text, file=sys.stderr)


def plan_of(arguments):
    """The suite, its jobs, which are written to the plan of the store, and the store."""
    suite = read_suite(arguments.suite)
    program = find_program(arguments.program)
    store = Store(arguments.output).create()
    jobs = Planner(suite, program).jobs(find_recordings(suite, store.inputs, program))
    store.write_plan(suite.name, jobs)
    return suite, jobs, store, program


def report(arguments, title, jobs, store):
    say(arguments, write_report(title, jobs, store))
    say(arguments, f"results    {store.folder} (index.html, runs.csv)")


# kinloop batch SUITE


def add_suite_arguments(parser):
    parser.add_argument("suite")
    parser.add_argument("-o", "--output", default="results")
    parser.add_argument("--program", default=os.environ.get("KINLOOP_PROGRAM", "kinloop"))


def run_parser():
    parser = Parser("")
    add_suite_arguments(parser)
    parser.add_argument("--workers", type=number_from(1, MAX_WORKERS))
    parser.add_argument("--scheduler")
    return parser


def run_suite(arguments):
    if arguments.workers and arguments.scheduler:
        raise UsageError("--workers and --scheduler exclude each other: a scheduler has its own workers")
    suite, jobs, store, _ = plan_of(arguments)
    todo = unfinished(jobs, store)
    say(arguments, f"{len(jobs)} runs, {len(todo)} to do")
    progress = Progress(len(todo), arguments.quiet)
    try:
        if todo and arguments.scheduler:
            run_by_dask(todo, store, arguments.scheduler, progress, lambda text: say(arguments, text))
        elif todo:
            run_locally(todo, store, arguments.workers or os.cpu_count() or 1, progress)
    except Interrupted:
        progress.end_line()
        report(arguments, suite.name, jobs, store)
        raise
    report(arguments, suite.name, jobs, store)


# kinloop batch task: what a worker of Dask starts


def task_parser():
    parser = Parser("task")
    parser.add_argument("results")
    parser.add_argument("job")
    return parser


def do_task(arguments):
    end_with_parent()
    job, store, stop = Job(**json.loads(arguments.job)), Store(arguments.results).create(), threading.Event()
    with Heartbeat() as heartbeat:
        while not execute(job, store, stop, heartbeat):
            stop.wait(0.5)


# kinloop batch plan, shard


def plan_parser():
    parser = Parser("plan")
    add_suite_arguments(parser)
    parser.add_argument("--shards", type=number_from(1, MAX_WORKERS), default=100)
    return parser


def plan(arguments):
    suite, jobs, store, program = plan_of(arguments)
    todo = unfinished(jobs, store)
    shards = max(1, min(arguments.shards, len(todo)))
    paths = write_scripts(suite, todo, shards, program, store)
    say(arguments, f"{len(jobs)} runs, {len(todo)} to do, in {shards} shards")
    for path in (store.plan_file, *paths):
        print(path)


def shard_parser():
    parser = Parser("shard")
    parser.add_argument("shard")
    parser.add_argument("results")
    parser.add_argument("--workers", type=number_from(1, MAX_WORKERS), default=1)
    return parser


def do_shard(arguments):
    number, _, count = arguments.shard.partition("/")
    try:
        number, count = number_from(1, MAX_WORKERS)(number), number_from(1, MAX_WORKERS)(count)
        if number > count:
            raise argparse.ArgumentTypeError(f"there is no shard {number} of {count}")
    except argparse.ArgumentTypeError as error:
        raise UsageError(f"{arguments.shard}: {error}; expected a shard and their number, e.g. 3/100") from None
    store = Store(arguments.results)
    _, jobs = store.read_plan()
    todo = unfinished(shard_of(jobs, number, count), store.create())
    say(arguments, f"shard {number} of {count}: {len(todo)} runs to do")
    run_locally(todo, store, arguments.workers, Progress(len(todo), arguments.quiet))


# kinloop batch table, verify, compare


def table_parser():
    parser = Parser("table")
    parser.add_argument("results")
    return parser


def table(arguments):
    store = Store(arguments.results)
    title, jobs = store.read_plan()
    report(arguments, title, jobs, store)


def verify_parser():
    parser = Parser("verify")
    parser.add_argument("results")
    parser.add_argument("--sample", type=number_from(1, 1_000_000), default=10)
    parser.add_argument("--seed", type=number_from(0, 1_000_000_000), default=1)
    return parser


def verify_sample(arguments):
    """Runs a sample again. The exit code tells whether all bytes were the same."""
    store = Store(arguments.results)
    _, jobs = store.read_plan()
    finished = [job for job in without_repetition(jobs) if store.has(job.key)]
    if not finished:
        raise BatchError(f"{store.folder}: no run is finished; run the suite first")
    sample = random.Random(arguments.seed).sample(finished, min(arguments.sample, len(finished)))
    different = 0
    with stopping_by_signals() as stop:
        for job in sample:
            names = verify(job, store.create(), stop)
            different += bool(names)
            print(f"{job.sequence}, {job.variant}, seed {job.seed}: {'differs: ' + ', '.join(names) if names else 'the same'}", flush=True)
    say(arguments, f"{len(sample)} runs repeated, {different} differ")
    return VERIFY_EXIT_CODE if different else 0


def compare_parser():
    parser = Parser("compare")
    parser.add_argument("first")
    parser.add_argument("second")
    parser.add_argument("--max-ate-ratio", type=number_from(0, 1000, float), default=Thresholds.ate_ratio)
    parser.add_argument("--max-sequence-ratio", type=number_from(0, 1_000_000, float), default=Thresholds.sequence_ratio)
    parser.add_argument("--max-failures", type=number_from(0, 1_000_000), default=Thresholds.failures)
    parser.add_argument("--max-cpu-ratio", type=number_from(0, 1000, float), default=Thresholds.cpu_ratio)
    return parser


def compare_two(arguments):
    thresholds = Thresholds(arguments.max_ate_ratio, arguments.max_sequence_ratio, arguments.max_failures, arguments.max_cpu_ratio)
    lines, faults = compare(read_summaries(arguments.first), read_summaries(arguments.second), thresholds)
    print("\n".join(lines + [f"worse: {fault}" for fault in faults] + ([] if faults else ["not worse"])))
    return REGRESSION_EXIT_CODE if faults else 0


COMMANDS = {
    "task": (task_parser, do_task),
    "plan": (plan_parser, plan),
    "shard": (shard_parser, do_shard),
    "table": (table_parser, table),
    "verify": (verify_parser, verify_sample),
    "compare": (compare_parser, compare_two),
}


def main(words=None):
    """Runs the command; returns its exit code."""
    words = sys.argv[1:] if words is None else words
    name = words[0] if words and words[0] in COMMANDS else ""
    make_parser, function = COMMANDS[name] if name else (run_parser, run_suite)
    try:
        return function(make_parser().parse_args(words[1:] if name else words)) or 0
    except BatchError as error:
        print(f"error: {error}", file=sys.stderr)
        return error.exit_code
    except BrokenPipeError:  # the reader of standard output has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 141

"""The command line of kinloop batch. The program declares the same options for its help (apps/command_batch.cpp)."""

import argparse
import json
import os
import sys
import threading
from pathlib import Path

from .errors import BatchError, UsageError
from .execute import execute
from .jobs import Job, Planner
from .program import find_program
from .progress import Progress, duration
from .recordings import find_recordings
from .store import Heartbeat, Store
from .suite import read_suite
from .tables import rows_of, write_rows
from .workers import end_with_parent, run_by_dask, run_locally, unfinished


class Parser(argparse.ArgumentParser):
    def error(self, message):
        raise UsageError(f"{message}; see kinloop batch --help")


def plan_of(suite_file, store, program):
    """The jobs of a suite, which are written to the plan of the store."""
    suite = read_suite(suite_file)
    store.create()
    jobs = Planner(suite, find_program(program)).jobs(find_recordings(suite, store.inputs))
    store.write_plan(jobs)
    return suite, jobs


def _say(arguments):
    return (lambda _: None) if arguments.quiet else (lambda text: print(text, file=sys.stderr))


def run_suite(arguments):
    store = Store(arguments.output)
    say = _say(arguments)
    _, jobs = plan_of(arguments.suite, store, arguments.program)
    todo = unfinished(jobs, store)
    say(f"{len(jobs)} runs, {len(todo)} to do")
    progress = Progress(len(todo), 0, arguments.quiet)
    try:
        if todo and arguments.scheduler:
            run_by_dask(todo, store, arguments.scheduler, progress, say)
        elif todo:
            run_locally(todo, store, arguments.workers or os.cpu_count() or 1, progress)
    except BatchError:
        progress.end_line()
        write_tables(store, jobs, arguments, say)
        raise
    write_tables(store, jobs, arguments, say)


def write_tables(store, jobs, arguments, say):
    rows = rows_of(jobs, store)
    write_rows(store.folder, rows)
    counts = {}
    for row in rows:
        counts[row["status"]] = counts.get(row["status"], 0) + 1
    say(", ".join(f"{count} {status}" for status, count in sorted(counts.items())))
    say(f"results    {store.folder} (runs.csv)")


def do_task(arguments):
    """What a worker of Dask starts: one job, given as JSON."""
    end_with_parent()
    job, store, stop = Job(**json.loads(arguments.job)), Store(arguments.results).create(), threading.Event()
    with Heartbeat() as heartbeat:
        while not execute(job, store, stop, heartbeat):
            stop.wait(0.5)


def add_common(parser):
    parser.add_argument("--program", default=os.environ.get("KINLOOP_PROGRAM", "kinloop"))
    parser.add_argument("-q", "--quiet", action="store_true")


def whole_number(text):
    if not text.isdigit() or not 1 <= int(text) <= 10_000:
        raise argparse.ArgumentTypeError(f"'{text}': expected a whole number from 1 to 10000")
    return int(text)


def run_parser():
    parser = Parser("kinloop batch", add_help=False)
    parser.add_argument("suite")
    parser.add_argument("-o", "--output", default="results")
    parser.add_argument("--workers", type=whole_number)
    parser.add_argument("--scheduler")
    add_common(parser)
    return parser, run_suite


def task_parser():
    parser = Parser("kinloop batch task", add_help=False)
    parser.add_argument("results")
    parser.add_argument("job")
    return parser, do_task


COMMANDS = {"task": task_parser}


def main(words=None):
    """Runs the command; returns its exit code."""
    words = sys.argv[1:] if words is None else words
    try:
        if words and words[0] in COMMANDS:
            parser, function = COMMANDS[words[0]]()
            words = words[1:]
        else:
            parser, function = run_parser()
        return function(parser.parse_args(words)) or 0
    except BatchError as error:
        print(f"error: {error}", file=sys.stderr)
        return error.exit_code

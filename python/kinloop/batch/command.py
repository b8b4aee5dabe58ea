"""The commands of kinloop batch and their options. The program passes its command line on, and so this is its help, too."""

import contextlib
import os
import random
import re
import sys
import threading

from .cgroup import enter_leaf
from .cluster import run_by_slurm, write_scripts
from .command_line import Parser, number_from
from .compare import REGRESSION_EXIT_CODE, Thresholds, compare, read_summaries
from .durations import Durations
from .errors import BatchError, Interrupted, Unfinished, UsageError
from .execute import execute, verify
from .jobs import Job, Planner
from .program import find_program
from .progress import Progress
from .recordings import find_recordings
from .report import write_report
from .store import Heartbeat, Store
from .suite import read_suite
from .text import printable
from .workers import end_with_parent, help_others, run_by_dask, run_locally, shard_of, stopping_by_signals, unfinished, without_repetition

MAX_WORKERS = 10_000
VERIFY_EXIT_CODE = REGRESSION_EXIT_CODE


def say(arguments, text):
    if not arguments.quiet:
        print(printable(text), file=sys.stderr)


def own_program():
    """The program that has started this package, or the installed one; None without. Never one that a plan names."""
    try:
        return find_program(os.environ.get("KINLOOP_PROGRAM", "kinloop"))
    except BatchError:
        return None


def add_trust(parser):
    parser.add_flag("--trust", text="run the programs of a plan that somebody else, or another machine, has written")


def runnable_plan(arguments, store):
    """The jobs of a plan that this user has written, or says to trust."""
    _, jobs = store.read_plan()
    if not arguments.trust:
        store.require_own_plan()
    return jobs


def plan_of(arguments):
    """The suite, its jobs, which are written to the plan of the store, and the store."""
    suite = read_suite(arguments.suite)
    program = find_program(arguments.program or os.environ.get("KINLOOP_PROGRAM", "kinloop"))
    store = Store(arguments.output).create()
    jobs = Planner(suite, program).jobs(find_recordings(suite, store.inputs, program))
    Durations.of_results(store).set_expected(jobs)
    store.write_plan(suite.name, jobs)
    return suite, jobs, store, program


def report(arguments, title, jobs, store, program):
    say(arguments, write_report(title, jobs, store, program))
    say(arguments, f"results    {store.folder} (index.html, runs.csv)")


# kinloop batch SUITE


FOOTER = """Finished runs are never repeated: after Ctrl-C, a crash or with more sequences, run the same command again.

Examples:
  kinloop batch suite.yaml -o results --workers 4
  kinloop batch suite.yaml -o results --slurm "--partition=short --time=1:00:00"
  kinloop batch compare results_before results_now"""


def add_suite_arguments(parser):
    parser.add_text("SUITE", "YAML file of sequences and variants; see docs/evaluation.md")
    parser.add_option("-o", "--output", metavar="DIR", default="results", text="folder of the results")
    parser.add_option("--program", metavar="FILE", text="another kinloop to run (default: this one)")


def add_shards(parser):
    parser.add_option("--shards", metavar="N", kind=number_from(1, MAX_WORKERS), default=100, text="parts to divide the runs into")


def run_parser():
    described = [(name, make_parser().description) for name, (make_parser, _) in COMMANDS.items() if name != "task"]
    parser = Parser("", "Run whole datasets with variants on many cores or machines", described, FOOTER)
    add_suite_arguments(parser)
    parser.add_option("--workers", metavar="N", kind=number_from(1, MAX_WORKERS),
                      text="runs at a time on this machine (default: number of cores)")  # fmt: skip
    parser.add_option("--scheduler", metavar="tcp://HOST:PORT", text="Dask scheduler whose workers do the runs")
    parser.add_option("--slurm", metavar="OPTIONS", text="submit the runs to Slurm with these options of sbatch, and wait for them")
    add_shards(parser)
    return parser


def run_suite(arguments):
    if sum(way is not None for way in (arguments.workers, arguments.scheduler, arguments.slurm)) > 1:
        raise UsageError("--workers, --scheduler and --slurm exclude each other: the last two have workers of their own")
    suite, jobs, store, program = plan_of(arguments)
    todo = unfinished(jobs, store)
    say(arguments, f"{len(jobs)} runs, {len(todo)} to do")
    progress = Progress(todo, arguments.quiet)
    try:
        if todo and arguments.scheduler is not None:
            run_by_dask(todo, store, arguments.scheduler, progress, lambda text: say(arguments, text))
        elif todo and arguments.slurm is not None:
            script, _ = write_scripts(suite, todo, arguments.shards, program, store)
            run_by_slurm(script, arguments.slurm, todo, store, progress, lambda text: say(arguments, text))
        elif todo:
            run_locally(todo, store, arguments.workers or os.cpu_count() or 1, progress)
    except Unfinished:
        progress.end_line()
        report(arguments, suite.name, jobs, store, program)
        raise
    report(arguments, suite.name, jobs, store, program)


# kinloop batch task: what a worker of Dask starts


def task_parser():
    parser = Parser("task", "Do one run")
    parser.add_text("RESULTS", "folder of results")
    parser.add_text("JOB", "a line of its plan")
    return parser


def _job_of(line):
    try:
        return Job.from_line(line)
    except ValueError as error:
        raise UsageError(f"kinloop batch task: JOB: {error}; a line of plan.jsonl is expected") from None


def do_task(arguments):
    end_with_parent()
    job, store, stop = _job_of(arguments.job), Store(arguments.results).create(), threading.Event()
    with Heartbeat() as heartbeat:
        while not execute(job, store, stop, heartbeat):
            stop.wait(0.5)


# kinloop batch plan, shard


def plan_parser():
    parser = Parser("plan", "Write the list of runs, and scripts for Slurm and Kubernetes")
    add_suite_arguments(parser)
    add_shards(parser)
    return parser


def plan(arguments):
    suite, jobs, store, program = plan_of(arguments)
    todo = unfinished(jobs, store)
    paths = write_scripts(suite, todo, arguments.shards, program, store)
    say(arguments, f"{len(jobs)} runs, {len(todo)} to do, in {max(1, min(arguments.shards, len(todo)))} shards")
    for path in (store.plan_file, *paths):
        print(path)


def shard_parser():
    parser = Parser("shard", "Do one part of a plan")
    parser.add_text("SHARD", "which part of how many, e.g. 3/100")
    parser.add_text("RESULTS", "folder of the results of kinloop batch plan")
    parser.add_option("--workers", metavar="N", kind=number_from(1, MAX_WORKERS), default=1, text="runs at a time")
    parser.add_flag("--help-others", text="then do what the other shards have not begun")
    add_trust(parser)
    return parser


def do_shard(arguments):
    match = re.fullmatch(r"(\d{1,5})/(\d{1,5})", arguments.shard)
    number, count = map(int, match.groups()) if match else (0, 0)
    if not 1 <= number <= count <= MAX_WORKERS:
        raise UsageError(f"kinloop batch shard: '{arguments.shard}': expected a shard and their number, e.g. 3/100")
    store = Store(arguments.results)
    jobs = runnable_plan(arguments, store)
    todo = unfinished(shard_of(jobs, number, count), store.create())
    say(arguments, f"shard {number} of {count}: {len(todo)} runs to do")
    run_locally(todo, store, arguments.workers, Progress(todo, arguments.quiet))
    if arguments.help_others:
        help_others(jobs, store, arguments.workers)


# kinloop batch table, verify, compare


def table_parser():
    parser = Parser("table", "Write the tables and the page of a folder of results again")
    parser.add_text("RESULTS", "folder of results")
    return parser


def table(arguments):
    store = Store(arguments.results)
    title, jobs = store.read_plan()
    report(arguments, title, jobs, store, own_program())


def verify_parser():
    parser = Parser("verify", "Repeat a sample of finished runs and compare the bytes")
    parser.add_text("RESULTS", "folder of results")
    parser.add_option("--sample", metavar="N", kind=number_from(1, 1_000_000), default=10, text="number of runs to repeat")
    parser.add_option("--seed", metavar="N", kind=number_from(0, 1_000_000_000), default=1, text="of the choice of runs")
    add_trust(parser)
    return parser


def verify_sample(arguments):
    """Runs a sample again. The exit code tells whether all bytes were the same."""
    store = Store(arguments.results)
    jobs = runnable_plan(arguments, store)
    finished = [job for job in without_repetition(jobs) if store.has(job.key)]
    if not finished:
        raise BatchError(f"{store.folder}: no run is finished; run the suite first")
    sample = random.Random(arguments.seed).sample(finished, min(arguments.sample, len(finished)))
    different = 0
    with stopping_by_signals() as stop:
        for job in sample:
            names = verify(job, store.create(), stop)
            different += bool(names)
            found = f"differs: {', '.join(names)}" if names else "the same"
            print(printable(f"{job.sequence}, {job.variant}, seed {job.seed}: {found}"), flush=True)
    say(arguments, f"{len(sample)} runs repeated, {different} differ")
    return VERIFY_EXIT_CODE if different else 0


def compare_parser():
    parser = Parser("compare", "Compare two batches; exit code 5 if the second is worse")
    parser.add_text("FIRST", "folder of results, or its runs.csv")
    parser.add_text("SECOND", "the same of the other version, with the same sequences and variants")
    parser.add_option("--max-ate-ratio", metavar="RATIO", kind=number_from(0, 1000, float), default=Thresholds.ate_ratio,
                      text="allowed geometric mean of the ratios of ATE, if they are significant")  # fmt: skip
    parser.add_option("--max-sequence-ratio", metavar="RATIO", kind=number_from(0, 1_000_000, float), default=Thresholds.sequence_ratio,
                      text="allowed ratio of any one sequence")  # fmt: skip
    parser.add_option("--max-failures", metavar="N", kind=number_from(0, 1_000_000), default=Thresholds.failures,
                      text="allowed sequences that fail in the second only")  # fmt: skip
    parser.add_option("--max-cpu-ratio", metavar="RATIO", kind=number_from(0, 1000, float), default=Thresholds.cpu_ratio,
                      text="allowed ratio of CPU time, 0 = any")  # fmt: skip
    return parser


def compare_two(arguments):
    thresholds = Thresholds(arguments.max_ate_ratio, arguments.max_sequence_ratio, arguments.max_failures, arguments.max_cpu_ratio)
    lines, faults = compare(read_summaries(arguments.first), read_summaries(arguments.second), thresholds)
    for line in lines + [f"worse: {fault}" for fault in faults] + ([] if faults else ["not worse"]):
        print(printable(line))
    return REGRESSION_EXIT_CODE if faults else 0


COMMANDS = {
    "task": (task_parser, do_task),
    "plan": (plan_parser, plan),
    "shard": (shard_parser, do_shard),
    "table": (table_parser, table),
    "verify": (verify_parser, verify_sample),
    "compare": (compare_parser, compare_two),
}


def with_value_of(option, words):
    """The words with `option VALUE` as one word, since argparse takes a value that begins with a hyphen for an option."""
    if option not in words[:-1]:
        return words
    place = words.index(option)
    return [*words[:place], f"{option}={words[place + 1]}", *words[place + 2 :]]


def main(words=None):
    """Runs the command; returns its exit code."""
    words = sys.argv[1:] if words is None else words
    name = words[0] if words and words[0] in COMMANDS else ""
    make_parser, function = COMMANDS[name] if name else (run_parser, run_suite)
    try:
        enter_leaf()
        return function(make_parser().parse(with_value_of("--slurm", words[1:] if name else words))) or 0
    except BatchError as error:
        _say(f"error: {error}")
        return error.exit_code
    except KeyboardInterrupt:  # before or after the runs
        _say("error: interrupted")
        return Interrupted.exit_code
    except BrokenPipeError:  # the reader of standard output has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 141
    except OSError as error:  # of the file system, in a place that has no better words for it
        _say(f"error: {error.filename or 'the system'}: {error.strerror or error}; check its permissions")
        return BatchError.exit_code
    except MemoryError:
        _say("error: out of memory; divide the suite")
        return BatchError.exit_code


def _say(message):
    """On standard error, unless that is full or closed: the exit code tells the rest."""
    with contextlib.suppress(OSError):
        print(printable(message), file=sys.stderr, flush=True)

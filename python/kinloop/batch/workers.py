"""Who does the jobs: threads of this process, or the workers of a Dask scheduler.

A run is a process of its own, so local workers are threads that wait for it; they need no package. On Dask, a task
starts this package on the worker as a process, too, so that a worker needs only Dask, and sees RESULTS and the program
under the same paths."""

import concurrent.futures
import heapq
import os
import re
import signal
import subprocess
import sys
import threading
from contextlib import contextmanager
from pathlib import Path

from .errors import BatchError, Interrupted, Unfinished, UsageError
from .execute import KILLED, execute
from .store import STALE_S, Heartbeat

PACKAGE = str(Path(__file__).resolve().parent)
POLL_S = 0.5
TASK_RETRIES = 5
SHORTEST_S = 1e-3  # of an expected time, so that jobs of which nothing is known are dealt evenly
CONNECT_PATIENCE = "10s"
ADDRESS = re.compile(r"(?:[a-z]+://)?[^\s/]+:(\d{1,5})")
MAX_PORT = 65535


@contextmanager
def stopping_by_signals():
    """Yields an event that Ctrl-C, SIGTERM and SIGHUP set. Restores what they did before."""
    stop, before = threading.Event(), {}
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        before[number] = signal.signal(number, lambda *_: stop.set())
    try:
        yield stop
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def longest_first(jobs):
    """The order in which to start jobs, so that no long one is left for the end."""
    return sorted(jobs, key=lambda job: -job.expected_s)


def without_repetition(jobs):
    """One job for each key: variants may differ in name only."""
    return list({job.key: job for job in jobs}.values())


def unfinished(jobs, store):
    """The jobs without a result. One that was killed from outside tells nothing of the run: it is removed."""
    done, left = store.finished(), []
    for job in without_repetition(jobs):
        if job.key in done and store.result(job.key)["status"] == KILLED:
            store.discard(job.key)
            left.append(job)
        elif job.key not in done:
            left.append(job)
    return left


def run_locally(jobs, store, workers, progress):
    """Does the jobs with `workers` threads. Jobs that another process is at work on are waited for at the end."""
    with stopping_by_signals() as stop, Heartbeat() as heartbeat:
        waiting = longest_first(jobs)
        while waiting:
            waiting = _one_pass(waiting, store, workers, progress, stop, heartbeat)
            owners = sorted({store.owner(job.key) for job in waiting} - {None})
            if owners:
                progress.note(f"waiting for {', '.join(owners)}; a run of a machine that is gone is taken over after {STALE_S:g} s")
            if waiting and stop.wait(POLL_S):
                raise Interrupted("interrupted")


def _one_pass(jobs, store, workers, progress, stop, heartbeat):
    """Returns the jobs that another process is at work on. Once a job throws, no further one is started."""
    busy = []
    with concurrent.futures.ThreadPoolExecutor(workers) as pool:
        futures = {pool.submit(_unless_stopped, job, store, stop, heartbeat): job for job in jobs}
        try:
            for future in concurrent.futures.as_completed(futures):
                if future.result():
                    progress.finish_one(futures[future].key)
                else:
                    busy.append(futures[future])
        except BaseException:
            stop.set()
            for future in futures:
                future.cancel()
            raise
    return busy


def _unless_stopped(job, store, stop, heartbeat):
    if stop.is_set():
        raise Interrupted("interrupted")
    return execute(job, store, stop, heartbeat)


def command_of_task(job, store):
    """The command line by which a worker of Dask does a job."""
    return [sys.executable, PACKAGE, "task", str(store.folder.resolve()), job.to_line()]


def run_by_dask(jobs, store, address, progress, say):
    """Does the jobs by the workers of the scheduler at `address`. Dask repeats tasks whose worker is lost."""
    match = ADDRESS.fullmatch(address)
    if not match or int(match[1]) > MAX_PORT:
        raise UsageError(f"--scheduler '{address}': expected an address such as tcp://192.168.0.2:8786")
    try:
        import distributed
    except ImportError:
        raise BatchError("--scheduler: Dask is missing: pip install 'kinloop[batch]', or use --workers") from None
    try:
        client = distributed.Client(address, timeout=CONNECT_PATIENCE, set_as_default=False)
    except Exception as error:  # each transport has its own
        raise UsageError(f"--scheduler {address}: no scheduler answers ({error}); start one with 'dask scheduler'") from None
    with stopping_by_signals() as stop, client:
        say(f"dashboard {client.dashboard_link}")
        tasks = [client.submit(subprocess.call, command_of_task(job, store), key=f"kinloop-{job.key}", pure=False,
                               retries=TASK_RETRIES, priority=job.expected_s) for job in longest_first(jobs)]  # fmt: skip
        _wait_for_tasks(distributed, tasks, store, progress, stop)


def _wait_for_tasks(distributed, tasks, store, progress, stop):
    by_key = {task.key.removeprefix("kinloop-"): task for task in tasks}
    left = set(by_key)
    while left:
        if stop.wait(POLL_S):
            for task in tasks:
                task.cancel()
            raise Interrupted("interrupted")
        finished = {key for key in left if by_key[key].status != "pending"}
        for key in finished:
            if not store.has(key):
                raise Unfinished(f"run {key}: no result from Dask (task {by_key[key].status}); see the log of its worker, and run "
                                 "the same command again")  # fmt: skip
            progress.finish_one(key)
        left -= finished


def shard_of(jobs, number, count):
    """The jobs of shard `number` (from 1) of `count`: each job, the longest first, goes to the shard with the least to do.
    Depends on the plan only, so that all shards agree."""
    loads, own = [(0.0, shard) for shard in range(1, count + 1)], []
    for job in longest_first(without_repetition(jobs)):
        load, shard = loads[0]
        heapq.heapreplace(loads, (load + max(job.expected_s, SHORTEST_S), shard))
        if shard == number:
            own.append(job)
    return own


def help_others(jobs, store, workers):
    """Does, with `workers` threads, what other shards have not begun. Returns when somebody is at work on each job that is
    left."""
    with stopping_by_signals() as stop, Heartbeat() as heartbeat, concurrent.futures.ThreadPoolExecutor(workers) as pool:
        futures = [pool.submit(_help, jobs, store, stop, heartbeat) for _ in range(workers)]
        try:
            for future in concurrent.futures.as_completed(futures):
                future.result()
        except BaseException:
            stop.set()
            raise


def _help(jobs, store, stop, heartbeat):
    jobs, helped = longest_first(without_repetition(jobs)), True
    while helped:
        helped = any(_unless_stopped(job, store, stop, heartbeat) for job in _free_first(jobs, store))


def _free_first(jobs, store):
    """The unfinished jobs, those that are claimed at the end: their owners may be gone."""
    done, claimed = store.finished(), store.claimed()
    left = [job for job in jobs if job.key not in done]
    return [job for job in left if job.key not in claimed] + [job for job in left if job.key in claimed]


def end_with_parent():
    """Makes this process end when the one that started it does."""
    import ctypes

    parent = os.getppid()
    ctypes.CDLL(None).prctl(1, signal.SIGKILL)
    if os.getppid() != parent:
        sys.exit(1)

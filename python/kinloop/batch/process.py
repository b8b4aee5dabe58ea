"""A program as a process of its own, with limits of time and memory.

In: a command line, limits, a file for its output. Out: how it ended, and what it used."""

import os
import re
import signal
import subprocess
import sys
import time
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from .cgroup import make_group
from .errors import Interrupted

START = str(Path(__file__).with_name("start.py"))
MAX_LOG_BYTES = 200_000
LONGEST_SLEEP_S = 0.1
ERROR = re.compile(rb'^\{"code": "([a-z]+)"\}$', re.MULTILINE)


@dataclass
class Ended:
    """`code`: the exit code, or minus the number of the signal that ended it. `memory_limit`: cgroup, rlimit or none;
    `out_of_memory`: ended by its cgroup. `errors`: the codes of errors that it told, as docs/reliability.md has them."""

    code: int
    timed_out: bool
    wall_s: float
    cpu_s: float
    peak_mib: float
    memory_limit: str = None
    out_of_memory: bool = False
    errors: frozenset = frozenset()


def _kill_group(pid):
    try:
        os.killpg(pid, signal.SIGKILL)
    except ProcessLookupError:
        pass


def _shorten(log):
    """Keeps the first and the last part of a long log."""
    size = log.stat().st_size
    if size <= MAX_LOG_BYTES:
        return
    half = MAX_LOG_BYTES // 2
    with open(log, "rb+") as file:
        begin = file.read(half)
        file.seek(size - half)
        end = file.read(half)
        file.seek(0)
        file.write(begin + b"\n[... left out ...]\n" + end)
        file.truncate()


@contextmanager
def _told_errors():
    """Yields the environment of a program, and a function that returns the codes of the errors that it has told. They go to a
    file in memory: a full disk takes no word."""
    descriptor = os.memfd_create("kinloop-errors")
    try:
        environment = os.environ | {"KINLOOP_ERRORS": f"/proc/{os.getpid()}/fd/{descriptor}"}
        yield environment, lambda: frozenset(ERROR.findall(os.pread(descriptor, MAX_LOG_BYTES, 0)))
    finally:
        os.close(descriptor)


def _run_to_its_end(call, folder, log, time_s, stop, environment):
    """Returns (status and usage as of wait4, whether the time was over)."""
    begin, pause = time.monotonic(), 0.002
    with open(log, "ab") as output:
        process = subprocess.Popen(call, cwd=folder, env=environment, stdin=subprocess.DEVNULL, stdout=output, stderr=output,
                                   start_new_session=True)  # fmt: skip
    timed_out = False
    while True:
        pid, status, usage = os.wait4(process.pid, os.WNOHANG)
        if pid:
            break
        elapsed = time.monotonic() - begin
        if stop.is_set() or elapsed > time_s:
            timed_out = not stop.is_set()
            _kill_group(process.pid)
            pid, status, usage = os.wait4(process.pid, 0)
            break
        stop.wait(min(pause, max(0.0, time_s - elapsed)))
        pause = min(1.5 * pause, LONGEST_SLEEP_S)
    process.returncode = os.waitstatus_to_exitcode(status)
    _kill_group(process.pid)  # what it left behind
    return process.returncode, usage, timed_out


def run_limited(words, folder, log, time_s, memory_mib, stop):
    """Runs a program to its end, and kills it with all that it started after `time_s` seconds. Throws Interrupted once
    the event `stop` is set."""
    log, begin = Path(log), time.monotonic()
    group = make_group(memory_mib) if memory_mib else None
    try:
        limit = f"cgroup:{group.folder}" if group else f"rlimit:{memory_mib}"
        call = [sys.executable, "-I", "-S", START, limit, str(os.getpid()), *words]
        with _told_errors() as (environment, told):
            code, usage, timed_out = _run_to_its_end(call, folder, log, time_s, stop, environment)
            errors = told()
        out_of_memory = group is not None and group.killed_for_memory()
    finally:
        if group:
            group.remove()
    if stop.is_set():
        raise Interrupted("interrupted")
    _shorten(log)
    return Ended(code, timed_out, time.monotonic() - begin, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024,
                 limit.partition(":")[0] if memory_mib else None, out_of_memory, errors)  # fmt: skip

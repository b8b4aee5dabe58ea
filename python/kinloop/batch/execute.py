"""Does one job: claims it, runs it under its limits, keeps what the suite says, and writes its row.

In: a Job and the Store. Out: RESULTS/runs/KEY/ with result.json, log.txt and the kept files. A run that fails is a
result, too; only what did not come from the run itself is repeated: a kill from outside, files that could not be written."""

import fnmatch
import os
import shutil
import signal
import socket
import tempfile
from pathlib import Path

from .errors import BatchError, OutputError
from .figures import of_run, score
from .files import cannot_write, hash_of_file
from .process import run_limited
from .templates import filled

ATTEMPTS = 3  # of a run that is killed from outside, e.g. because the machine has no memory left
RESULT_FILES = ("result.json", "log.txt")
NOT_REPEATABLE = {"run.json", "frames.txt", "report.html", *RESULT_FILES}  # with times of this run
FROM_OUTSIDE = (-signal.SIGKILL, -signal.SIGTERM, -signal.SIGINT, -signal.SIGHUP, 129, 130, 143)
KILLED = "killed"  # the status of a run none of whose attempts survived; the next batch repeats it
STATUS_OF_CODE = {1: "internal error", 2: "wrong use", 3: "bad input", 4: "lost", 127: "not started"}
LEAST_ROOM_BYTES = 1 << 16  # on the disk after a run


def execute(job, store, stop, heartbeat):
    """Does the job unless it is done. Returns whether it is; False: another process is at work on it."""
    if store.has(job.key):
        return True
    claim = store.claim(job.key)
    if claim is None:
        return False
    heartbeat.add(claim)
    try:
        if not store.has(job.key):  # finished just before the claim
            folder = store.begin(job.key)
            try:
                store.finish(job.key, folder, perform(job, folder, stop))
            finally:
                store.abandon(folder)  # what an exception left
    finally:
        heartbeat.remove(claim)
        claim.release()
    return True


def perform(job, folder, stop):
    """Runs the job in `folder`, removes what is not kept, and returns its result."""
    folder = folder.resolve()
    log = folder / "log.txt"
    try:
        log.touch()
        result = _score_external(job, log) if job.kind == "external" else _run(job, folder, log, stop)
        result |= {"key": job.key, "identity": job.identity, "files": hashes_of_files(folder), "host": socket.gethostname()}
        _remove_what_is_not_kept(folder, job.keep)
        return result
    except OSError as error:
        raise cannot_write(folder, error) from None


def _score_external(job, log):
    if not Path(job.external).is_file():
        log.write_text(f"{job.external}: there is no such trajectory\n")
        return {"status": "no trajectory", "exit": "", "figures": {}, "measured": {}, "attempts": 0}
    figures = score(job.program, job.external, job.truth, log)
    return {"status": "done" if "ate_m" in figures else "no truth", "exit": 0, "figures": figures, "measured": {}, "attempts": 1}


def _run(job, folder, log, stop):
    for attempt in range(1, ATTEMPTS + 1):
        ended, prepared = _attempt(job, folder, log, stop)
        if ended.timed_out or ended.out_of_memory or not _is_from_outside(ended):
            break
        if attempt < ATTEMPTS:
            _remove_what_is_not_kept(folder, [])
    _require_outputs(ended, job, folder, log)
    figures, measured = _figures(job, folder, log)
    measured = {"wall_s": ended.wall_s, "cpu_s": ended.cpu_s, "peak_mib": ended.peak_mib, "memory_limit": ended.memory_limit} | measured
    code = signal.Signals(-ended.code).name if ended.code < 0 and not ended.timed_out else max(ended.code, 0)
    status = "not prepared" if not prepared and ended.code > 0 else _status(ended, figures)
    return {"status": status, "exit": "" if ended.timed_out else code, "figures": figures, "measured": measured,
            "attempts": attempt}  # fmt: skip


def _attempt(job, folder, log, stop):
    """Prepares the recording, if the job says so, and runs. Returns how the last of both ended, and whether it was the run.
    The prepared recording is beside `folder`, so that it is not part of the result; each attempt makes it anew."""
    beside = folder.with_name(f"{folder.name}.prepared")
    prepared = beside / Path(job.recording).name  # the name may tell the camera

    def run(words, output):
        words = [filled(word, {"output": output, "prepared": prepared}) for word in words]
        return run_limited(words, folder, log, job.time_s, job.memory_mib, stop)

    try:
        if job.prepare:
            beside.mkdir()
            ended = run(job.prepare, prepared)
            if ended.timed_out or ended.code:
                return ended, False
        return run(job.words, folder), True
    finally:
        shutil.rmtree(beside, ignore_errors=True)


def _figures(job, folder, log):
    """What is known of the run: also of one that failed."""
    figures, measured = (of_run(folder) or ({}, {})) if job.kind == "run" else ({}, {})
    trajectory, live = folder / "trajectory.txt", folder / "live.txt"
    if (job.kind == "command" or job.truth) and trajectory.is_file():
        figures |= score(job.program, trajectory, job.truth, log)
        if live.is_file() and "ate_m" in figures:
            live_figures = score(job.program, live, job.truth, log)
            figures |= {"live_ate_m": live_figures["ate_m"]} if "ate_m" in live_figures else {}
    return figures, measured


def _is_from_outside(ended):
    """Killed, or the machine had no more threads or open files."""
    return ended.code in FROM_OUTSIDE or b"limit" in ended.errors


def _status(ended, figures):
    if ended.timed_out:
        return "time limit"
    if ended.out_of_memory or b"memory" in ended.errors:
        return "out of memory"
    if _is_from_outside(ended):
        return KILLED
    if ended.code < 0:
        return "crashed"
    if ended.code:
        return STATUS_OF_CODE.get(ended.code, "failed")
    if figures.get("frames") == 0:
        return "no frames"
    return "done" if "ate_m" in figures else "no truth"


def _require_outputs(ended, job, folder, log):
    """Throws OutputError after a run that could not write its files, or that has left no room: nobody knows whether they are
    whole. Programs that tell no codes are known by the second only."""
    if b"output" in ended.errors:
        raise OutputError(f"{job.sequence}, {job.variant}, seed {job.seed}: its files cannot be written{_last_line(log)}; make room or "
                          "change permissions, and run the same command again, finished runs are kept")  # fmt: skip
    with tempfile.TemporaryFile(dir=folder) as probe:
        os.posix_fallocate(probe.fileno(), 0, LEAST_ROOM_BYTES)


def _last_line(log):
    lines = log.read_text(errors="replace").split("\n")
    return next((f" ({line.removeprefix('error: ')})" for line in reversed(lines) if line), "")


def hashes_of_files(folder):
    """The hashes of the files that are the same each time, by name."""
    files = (path for path in sorted(folder.rglob("*")) if path.is_file() and not path.is_symlink())
    return {str(path.relative_to(folder)): hash_of_file(path) for path in files if path.name not in NOT_REPEATABLE}


def _remove_what_is_not_kept(folder, keep):
    for path in sorted(folder.rglob("*"), reverse=True):
        name = str(path.relative_to(folder))
        if path.is_dir() and not path.is_symlink():
            if not any(path.iterdir()):
                path.rmdir()
        elif name not in RESULT_FILES and not any(fnmatch.fnmatch(name, pattern) for pattern in keep):
            path.unlink()


def verify(job, store, stop):
    """Runs a finished job again; returns the names of the files that differ. The result stays as it is."""
    before = store.result(job.key)
    if not before:
        raise BatchError(f"{store.run_folder(job.key)}: there is no such run")
    folder = store.begin(f"verify-{job.key}")
    try:
        after = perform(job, folder, stop)
    finally:
        store.abandon(folder)
    differ = {name for name in before["files"].keys() | after["files"].keys()
              if before["files"].get(name) != after["files"].get(name)}  # fmt: skip
    return sorted(differ | ({"figures"} if (before["status"], before["figures"]) != (after["status"], after["figures"]) else set()))

"""The folder of results, which several processes and machines may share.

RESULTS/runs/KEY/       a finished run, never changed; runs/ may be a link to a folder that several RESULTS share
RESULTS/runs/.work/     runs under way; a finished one is renamed
RESULTS/runs/.claims/   who is at work on which run
RESULTS/plan.jsonl      the title of the last suite, then its runs, one a line
RESULTS/inputs/         hashes of recordings, and recordings fetched from URLs"""

import json
import os
import shutil
import socket
import threading
import uuid
from pathlib import Path

from .errors import BatchError
from .files import cannot_write, make_folder, read_json, write_json, write_whole
from .jobs import Job

HEARTBEAT_S = 15.0
STALE_S = 120.0  # without a heartbeat, as seen by the clock of the file system


def _started(pid):
    """When a process of this machine started, in ticks since boot; None if there is none."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[19]
    except (OSError, IndexError):
        return None


def _machine():
    """The name of this machine, and of its processes' name space, since containers share names of machines."""
    try:
        space = os.readlink("/proc/self/ns/pid")
    except OSError:
        space = ""
    return f"{socket.gethostname()} {space}"


class Claim:
    """The right to work on a run: a file that only one process can create.

    Files are numbered: KEY.0, KEY.1, ... Who finds the owner of the last one gone creates the next. So nobody deletes
    a file that another may just have replaced."""

    def __init__(self, folder, key, number):
        self.folder, self.key, self.number = folder, key, number
        self.path = folder / f"{key}.{number}"

    def beat(self):
        try:
            os.utime(self.path)
        except OSError:
            pass  # the run goes on; at worst, it is run twice

    def release(self):
        for number in range(self.number + 1):
            (self.folder / f"{self.key}.{number}").unlink(missing_ok=True)


class Store:
    """The results in a folder."""

    def __init__(self, folder):
        self.folder = Path(folder)
        self.runs, self.inputs = self.folder / "runs", self.folder / "inputs"
        self.work, self.claims = self.runs / ".work", self.runs / ".claims"
        self.plan_file = self.folder / "plan.jsonl"

    def create(self):
        for folder in (self.work, self.claims, self.inputs):
            make_folder(folder)
        return self

    # Plan

    def write_plan(self, title, jobs):
        lines = [json.dumps({"title": title}), *(json.dumps(job.to_json(), sort_keys=True) for job in jobs)]
        write_whole(self.plan_file, "".join(line + "\n" for line in lines))

    def read_plan(self):
        """The title of the last suite and its jobs. Throws BatchError if there is none."""
        try:
            lines = self.plan_file.read_bytes().splitlines()
        except OSError:
            raise BatchError(f"{self.plan_file}: cannot be read; is {self.folder} a folder of kinloop batch?") from None
        for number, line in enumerate(lines, 1):
            try:
                lines[number - 1] = Job(**json.loads(line)) if number > 1 else str(json.loads(line)["title"])
            except (ValueError, TypeError, KeyError, RecursionError):
                raise BatchError(f"{self.plan_file}:{number}: damaged; run the suite or plan again") from None
        return (lines[0], lines[1:]) if lines else ("", [])

    # Results

    def run_folder(self, key):
        return self.runs / key

    def has(self, key):
        return (self.runs / key / "result.json").exists()

    def finished(self):
        """The keys of all finished runs."""
        try:
            return {name for name in os.listdir(self.runs) if not name.startswith(".")}
        except OSError:
            return set()

    def result(self, key):
        return read_json(self.runs / key / "result.json")

    def begin(self, key):
        """A new folder for a run under way; removes those that dead owners left."""
        for left in self.work.glob(f"{key}.*"):
            shutil.rmtree(left, ignore_errors=True)
        return make_folder(self.work / f"{key}.{uuid.uuid4().hex[:8]}")

    @staticmethod
    def abandon(folder):
        """Removes a folder of begin()."""
        shutil.rmtree(folder, ignore_errors=True)

    def finish(self, key, folder, result):
        """Makes a folder of begin() the result of the run."""
        write_json(folder / "result.json", result, durable=True)
        try:
            os.rename(folder, self.runs / key)
        except OSError as error:
            shutil.rmtree(folder, ignore_errors=True)
            if not self.has(key):  # else another process was faster: the same bytes
                raise cannot_write(self.runs / key, error) from None

    def discard(self, key):
        """Removes a finished run, to repeat it."""
        gone = self.work / f"{key}.{uuid.uuid4().hex[:8]}"
        try:
            os.rename(self.runs / key, gone)
            shutil.rmtree(gone)
        except FileNotFoundError:
            pass
        except OSError as error:
            raise cannot_write(gone, error) from None

    # Claims

    def claim(self, key):
        """Returns a Claim; None if another process is at work on the run."""
        last = self._last_claim(key)
        if last is not None and not self._is_stale(self.claims / f"{key}.{last}"):
            return None
        claim = Claim(self.claims, key, 0 if last is None else last + 1)
        owner = {"machine": _machine(), "pid": os.getpid(), "started": _started(os.getpid())}
        try:
            with open(claim.path, "x") as file:
                json.dump(owner, file)
        except FileExistsError:
            return None
        except OSError as error:
            raise cannot_write(claim.path, error) from None
        return claim

    def claimed(self):
        """The keys of all runs that are claimed, also by owners that are gone."""
        return {name.split(".")[0] for name in os.listdir(self.claims)}

    def _last_claim(self, key):
        numbers = [int(path.suffix[1:]) for path in self.claims.glob(f"{key}.*") if path.suffix[1:].isdigit()]
        return max(numbers, default=None)

    def _is_stale(self, path):
        """Whether the owner is gone: its process, if it was on this machine, else its heartbeat."""
        owner = read_json(path)
        if isinstance(owner, dict) and owner.get("machine") == _machine() and isinstance(owner.get("pid"), int):
            return _started(owner["pid"]) != owner.get("started")
        try:
            return self._file_time() - path.stat().st_mtime > STALE_S
        except FileNotFoundError:
            return False  # released just now

    def _file_time(self):
        """Now, by the clock that stamps files: clocks of machines differ."""
        probe = self.claims / f".clock.{uuid.uuid4().hex[:8]}"
        probe.touch()
        try:
            return probe.stat().st_mtime
        finally:
            probe.unlink(missing_ok=True)


class Heartbeat:
    """Tells other machines that the owner of claims is alive, from a thread of its own."""

    def __init__(self):
        self._claims, self._lock, self._done = set(), threading.Lock(), threading.Event()
        self._thread = threading.Thread(target=self._beat, daemon=True)

    def __enter__(self):
        self._thread.start()
        return self

    def __exit__(self, *_):
        self._done.set()
        self._thread.join()

    def add(self, claim):
        with self._lock:
            self._claims.add(claim)

    def remove(self, claim):
        with self._lock:
            self._claims.discard(claim)

    def _beat(self):
        while not self._done.wait(HEARTBEAT_S):
            with self._lock:
                for claim in self._claims:
                    claim.beat()

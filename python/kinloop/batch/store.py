"""The folder of results, which several processes and machines may share.

RESULTS/runs/KEY/       a finished run, never changed; runs/ may be a link to a folder that several RESULTS share
RESULTS/runs/.work/     runs under way; a finished one is renamed
RESULTS/runs/.claims/   who is at work on which run
RESULTS/plan.jsonl      the title of the last suite, then its runs, one a line
RESULTS/inputs/         hashes of recordings, and recordings fetched from URLs"""

import contextlib
import json
import os
import re
import socket
import threading
import uuid
from pathlib import Path

from .errors import BatchError
from .figures import checked_result
from .files import cannot_write, make_folder, open_file, read_json, remove, write_json, write_whole
from .jobs import KEY, Job
from .trust import is_own, signature_of

BOOT_ID = Path("/proc/sys/kernel/random/boot_id")
HEARTBEAT_S = 15.0
MAX_LINE_BYTES = 10_000_000  # of the plan
STALE_S = 120.0  # without a heartbeat, as seen by the clock of the file system


def _started(pid):
    """When a process of this machine started, in ticks since boot; None if there is none."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[19]
    except (OSError, IndexError):
        return None


def _machine():
    """The name of this machine, its boot, since copies of a machine share its name, and the name space of its processes, since
    containers share both."""
    try:
        return f"{socket.gethostname()} {BOOT_ID.read_text().strip()} {os.readlink('/proc/self/ns/pid')}"
    except OSError:
        return socket.gethostname()


class Claim:
    """The right to work on a run: a file that only one process can create.

    Files are numbered: KEY.0, KEY.1, ... Who finds the owner of the last one gone creates the next. So nobody deletes
    a file that another may just have replaced."""

    NAME = re.compile(r"([^.]+)\.([0-9]{1,9})")  # key and number

    def __init__(self, folder, key, number):
        self.folder, self.key, self.number = folder, key, number
        self.path = folder / f"{key}.{number}"

    def beat(self):
        try:
            os.utime(self.path)
        except OSError:
            pass  # the run goes on; at worst, it is run twice

    def release(self):
        for name in _names_in(self.folder):
            claim = self.NAME.fullmatch(name)
            if claim and claim[1] == self.key and int(claim[2]) <= self.number:
                with contextlib.suppress(OSError):  # at worst it lapses
                    os.unlink(self.folder / name)


def _names_in(folder):
    try:
        return os.listdir(folder)
    except OSError:
        return []


class Store:
    """The results in a folder."""

    def __init__(self, folder):
        self.folder = Path(folder)
        self.runs, self.inputs = self.folder / "runs", self.folder / "inputs"
        self.work, self.claims = self.runs / ".work", self.runs / ".claims"
        self.plan_file = self.folder / "plan.jsonl"
        self._finished = set()  # a finished run never changes

    def create(self):
        for folder in (self.work, self.claims, self.inputs):
            make_folder(folder)
        return self

    # Plan

    def write_plan(self, title, jobs):
        lines = "".join(job.to_line() + "\n" for job in jobs).encode()
        write_whole(self.plan_file, json.dumps({"title": title, "signature": signature_of(lines)}).encode() + b"\n" + lines)

    def require_own_plan(self):
        """Throws BatchError if somebody else has written the plan, whose programs would be run."""
        with contextlib.suppress(OSError, ValueError, TypeError, KeyError, RecursionError):
            with open_file(self.plan_file) as file:
                signature = json.loads(file.readline(MAX_LINE_BYTES))["signature"]
                if is_own(file.read(), signature):
                    return
        raise BatchError(f"{self.plan_file}: was not written by you on this machine, and its programs would be run as you; read it, and "
                         "give --trust if you trust it")  # fmt: skip

    def read_plan(self):
        """The title of the last suite and its jobs. Throws BatchError if there is none."""
        number = 1
        try:
            with open_file(self.plan_file) as file:
                title, jobs = str(json.loads(file.readline(MAX_LINE_BYTES))["title"]), []
                while line := file.readline(MAX_LINE_BYTES):
                    number += 1
                    jobs.append(Job.from_line(line))
            return title, jobs
        except OSError as error:
            raise BatchError(f"{self.plan_file}: cannot be read ({error.strerror}); is {self.folder} a folder of kinloop batch?") from None
        except (ValueError, TypeError, KeyError, RecursionError):
            raise BatchError(f"{self.plan_file}:{number}: damaged; run the suite or plan again") from None

    # Results

    def run_folder(self, key):
        return self.runs / key

    def has(self, key):
        """Whether a run is finished. A folder without a readable result is none."""
        if key not in self._finished and self.result(key):
            self._finished.add(key)
        return key in self._finished

    def finished(self):
        """The keys of all finished runs."""
        try:
            return {name for name in os.listdir(self.runs) if KEY.fullmatch(name) and self.has(name)}
        except OSError:
            return set()

    def result(self, key):
        """What figures.checked_result makes of the result of a run; None if there is none."""
        return checked_result(read_json(self.runs / key / "result.json"))

    def begin(self, key):
        """A new folder for a run under way; removes those that dead owners left."""
        for left in self.work.glob(f"{key}.*"):
            remove(left)
        return make_folder(self.work / f"{key}.{uuid.uuid4().hex[:8]}")

    @staticmethod
    def abandon(folder):
        """Removes a folder of begin()."""
        remove(folder)

    def finish(self, key, folder, result):
        """Makes a folder of begin() the result of the run."""
        write_json(folder / "result.json", result, durable=True)
        try:
            try:
                os.rename(folder, self.runs / key)
            except OSError:  # there is one
                if self.has(key):  # of another process that was faster: the same bytes
                    return remove(folder)
                self.discard(key)
                os.rename(folder, self.runs / key)
        except OSError as error:
            raise cannot_write(self.runs / key, error) from None

    def discard(self, key):
        """Removes a run, to repeat it."""
        gone = self.work / f"{key}.{uuid.uuid4().hex[:8]}"
        self._finished.discard(key)
        try:
            os.rename(self.runs / key, gone)
        except FileNotFoundError:
            return
        except OSError as error:
            raise cannot_write(gone, error) from None
        remove(gone)

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
            claim.release()  # it says nothing of its owner
            raise cannot_write(claim.path, error) from None
        return claim

    def claimed(self):
        """The keys of all runs that are claimed, also by owners that are gone."""
        return {name.split(".")[0] for name in _names_in(self.claims)}

    def owner(self, key):
        """Who is at work on a run, in words; None if nobody is."""
        last = self._last_claim(key)
        if last is None:
            return None
        machine, pid = self._owner_of(self.claims / f"{key}.{last}")[:2]
        return f"process {pid}" if machine == _machine() else f"machine {machine.split()[0]}" if machine.split() else "an unknown machine"

    def _last_claim(self, key):
        claims = (Claim.NAME.fullmatch(name) for name in _names_in(self.claims))
        return max((int(claim[2]) for claim in claims if claim and claim[1] == key), default=None)

    @staticmethod
    def _owner_of(path):
        """(machine, number of the process, its start) of a claim, which may be damaged."""
        owner = read_json(path)
        owner = owner if isinstance(owner, dict) else {}
        return str(owner.get("machine", "")), owner.get("pid"), owner.get("started")

    def _is_stale(self, path):
        """Whether the owner is gone: its process, if it was on this machine, else its heartbeat."""
        machine, pid, started = self._owner_of(path)
        if machine == _machine():
            return started is None or _started(pid) != started
        try:
            return abs(self._file_time() - path.lstat().st_mtime) > STALE_S
        except FileNotFoundError:
            return False  # released just now

    def _file_time(self):
        """Now, by the clock that stamps files: clocks of machines differ."""
        probe = self.claims / f".clock.{uuid.uuid4().hex[:8]}"
        try:
            probe.touch()
            return probe.stat().st_mtime
        except OSError as error:
            raise cannot_write(probe, error) from None
        finally:
            with contextlib.suppress(OSError):
                probe.unlink()


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

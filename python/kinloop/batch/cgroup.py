"""Limits of memory by cgroup v2: for all processes of a run together, and of all kinds of memory.

That takes a cgroup whose children this process may make, as under `systemd-run --user --scope -p Delegate=yes`. Anywhere
else start.py limits each process by RLIMIT_DATA."""

import os
import time
import uuid
from pathlib import Path

ROOT = Path("/sys/fs/cgroup")
LEAF = "kinloop-batch"  # the group that this process moves to, since only groups without processes have limited children
REMOVAL_PATIENCE_S = 1.0


def _own_group():
    """The folder of the group of this process; None without cgroup v2."""
    try:
        for line in Path("/proc/self/cgroup").read_text().splitlines():
            if line.startswith("0::/"):
                return ROOT / line[4:]
    except OSError:
        pass
    return None


def enter_leaf():
    """Makes place for groups of runs beside this process, if it is alone in its group and may."""
    own = _own_group()
    try:
        if own is None or own.name == LEAF or (own / "cgroup.procs").read_text().split() != [str(os.getpid())]:
            return
        if "memory" not in (own / "cgroup.controllers").read_text().split():
            return
        (own / LEAF).mkdir(exist_ok=True)
        (own / LEAF / "cgroup.procs").write_text(str(os.getpid()))
        (own / "cgroup.subtree_control").write_text("+memory")
    except OSError:
        pass  # not ours to change: runs are limited by RLIMIT_DATA


class Group:
    """The group of one run."""

    def __init__(self, folder):
        self.folder = folder

    def killed_for_memory(self):
        try:
            events = dict(line.split() for line in (self.folder / "memory.events").read_text().splitlines())
            return int(events.get("oom_kill", 0)) > 0
        except (OSError, ValueError):
            return False

    def remove(self):
        """Ends what is left in it."""
        end = time.monotonic() + REMOVAL_PATIENCE_S
        try:
            (self.folder / "cgroup.kill").write_text("1")
            while True:
                try:
                    return self.folder.rmdir()
                except OSError:
                    if time.monotonic() > end:
                        raise
                    time.sleep(0.01)  # processes that were killed go one by one
        except OSError:
            pass


def make_group(memory_mib):
    """A group with a limit of memory, which a process enters by writing its id to cgroup.procs; None where none can be made."""
    own = _own_group()
    if own is None or own.name != LEAF:
        return None
    group = Group(own.parent / f"kinloop-run-{uuid.uuid4().hex[:12]}")
    try:
        group.folder.mkdir()
        (group.folder / "memory.max").write_text(str(memory_mib << 20))
        (group.folder / "memory.oom.group").write_text("1")
        if (swap := group.folder / "memory.swap.max").exists():
            swap.write_text("0")
        return group
    except OSError:
        group.remove()
        return None

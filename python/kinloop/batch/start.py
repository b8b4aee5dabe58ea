"""Starts a program under limits: python3 -I -S start.py LIMIT PARENT PROGRAM ARGUMENTS...

LIMIT of memory: rlimit:MIB (0: none) or cgroup:FOLDER, which has the limit. PARENT: the id of the process that calls.

A program of its own, since a process with threads must not run Python between fork and exec. The program ends with its
parent, so that nothing goes on running when a worker is killed."""

import ctypes
import os
import resource
import signal
import sys

PR_SET_PDEATHSIG = 1
NOT_STARTED = 127


def main():
    (kind, _, limit), parent, words = sys.argv[1].partition(":"), int(sys.argv[2]), sys.argv[3:]
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:  # it ended before the line above
        return
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    if kind == "rlimit" and int(limit):
        # Private memory that can be written: the heap and the stacks of threads, not libraries and files.
        resource.setrlimit(resource.RLIMIT_DATA, (int(limit) << 20, int(limit) << 20))
    try:
        if kind == "cgroup":
            with open(f"{limit}/cgroup.procs", "w") as processes:
                processes.write(str(os.getpid()))
        os.execv(words[0], words)
    except OSError as error:
        print(f"{words[0]}: cannot be started ({error.strerror})", file=sys.stderr)
        sys.exit(NOT_STARTED)


main()

"""Limits of memory by cgroups: the rules with a folder that stands for the file system of cgroups, the kernel where it lets."""

import os
import pathlib
import subprocess
import sys
import unittest
import unittest.mock

from support import PACKAGE, BatchTest

from kinloop.batch import cgroup

# Allocates 1 GB in two processes of 500 MB: each is within a limit of 600 MiB, together they are not.
HOARD = "import os, time\nos.fork()\nhoard = b'x' * (500 << 20)\ntime.sleep(3)\n"


class StandIn(BatchTest):
    """The tests' process is alone in the group `scope`."""

    def setUp(self):
        super().setUp()
        self.scope = self.folder / "cgroups/scope"
        self.write("cgroups/scope/cgroup.procs", f"{os.getpid()}\n")
        self.write("cgroups/scope/cgroup.controllers", "cpu memory pids\n")
        self.own = self.scope
        patch = unittest.mock.patch("kinloop.batch.cgroup._own_group", lambda: self.own)
        patch.start()
        self.addCleanup(patch.stop)

    def enter(self):
        cgroup.enter_leaf()
        self.own = self.scope / cgroup.LEAF

    def runs(self):
        return list(self.scope.glob("kinloop-run-*"))

    def run_command(self, script, memory="100 MiB"):
        self.recording("room")
        self.write("script.sh", script)
        self.run_suite(f"sequences: [room]\nvariants: {{a: {{command: 'sh script.sh {{output}}'}}}}\nlimits: {{memory: {memory}}}\n")
        return self.rows()[0]

    def test_this_process_leaves_its_group_to_the_runs(self):
        self.enter()
        self.assertEqual((self.own / "cgroup.procs").read_text(), str(os.getpid()))
        self.assertEqual((self.scope / "cgroup.subtree_control").read_text(), "+memory")
        group = cgroup.make_group(100)
        self.assertEqual(group.folder.parent, self.scope)
        self.assertEqual((group.folder / "memory.max").read_text(), str(100 << 20))

    def test_a_group_with_other_processes_or_without_the_controller_is_left_alone(self):
        for file, text in (("cgroup.procs", f"1\n{os.getpid()}\n"), ("cgroup.controllers", "cpu pids\n")):
            before = (self.scope / file).read_text()
            (self.scope / file).write_text(text)
            cgroup.enter_leaf()
            self.assertFalse((self.scope / cgroup.LEAF).exists())
            self.assertIsNone(cgroup.make_group(100))
            (self.scope / file).write_text(before)

    def test_a_run_enters_its_group_and_the_row_says_so(self):
        self.enter()
        row = self.run_command("echo $$; echo '1.0 0 0 0 0 0 0 1' > $1/trajectory.txt\n")
        self.assertEqual((row["status"], row["memory_limit"]), ("done", "cgroup"))
        (folder,) = self.runs()  # the kernel would have removed it
        pid = (self.results / "runs" / row["key"] / "log.txt").read_text().split()[0]
        self.assertEqual((folder / "cgroup.procs").read_text(), pid)
        self.assertEqual((folder / "cgroup.kill").read_text(), "1")

    def test_a_run_that_its_group_ends_is_out_of_memory_and_not_repeated(self):
        self.enter()
        row = self.run_command(f"for g in {self.scope}/kinloop-run-*; do echo 'oom_kill 1' > $g/memory.events; done; kill -9 $$\n")
        self.assertEqual((row["status"], row["exit"]), ("out of memory", "SIGKILL"))
        self.assertEqual(len(self.runs()), 1)

    def test_without_a_group_the_limit_is_that_of_each_process(self):
        row = self.run_command("ulimit -d; echo '1.0 0 0 0 0 0 0 1' > $1/trajectory.txt\n")
        self.assertEqual((row["status"], row["memory_limit"]), ("done", "rlimit"))
        self.assertEqual((self.results / "runs" / row["key"] / "log.txt").read_text().split()[0], str(100 << 10))
        self.run_suite("sequences: [sim:room]\n")
        self.assertEqual(self.rows()[0]["memory_limit"], "")


class Kernel(BatchTest):
    def test_a_group_limits_all_processes_of_a_run_together(self):
        scope = ["systemd-run", "--user", "--scope", "--quiet", "-p", "Delegate=yes"]
        if subprocess.run([*scope, "true"], capture_output=True, check=False).returncode:
            self.skipTest("no user instance of systemd that delegates cgroups")
        self.recording("room")
        self.write("hoard.py", HOARD)
        suite = self.write("suite.yaml", f"sequences: [room]\nlimits: {{memory: 600 MiB}}\n"
                                         f"variants: {{a: {{command: '{sys.executable} hoard.py {{output}}'}}}}\n")  # fmt: skip
        subprocess.run([*scope, sys.executable, str(PACKAGE), suite, "-o", self.results, "--program", self.program], check=True)
        (row,) = self.rows()
        if row["memory_limit"] == "rlimit":
            self.skipTest("cgroup v2 does not control memory here")
        self.assertEqual((row["status"], row["memory_limit"]), ("out of memory", "cgroup"))


class NoSuchFileSystem(unittest.TestCase):
    def test_the_group_of_this_process_is_found_or_there_is_none(self):
        own = cgroup._own_group()
        self.assertTrue(own is None or own.is_relative_to(pathlib.Path("/sys/fs/cgroup")))


if __name__ == "__main__":
    unittest.main()

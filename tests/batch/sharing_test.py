"""Several processes at one folder of results, and processes that are killed."""

import errno
import json
import os
import random
import signal
import subprocess
import sys
import threading
import time
import unittest
import unittest.mock

from support import SOURCE, BatchTest

from kinloop.batch.errors import OutputError
from kinloop.batch.files import remove

ROOMS = "sequences: ['sim:room:1..{}']\nvariants: {{a: {{set: {{fake.sleep: {}}}}}}}\n"


class Claims(BatchTest):
    def store(self):
        from kinloop.batch.store import Store

        return Store(self.results).create()

    def test_only_one_of_many_threads_gets_a_claim(self):
        store, got, begin = self.store(), [], threading.Barrier(16)

        def claim():
            begin.wait()
            got.append(store.claim("key"))

        threads = [threading.Thread(target=claim) for _ in range(16)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        (claim,) = [claim for claim in got if claim]
        self.assertIsNone(store.claim("key"))
        claim.release()
        self.assertIsNotNone(store.claim("key"))

    def test_the_claim_of_a_dead_process_of_this_machine_is_taken_over_once(self):
        store = self.store()
        claim = store.claim("key")
        owner = json.loads(claim.path.read_text())
        claim.path.write_text(json.dumps(owner | {"started": "1"}))  # another process, with the number of this one
        second = store.claim("key")
        self.assertIsNotNone(second)
        self.assertIsNone(store.claim("key"))
        second.release()
        self.assertEqual(list(store.claims.iterdir()), [])

    def test_the_claim_of_another_machine_is_taken_over_without_a_heartbeat(self):
        from kinloop.batch.store import STALE_S

        store = self.store()
        claim = store.claim("key")
        for text in ('{"machine": "other", "pid": 1, "started": "1"}', "", "[]", '{"machine": 1}'):
            claim.path.write_text(text)
            self.assertIsNone(store.claim("key"), text)
            os.utime(claim.path, (1, time.time() - STALE_S - 10))
            later = store.claim("key")
            self.assertIsNotNone(later, text)
            later.release()
            claim = store.claim("key")

    def test_the_slower_of_two_processes_leaves_the_result_of_the_faster(self):
        store = self.store()
        first, second = store.begin("key"), store.work / "key.slow"
        second.mkdir()
        result = {"status": "done", "exit": "0", "files": {}, "figures": {}, "measured": {}}
        store.finish("key", first, result)
        store.finish("key", second, result | {"status": "lost"})
        self.assertEqual(store.result("key"), result)
        self.assertEqual(list(store.work.iterdir()), [])

    def test_copies_of_a_machine_that_share_its_name_are_told_apart(self):
        store = self.store()
        claim = store.claim("key")
        boot = self.write("boot_id", "another boot\n")
        with unittest.mock.patch("kinloop.batch.store.BOOT_ID", boot):
            self.assertIsNone(store.claim("key"), "the number of its process says nothing here")
            self.assertTrue(store.owner("key").startswith("machine "))
        self.assertEqual(store.owner("key"), f"process {os.getpid()}")
        claim.release()
        self.assertIsNone(store.owner("key"))

    def test_no_name_or_content_of_a_claim_is_a_crash_or_waits_for_ever(self):
        from kinloop.batch.store import STALE_S

        store = self.store()
        late = time.time() - STALE_S - 10
        for name, make in [("key.0", os.mkdir), ("key.0", os.mkfifo), ("key.0", lambda path: os.symlink("nowhere", path)),
                           ("key.999999999", os.mkdir), ("key.\u00b2", os.mkdir), ("key.", os.mkdir), ("key", os.mkdir),
                           ("key." + "9" * 99, os.mkdir)]:  # fmt: skip
            make(store.claims / name)
            self.assertIn(store.owner("key"), (None, "an unknown machine"), name)
            os.utime(store.claims / name, (late, late), follow_symlinks=False)
            claim = store.claim("key")
            self.assertIsNotNone(claim, name)
            self.assertIsNone(store.claim("key"), name)
            claim.release()
            remove(store.claims / name)
        claim = store.claim("key")
        good = json.loads(claim.path.read_text())
        for change in ({"started": None, "pid": 10**9}, {"pid": None}, {"pid": [1]}, {"pid": -1}, {"started": 7}):
            claim.path.write_text(json.dumps(good | change))
            self.assertIsNotNone(store.claim("key"), change)
            for path in store.claims.iterdir():
                remove(path)
        claim.path.write_text("{}")
        os.utime(claim.path, (time.time() + 1e6,) * 2)  # a clock that was wrong
        self.assertIsNotNone(store.claim("key"))

    def test_a_claim_that_cannot_be_written_is_none(self):
        store = self.store()
        with unittest.mock.patch("json.dump", side_effect=OSError(errno.ENOSPC, "full")), self.assertRaises(OutputError):
            store.claim("key")
        self.assertEqual(list(store.claims.iterdir()), [])


class Processes(BatchTest):
    def command(self, suite, results=None):
        return [suite, "-o", results or self.results, "--program", self.program, "--workers", 2, "-q"]

    def test_two_processes_share_the_work(self):
        suite = self.write("suite.yaml", ROOMS.format(12, 0.1))
        both = [self.start(*self.command(suite)) for _ in range(2)]
        for process in both:
            self.assertEqual(process.wait(60), 0, process.stderr.read())
            process.stderr.close()
        self.assertEqual(len(self.calls()), 12)
        self.assertEqual([row["status"] for row in self.rows()], ["done"] * 12)

    def test_a_wait_for_another_machine_is_said(self):
        suite = self.write("suite.yaml", ROOMS.format(1, 0))
        self.batch("plan", suite, "-o", self.results, "--program", self.program)
        (key,) = [json.loads(line)["key"] for line in (self.results / "plan.jsonl").read_text().splitlines()[1:]]
        claim = self.write(f"results/runs/.claims/{key}.0", '{"machine": "far\\u001b boot pid", "pid": 1}')
        threading.Timer(1.5, claim.unlink).start()
        output = self.run_suite(ROOMS.format(1, 0))
        self.assertEqual(output.count("waiting for machine far\\x1b; a run of a machine that is gone is taken over after 120 s"), 1)
        self.assertEqual(self.rows()[0]["status"], "done")

    def test_results_may_share_a_folder_of_runs(self):
        self.run_suite(ROOMS.format(3, 0))
        other = self.folder / "other"
        other.mkdir()
        (other / "runs").symlink_to(self.results / "runs")
        self.run_suite(ROOMS.format(4, 0), results=other)
        self.assertEqual(len(self.calls()), 4)

    def test_an_interrupted_batch_ends_at_once_and_resumes_with_the_same_table(self):
        self.run_suite(ROOMS.format(6, 0.2), results=self.folder / "whole")
        suite = self.write("suite.yaml", ROOMS.format(6, 0.2))
        for number in (signal.SIGINT, signal.SIGTERM):
            process = self.start(*self.command(suite))
            calls = len(self.calls())
            while len(self.calls()) < calls + 2:
                time.sleep(0.01)
            process.send_signal(number)
            self.assertEqual(process.wait(20), 130)
            self.assertIn("interrupted", process.stderr.read())
            process.stderr.close()
            self.assertIn("not run", [row["status"] for row in self.rows()])
        self.run_suite(ROOMS.format(6, 0.2))
        self.assertEqual(self.table(), self.table(self.folder / "whole"))

    def test_killed_at_random_resume_gives_the_same_table(self):
        text = ROOMS.format(8, 0.05)
        self.run_suite(text, results=self.folder / "whole")
        suite, rng, kills = self.write("suite.yaml", text), random.Random(5), 0
        while kills < 6:
            process = self.start(*self.command(suite))
            time.sleep(rng.uniform(0.1, 0.5))
            process.kill()
            kills += process.wait() == -signal.SIGKILL
            process.stderr.close()
            if kills == 0 or process.returncode == 0:
                break  # it was faster than this test
        self.run_suite(text)
        self.assertEqual(self.table(), self.table(self.folder / "whole"))
        self.assertEqual([path.name for path in (self.results / "runs/.claims").iterdir()], [])

    def test_two_batches_in_one_folder_that_are_killed_give_the_same_table(self):
        (self.folder / "bench").mkdir()
        call = [sys.executable, SOURCE / "bench/batch/kill.py", self.program, self.folder / "bench/out", "--kills", 5, "--rooms", 5,
                "--longest-pause", 0.4]  # fmt: skip
        done = subprocess.run([str(word) for word in call], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertRegex(done.stdout, r"killed [1-5] times(.|\n)*table the same, 20 files the same")

    def test_a_run_ends_with_the_process_that_started_it(self):
        suite = self.write("suite.yaml", "sequences: [sim:room]\nvariants: {a: {set: {fake.do: hang}}}\n")
        process = self.start(*self.command(suite))
        while not self.calls():
            time.sleep(0.01)
        process.kill()
        process.wait()
        process.stderr.close()
        end = time.time() + 20
        while running := [line for line in self.processes() if self.calls()[0] in line]:
            self.assertLess(time.time(), end, running)
            time.sleep(0.05)

    def test_an_interrupt_before_the_runs_is_one_line(self):
        process = self.start(self.write("suite.yaml", "sequences: [room]"), "-o", self.results, "--program", self.write_script("sleep 60"))
        while not self.calls_file.exists():
            time.sleep(0.01)
        process.send_signal(signal.SIGINT)
        self.assertEqual((process.communicate(timeout=20)[1], process.returncode), ("error: interrupted\n", 130))

    def write_script(self, text):
        """A program that says on $FAKE_CALLS that it was started."""
        path = self.write("script", f"#!/bin/sh\necho >> $FAKE_CALLS\nexec {text}\n")
        path.chmod(0o755)
        return path

    @staticmethod
    def processes():
        found = []
        for pid in filter(str.isdigit, os.listdir("/proc")):
            try:
                with open(f"/proc/{pid}/cmdline", "rb") as file:
                    found.append(file.read().replace(b"\0", b" ").decode(errors="replace"))
            except OSError:
                continue
        return found


if __name__ == "__main__":
    unittest.main()

"""kinloop batch --slurm, with stand-ins for sbatch, squeue and scancel."""

import os
import signal
import time
import unittest
import unittest.mock

from support import BatchTest

SUITE = "sequences: ['sim:room:1..5']\nvariants: {a: {set: {fake.sleep: SLEEP}}}\n"
SBATCH = """#!/bin/sh
printf '%s\\n' "$@" > FOLDER/arguments
for last; do :; done
[ "$1 $2" = "--parsable --bad" ] && { echo "sbatch: error: invalid partition specified: bad" >&2; exit 1; }
count=$(sed -n 's/#SBATCH --array=1-//p' "$last")
(
  for i in $(seq "$count"); do
    [ -e FOLDER/cancelled ] || [ $i = "$LEFT_OUT" ] || {
      SLURM_ARRAY_TASK_ID=$i sh "$last" & echo $! > FOLDER/task; wait; }
  done; touch FOLDER/ended ) > FOLDER/log 2>&1 &
echo "4711;cluster"
"""
SQUEUE = """#!/bin/sh
[ "$*" = "-h -j 4711" ] || exit 9
[ -e FOLDER/down ] && { rm FOLDER/down; echo "slurm_load_jobs error: Unable to contact slurm controller" >&2; exit 1; }
[ -e FOLDER/ended ] || echo "4711_1 running"
"""
SCANCEL = "#!/bin/sh\necho $1 > FOLDER/cancelled\nkill $(cat FOLDER/task)\n"


class Slurm(BatchTest):
    def setUp(self):
        super().setUp()
        for name, text in (("sbatch", SBATCH), ("squeue", SQUEUE), ("scancel", SCANCEL)):
            self.write(f"bin/{name}", text.replace("FOLDER", str(self.folder))).chmod(0o755)
        path = f"{self.folder}/bin:{os.environ['PATH']}"
        for patch in (unittest.mock.patch.dict(os.environ, {"PATH": path}), unittest.mock.patch("kinloop.batch.cluster.POLL_S", 0.05),
                      unittest.mock.patch("kinloop.batch.cluster.SETTLING_S", 0.2)):  # fmt: skip
            patch.start()
            self.addCleanup(patch.stop)
        self.addCleanup(self.wait_for_job)

    def wait_for_job(self):
        while (self.folder / "arguments").exists() and not (self.folder / "ended").exists():
            time.sleep(0.01)

    def submit(self, *options, sleep=0, expect=0):
        suite = self.write("suite.yaml", SUITE.replace("SLEEP", str(sleep)))
        return self.batch(suite, "-o", self.results, "--program", self.program, *options, expect=expect)

    def test_a_job_is_submitted_with_the_options_and_gives_the_table_of_local_workers(self):
        self.run_suite(SUITE.replace("SLEEP", "0"), results=self.folder / "local")
        output = self.submit("--slurm", "--partition=short --comment='two words'", "--shards", 2)
        self.assertIn("slurm job  4711\n", output)
        self.assertIn("5 done", output)
        self.assertEqual((self.folder / "arguments").read_text().splitlines(),
                         ["--parsable", "--partition=short", "--comment=two words", str(self.results / "slurm.sh")])  # fmt: skip
        self.assertIn("--array=1-2\n", (self.results / "slurm.sh").read_text())
        self.assertEqual(self.table(), self.table(self.folder / "local"))
        self.assertEqual(len(self.calls()), 10)

    def test_nothing_is_submitted_for_finished_runs(self):
        self.run_suite(SUITE.replace("SLEEP", "0"))
        self.submit("--slurm", "")
        self.assertFalse((self.folder / "arguments").exists())

    def test_a_controller_that_does_not_answer_is_waited_for(self):
        self.write("down", "")
        self.assertIn("5 done", self.submit("--slurm", "", "--shards", 1, sleep=0.1))
        self.assertFalse((self.folder / "down").exists())

    def test_a_job_that_ends_without_all_results_is_an_error_and_the_rest_is_in_the_table(self):
        self.run_suite(SUITE.replace("SLEEP", "0").replace("1..5", "1..3"))
        with unittest.mock.patch.dict(os.environ, {"LEFT_OUT": "1"}):
            output = self.submit("--slurm", "", "--shards", 1, expect=3)
        self.assertIn("slurm job 4711 has ended, and 2 runs have no result", output)
        self.assertEqual(sorted(row["status"] for row in self.rows()), ["done"] * 3 + ["not run"] * 2)
        (self.folder / "ended").unlink()
        self.assertIn("5 runs, 2 to do", self.submit("--slurm", "", "--shards", 1))

    def test_the_runs_of_a_task_that_never_starts_are_done_by_the_others(self):
        with unittest.mock.patch.dict(os.environ, {"LEFT_OUT": "2"}):
            self.assertIn("5 done", self.submit("--slurm", "", "--shards", 2))
        self.assertEqual(len(self.calls()), 5)

    def test_ctrl_c_cancels_the_job(self):
        suite = self.write("suite.yaml", SUITE.replace("SLEEP", "0.5"))
        process = self.start(suite, "-o", self.results, "--program", self.program, "--slurm", "")
        while not self.calls():
            time.sleep(0.01)
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.wait(30), 130)
        process.stderr.close()
        self.assertEqual((self.folder / "cancelled").read_text(), "4711\n")
        self.wait_for_job()
        self.assertLess(len(self.calls()), 5)

    def test_what_slurm_refuses_is_told_in_its_words(self):
        self.assertIn("error: --slurm: sbatch: invalid partition specified: bad", self.submit("--slurm", "--bad", expect=3))
        (self.folder / "arguments").unlink()
        self.assertIn("No closing quotation", self.submit("--slurm", "'", expect=2))
        self.assertIn("exclude each other", self.submit("--slurm", "", "--workers", 2, expect=2))
        (self.folder / "bin/sbatch").unlink()
        with unittest.mock.patch.dict(os.environ, {"PATH": str(self.folder / "bin")}):
            self.assertIn("sbatch cannot be run (No such file or directory)", self.submit("--slurm", "", expect=3))


if __name__ == "__main__":
    unittest.main()

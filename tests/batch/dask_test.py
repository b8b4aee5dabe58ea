"""Workers of a Dask scheduler, URLs of fsspec, and Parquet; skipped (77) without distributed and pyarrow, which
scripts/install_test_packages.sh installs."""

import json
import subprocess
import sys
import time
import unittest
import unittest.mock

try:
    import distributed  # noqa: F401
    import pyarrow.parquet
except ImportError as error:
    print(f"skipped: {error}; see scripts/install_test_packages.sh")
    sys.exit(77)

from support import BatchTest

SUITE = "sequences: ['sim:room:1..6']\nseeds: [1, 2]\nvariants: {a: {set: {fake.sleep: 0.2}}}\n"


class Dask(BatchTest):
    def start_dask(self, *words):
        process = subprocess.Popen([sys.executable, "-m", "distributed.cli." + words[0], *words[1:]], cwd=self.folder,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)  # fmt: skip
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        return process

    def worker(self):
        return self.start_dask("dask_worker", "--scheduler-file", "scheduler.json", "--nthreads", "1", "--no-nanny", "--no-dashboard")

    def address(self):
        self.start_dask("dask_scheduler", "--scheduler-file", "scheduler.json", "--port", "0", "--no-dashboard")
        file = self.folder / "scheduler.json"
        while not file.exists() or not file.read_text().endswith("}"):
            time.sleep(0.05)
        return json.loads(file.read_text())["address"]

    def test_two_workers_of_a_scheduler_give_the_same_table_also_when_one_is_killed(self):
        self.run_suite(SUITE, results=self.folder / "local")
        calls, address = len(self.calls()), self.address()
        first, _ = self.worker(), self.worker()
        process = self.start(self.folder / "suite.yaml", "-o", self.results, "--program", self.program, "--scheduler", address)
        while len(self.calls()) < calls + 3:
            self.assertIsNone(process.poll(), process.poll() and process.stderr.read())
            time.sleep(0.05)
        first.kill()
        _, text = process.communicate(timeout=120)
        self.assertEqual(process.returncode, 0, text)
        self.assertIn("dashboard", text)
        self.assertEqual(self.table(), self.table(self.folder / "local"))
        self.assertLessEqual(len(self.calls()) - calls, 12 + 1)

    def test_an_address_without_a_scheduler_is_refused(self):
        suite = self.write("suite.yaml", SUITE)
        with unittest.mock.patch("kinloop.batch.workers.CONNECT_PATIENCE", "0.5s"):
            output = self.batch(suite, "-o", self.results, "--program", self.program, "--scheduler", "tcp://127.0.0.1:9", expect=2)
        self.assertIn("no scheduler answers", output)


class Urls(BatchTest):
    def test_a_recording_at_a_url_is_copied_once_and_has_the_key_of_the_same_bytes(self):
        room = self.recording("store/room")
        self.run_suite(f"sequences: ['file://{room}']")
        (row,) = self.rows()
        self.assertEqual((row["sequence"], row["status"]), ("room", "done"))
        (room / "rgb/1.png").write_text("another image")
        self.run_suite(f"sequences: ['file://{room}']")
        self.assertEqual(self.rows(), [row])
        self.assertEqual(len(self.calls()), 1)
        self.assertIn("cannot be fetched", self.run_suite(f"sequences: ['file://{self.folder}/nothing']", expect=3))


class Parquet(BatchTest):
    def test_parquet_has_the_rows_of_the_csv(self):
        self.run_suite("sequences: ['sim:room:1..3']\nvariants: {a: {set: {fake.do: no_truth}}, b: }\n")
        table = pyarrow.parquet.read_table(self.results / "runs.parquet").to_pylist()
        self.assertEqual(len(table), 6)
        for row, expected in zip(table, self.rows(), strict=True):
            self.assertEqual(list(row), list(expected))
            self.assertEqual(row["seed"], expected["seed"])
            if expected["ate_m"] is None:
                self.assertIsNone(row["ate_m"])
            else:
                self.assertAlmostEqual(row["ate_m"], expected["ate_m"], 7)


if __name__ == "__main__":
    unittest.main()

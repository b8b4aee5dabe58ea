"""Tests of .ci/check_disturbed.py, what it counts, and .ci/check_size.py; skipped (77) without numpy or Pillow."""

import contextlib
import importlib.util
import io
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

try:
    import numpy as np
    import PIL  # noqa: F401
except ImportError as error:
    print(f"skipped: {error}")
    sys.exit(77)

SOURCE = pathlib.Path(__file__).resolve().parents[2]


def load(path):
    """A script as a module."""
    spec = importlib.util.spec_from_file_location(path.stem, path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


disturbed = load(SOURCE / ".ci/check_disturbed.py")
import loop_error  # noqa: E402  (found by what was loaded)
import look_alikes  # noqa: E402

COUNTS = {"frames": 80, "silent": 1, "false_loops": 1, "available": 60}


class Temporary(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.addCleanup(self.temporary.cleanup)
        self.folder = pathlib.Path(self.temporary.name)


class DisturbedTable(Temporary):
    def test_what_is_worse_and_what_is_better(self):
        for name, worse, better in (("silent", 2, 0), ("false_loops", 2, 0), ("available", 59, 61)):
            self.assertEqual(disturbed.changes(COUNTS, {**COUNTS, name: worse}), ([f"{name} {COUNTS[name]} -> {worse}"], []))
            self.assertEqual(disturbed.changes(COUNTS, {**COUNTS, name: better}), ([], [f"{name} {COUNTS[name]} -> {better}"]))
        self.assertEqual(disturbed.changes(COUNTS, COUNTS), ([], []))
        self.assertEqual(len(disturbed.changes(COUNTS, {**COUNTS, "frames": 79})[0]), 1)

    def check(self, result, *words):
        """The exit code, the output and the table after a check in which every run gives this result."""
        table = self.folder / "runs.csv"
        table.write_text("room,case,seed,length,frames,silent,false_loops,available\nroom,mover,1,80,80,1,1,60\n")
        argv, sys.argv = sys.argv, ["check", str(table), *words]
        run_all, disturbed.measure = disturbed.measure, lambda run, program: result
        pool, disturbed.concurrent.futures.ProcessPoolExecutor = (disturbed.concurrent.futures.ProcessPoolExecutor,
                                                                  disturbed.concurrent.futures.ThreadPoolExecutor)
        try:
            with contextlib.redirect_stdout(io.StringIO()) as output:
                return disturbed.main(), output.getvalue(), table.read_text().splitlines()[1]
        finally:
            sys.argv, disturbed.measure, disturbed.concurrent.futures.ProcessPoolExecutor = argv, run_all, pool

    def test_fails_if_a_run_is_worse_or_has_no_result(self):
        self.assertEqual(self.check(COUNTS)[0], 0)
        code, output, table = self.check({**COUNTS, "available": 59})
        self.assertEqual((code, table), (1, "room,mover,1,80,80,1,1,60"))
        self.assertIn("room mover 1 80: WORSE: available 60 -> 59", output)
        self.assertEqual(self.check({"error": ["no result"]})[0], 1)

    def test_better_runs_are_told_and_written_when_asked(self):
        code, output, table = self.check({**COUNTS, "silent": 0})
        self.assertEqual((code, table), (0, "room,mover,1,80,80,1,1,60"))
        self.assertIn("changed: silent 1 -> 0", output)
        self.assertEqual(self.check({**COUNTS, "silent": 0, "available": 3}, "--update")[::2], (0, "room,mover,1,80,80,0,1,3"))

    def test_unseen_seeds_and_empty_tables_are_refused(self):
        table = self.folder / "runs.csv"
        for text, message in (("room,case,seed,length\nroom,mover,5,80\n", "seed 5 is unseen"), ("room,case,seed,length\n", "no runs")):
            table.write_text(text)
            with self.assertRaisesRegex(SystemExit, message):
                disturbed.read_table(table)

    def test_the_tables_of_the_project_can_be_read(self):
        for name in ("disturbed", "disturbed_nightly"):
            rows = disturbed.read_table(SOURCE / f"bench/suites/{name}.csv")
            self.assertGreaterEqual(len(rows), 20)
            self.assertGreater(min(row["frames"] for row in rows), 0)
            self.assertGreater(sum(row["frames"] for row in rows), sum(row["available"] for row in rows))


class FalseLoops(Temporary):
    def test_loops_are_false_if_they_measure_another_pose(self):
        stamps = [f"{i:.6f}" for i in range(5)]  # one metre ahead in each second
        (self.folder / "groundtruth.txt").write_text("".join(f"{s} {s} 0 0 0 0 0 1\n" for s in stamps))
        measured = [("3 0 0 0 0 0 1", 0), ("3.05 0.05 0 0 0 0 1", 0), ("3.2 0 0 0 0 0 1", 1), ("3 0 0 0 0 0.1 0.995", 1)]
        edges = ["VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1", "EDGE_SE3:QUAT 0 1 9 9 9 0 0 0 1 1"]
        edges += [f"EDGE_SE3:QUAT 0 3 {pose} 1" for pose, _ in measured]
        (self.folder / "graph.g2o").write_text("\n".join(edges) + "\n")
        for count in range(len(measured) + 1):
            loops = [{"stamp_a": stamps[0], "stamp_b": stamps[3]}] * count
            (self.folder / "run.json").write_text(json.dumps({"loops": loops}))
            expected = sum(false for _, false in measured[len(measured) - count:])
            self.assertEqual(loop_error.count_false_loops(self.folder, self.folder / "groundtruth.txt"), expected)

    def test_two_places_in_one_world_are_a_false_loop(self):
        row = {"accepted": 2, "one_world": True, "merged": 3}
        self.assertEqual(look_alikes.false_loops("double", row), 6)
        self.assertEqual(look_alikes.false_loops("same", row), 0)

    def test_loops_between_visits_are_counted_by_status(self):
        loops = [{"stamp_a": "1.0", "stamp_b": "9.0"}, {"stamp_a": "8.0", "stamp_b": "9.0"}]
        other = [{"stamp_a": "9.0", "stamp_b": "2.0", "status": "rejected"}]
        counts = look_alikes.count_loops({"loops": loops, "other_loops": other}, 5.0)
        self.assertEqual((counts["accepted"], counts["rejected"], counts["within"]), (1, 1, 1))

    def test_rotations_and_quaternions_are_each_others_inverse(self):
        rng = np.random.default_rng(1)
        for vector in rng.normal(size=(20, 3)):
            quaternion = look_alikes.quaternion(look_alikes.turn(vector))
            np.testing.assert_allclose(look_alikes.pose_matrix([0, 0, 0, 0, *quaternion])[:3, :3], look_alikes.turn(vector), atol=1e-9)


LIBRARY = {
    "scripts/cmake/layers.txt": "# rows\nkinloop/core:\nkinloop/loop: core\napps: core loop\n",
    "kinloop/core/ids.hpp": "#pragma once\nstruct Id {};\n",
    "kinloop/core/time.hpp": "#pragma once\n",
    "kinloop/loop/find.hpp": "#pragma once\n#include \"kinloop/core/ids.hpp\"\nint find(int a, int b = f(1, 2), T<int, int> c = {});\n",
    "kinloop/loop/find.cpp": "#include \"kinloop/loop/find.hpp\"\nconstexpr double kMost = 0.5, kTwice = 2 * kMost;  // constexpr int kA = 1;\n"
                             "int find(int a, int b, T<int, int> c) { return g(1, 2, 3, 4, 5, 6, 7); }\n",
    "apps/main.cpp": "#include \"kinloop/loop/find.hpp\"\n#include \"kinloop/core/ids.hpp\"\n"
                     "void fields() { visit(\"x\", self.x, \"help\"); visit(\"y\", self.y); }\n",
    "README.md": "four words are here\n",
}


class Sizes(Temporary):
    def setUp(self):
        super().setUp()
        (self.folder / ".ci").mkdir()
        shutil.copy(SOURCE / ".ci/check_size.py", self.folder / ".ci")
        subprocess.run(["git", "init", "-q"], cwd=self.folder, check=True)
        for name, text in LIBRARY.items():
            self.write(name, text)
        self.assertEqual(self.check("--update")[0], 0)

    def write(self, name, text):
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        subprocess.run(["git", "add", name], cwd=self.folder, check=True)

    def check(self, *words):
        done = subprocess.run([sys.executable, ".ci/check_size.py", *words], cwd=self.folder, capture_output=True, text=True)
        self.assertEqual(done.stderr, "")
        return done.returncode, done.stdout

    def test_counts_what_it_says(self):
        rows = (self.folder / ".ci/size.csv").read_text().splitlines()[1:]
        self.assertEqual(rows, ["lines,apps,3,", "lines,kinloop/core,3,", "lines,kinloop/loop,6,", "words,all,4,",
                                "headers_one_user,all,1,", "long_parameters,all,0,", "thresholds,kinloop/loop,1,",
                                "options,all,1,"])
        self.assertEqual(self.check("--list", "headers_one_user")[1], "kinloop/loop/find.hpp: only apps/main.cpp\n")
        self.assertEqual(self.check()[0], 0)

    def test_any_growth_fails_until_the_table_is_changed(self):
        grown = {
            "lines of kinloop/core: 4": ("kinloop/core/time.hpp", "#pragma once\n\n"),
            "words of all: 5": ("README.md", "now five words are here\n"),
            "headers_one_user of all: 2": ("apps/other.cpp", "#include \"kinloop/core/time.hpp\"\n"),
            "long_parameters of all: 1": ("kinloop/core/six.cpp", "void six(int a, int b, int c, int d, int e, int f) {}\n"),
            "thresholds of kinloop/loop: 2": ("kinloop/loop/more.cpp", "void f() {\n  constexpr int64_t kWait_ns = 120'000 * 3;\n}\n"),
            "options of all: 2": ("apps/more.cpp", "visit(\n    \"z\", self.z,\n    \"help\");\n"),
        }
        for said, (name, text) in grown.items():
            self.write(name, text)
            code, output = self.check()
            self.assertEqual(code, 1, said)
            self.assertIn(said, output)
            self.assertEqual(self.check("--update")[0], 0)
            self.assertEqual(self.check()[0], 0)
        self.write("README.md", "fewer\n")
        code, output = self.check()
        self.assertEqual(code, 0)
        self.assertIn("1 are smaller", output)

    def test_a_folder_of_many_files_needs_a_reason(self):
        for i in range(16):
            self.write(f"tests/t{i}.txt", "")
        self.assertIn("files of tests: 16", self.check()[1])
        code, output = self.check("--update")
        self.assertEqual(code, 1)
        self.assertIn("gives no reason", output)
        table = self.folder / ".ci/size.csv"
        table.write_text(table.read_text().replace("files,tests,16,", "files,tests,16,one for each case"))
        self.assertEqual(self.check()[0], 0)
        self.assertEqual(self.check("--update")[0], 0)
        self.assertIn("files,tests,16,one for each case", table.read_text())


if __name__ == "__main__":
    unittest.main()

"""Tables, statistics, LaTeX, comparison, verification, and other systems in the same table."""

import io
import math
import os
import pathlib
import subprocess
import time
import unittest
import unittest.mock

import yaml
from support import BatchTest

from kinloop.batch.durations import Durations, by_size, image_pixels, pixels_of_files
from kinloop.batch.progress import Progress
from kinloop.batch.statistics import area_under_curve, bootstrap_ratio, summarise_sequences, summarise_variants
from kinloop.batch.text import cell_of, text_of_cell
from kinloop.batch.workers import longest_first, shard_of

TWO = "sequences: [{path: 'sim:room:1..3', dataset: rooms}]\nseeds: [1, 2, 3]\nvariants: {a: , b_c: {arguments: [--no-loop]}}\n"


def row(sequence, ate_m, variant="a", dataset="d", **figures):
    from kinloop.batch.tables import COLUMNS

    status = {"status": "done" if ate_m is not None else "lost", "exit": "0", "key": "0"}
    return dict.fromkeys(COLUMNS) | status | {"dataset": dataset, "sequence": sequence, "variant": variant, "seed": 1, "ate_m": ate_m} | figures


class Statistics(unittest.TestCase):
    def test_a_summary_has_medians_and_the_spread_over_seeds(self):
        (summary,) = summarise_sequences([row("s", 0.3), row("s", 0.1), row("s", None), row("s", 0.2)])
        self.assertEqual((summary["ate_m"], summary["ate_m_low"], summary["ate_m_high"]), (0.2, 0.1, 0.3))
        self.assertEqual((summary["runs"], summary["failed"]), (4, 1))

    def test_the_area_under_the_curve_is_that_of_the_cumulative_plot(self):
        errors_m = [0.001, 0.004, 0.0199, 0.05, 0.3]
        summaries = summarise_sequences([row(str(i), e) for i, e in enumerate(errors_m)] + [row("x", None)])
        for limit in (0.5, 2.0, 8.0):
            steps = 20000  # the number of sequences with an error of at most x, integrated
            counts = (sum(100 * e <= (k + 0.5) / steps * limit for e in errors_m) for k in range(steps))
            self.assertAlmostEqual(area_under_curve(summaries, limit), sum(counts) * limit / steps, 2)

    def test_a_sequence_of_which_half_of_the_seeds_fail_has_failed(self):
        rows = [row("s", 0.01), row("s", None), row("t", 0.01), row("t", 0.01), row("t", None)]
        (variant,) = summarise_variants(summarise_sequences(rows))
        self.assertEqual((variant["sequences"], variant["failed"], variant["mean_ate_m"]), (2, 1, 0.01))
        self.assertEqual(variant["auc_8cm"], 7)

    def test_the_bootstrap_interval_holds_the_ratio_and_is_the_same_each_time(self):
        pairs = [(1.0, 2.0 * (1 + 0.1 * math.sin(7.0 * i))) for i in range(30)]
        ratio, low, high = bootstrap_ratio(pairs)
        self.assertEqual(bootstrap_ratio(pairs), (ratio, low, high))
        self.assertTrue(1.9 < low < ratio < high < 2.1, (ratio, low, high))
        self.assertEqual(bootstrap_ratio([(1.0, 1.0)] * 3), (1, 1, 1))
        self.assertEqual(bootstrap_ratio([]), (None, None, None))

    def test_variants_are_compared_with_the_first_in_pairs_and_by_dataset(self):
        rows = [row("s", 0.01), row("t", 0.02, dataset="e"), row("s", 0.03, "b"), row("t", 0.02, "b", "e"), row("u", 9.0, "b", "e")]
        variants = {(v["variant"], v["dataset"]): v for v in summarise_variants(summarise_sequences(rows))}
        self.assertEqual(set(variants), {(v, d) for v in "ab" for d in ("d", "e", "all")})
        self.assertAlmostEqual(variants["b", "d"]["ratio"], 3)
        self.assertAlmostEqual(variants["b", "e"]["ratio"], 1)  # u has no pair
        self.assertAlmostEqual(variants["b", "all"]["ratio"], math.sqrt(3))
        self.assertIsNone(variants["a", "all"]["ratio"])


class Tables(BatchTest):
    def test_a_batch_leaves_tables_latex_and_a_page(self):
        self.run_suite(TWO)
        self.assertEqual(len(self.rows()), 18)
        for name, lines in (("sequences.csv", 1 + 6), ("variants.csv", 1 + 2)):
            self.assertEqual(len((self.results / name).read_text().splitlines()), lines)
        latex = (self.results / "table.tex").read_text()
        self.assertIn(r"sequence & a & b\_c \\", latex)
        self.assertEqual(latex.count("sim:room:"), 3)
        self.assertEqual(latex.count(r"\textbf{"), 3)
        self.assertIn('"columns":["dataset"', (self.results / "index.html").read_text())

    def test_table_writes_the_same_bytes_again(self):
        self.run_suite(TWO)
        names = ("runs.csv", "sequences.csv", "variants.csv", "table.tex", "index.html")
        before = {name: (self.results / name).read_bytes() for name in names}
        for name in names:
            (self.results / name).unlink()
        self.batch("table", self.results)
        self.assertEqual({name: (self.results / name).read_bytes() for name in names}, before)

    def test_folders_without_a_plan_are_refused(self):
        self.assertIn("a folder of kinloop batch?", self.batch("table", self.folder, expect=3))
        (self.folder / "plan.jsonl").write_text('{"title": "x"}\n{"key": 3}\n')
        self.assertIn("plan.jsonl:2: damaged", self.batch("table", self.folder, expect=3))

    def test_names_obey_no_terminal_and_break_no_line_or_formula(self):
        name = r"=1+\e[2J\n'é\xA0\u202E"
        self.recording("room")
        self.run_suite(f'sequences: [{{path: room, name: "{name}", dataset: "-2"}}]\nvariants: {{"@a\\n": }}')
        shown = r"=1+\x1b[2J\n'é" + "\xa0" + r"\u202e"
        (row,) = self.rows()
        self.assertEqual((row["sequence"], row["variant"], row["dataset"]), (shown, r"@a\n", "-2"))
        self.assertTrue((self.results / "runs.csv").read_text().splitlines()[1].startswith(f"'-2,'{shown},'@a\\n,1,done,"))
        texts = {name: (self.results / name).read_text() for name in ("runs.csv", "sequences.csv", "variants.csv", "table.tex", "index.html")}
        texts["verify"] = self.batch("verify", self.results)
        texts["compare"] = self.batch("compare", self.results, self.results)
        for name, text in texts.items():
            self.assertNotRegex(text, "[\x1b\u202e]", name)
        self.assertTrue(texts["verify"].startswith(f"{shown}, @a\\n, seed 1: the same\n"))
        self.assertEqual(len(texts["sequences.csv"].splitlines()), 2)
        self.assertIn(r"=1+\textbackslash{}x1b[2J", texts["table.tex"])
        self.assertIn(r"'nowhere\x1b' is not", self.batch("verify", self.results, "--seed", "nowhere\x1b", expect=2))

    def test_a_cell_is_read_as_it_was_written(self):
        for text in ("", "a", "=a", "'a", "'=a", "''", "-", "@", "+1", "a=b", "1"):
            self.assertEqual(text_of_cell(cell_of(text)), text)
            self.assertNotRegex(cell_of(text), "^[=+@-]")

    def test_a_folder_whose_name_is_not_utf_8_has_a_row(self):
        try:
            os.mkdir(os.fsencode(self.folder) + b"/room\xff")
        except OSError:
            self.skipTest("the file system takes UTF-8 only")
        self.run_suite("sequences: ['room*']")
        self.assertEqual(self.rows()[0]["sequence"], r"room\xff")

    def test_a_name_cannot_end_the_script_of_the_page(self):
        self.recording("room")
        self.run_suite("sequences: [{path: room, name: '</script><b>'}]")
        self.assertEqual((self.results / "index.html").read_text().count("</script>"), 2)


class Compare(BatchTest):
    def table_of(self, name, rows):
        from kinloop.batch.tables import write_rows

        (self.folder / name).mkdir(exist_ok=True)
        write_rows(self.folder / name, rows)
        return self.folder / name

    def both(self, change, *options, expect):
        base = [row(f"s{i}", 0.01 + 0.001 * i, cpu_s=10.0) for i in range(20)]
        first = self.table_of("first", base)
        return self.batch("compare", first, self.table_of("second", change(base)), *options, expect=expect)

    def test_equal_batches_are_not_worse(self):
        self.assertIn("ATE        ratio 1.000", self.both(lambda rows: rows, expect=0))

    def test_each_threshold_decides(self):
        worse = lambda factor, which=slice(None): lambda rows: [  # noqa: E731
            r | {"ate_m": r["ate_m"] * (factor if r in rows[which] else 1)} for r in rows]  # fmt: skip
        self.assertIn("worse: the ATE is 1.100 times", self.both(worse(1.1), expect=5))
        self.both(worse(1.1), "--max-ate-ratio", 1.2, expect=0)
        self.assertIn("worse: s3, a: ATE 2.000 times", self.both(worse(2, slice(3, 4)), expect=5))
        self.both(worse(2, slice(3, 4)), "--max-sequence-ratio", 2.5, expect=0)
        fails = lambda rows: [r | {"ate_m": None if r["sequence"] == "s0" else r["ate_m"]} for r in rows]  # noqa: E731
        self.assertIn("worse: 1 new failures, 0 allowed", self.both(fails, expect=5))
        self.both(fails, "--max-failures", 1, expect=0)
        slow = lambda rows: [r | {"cpu_s": 12.0} for r in rows]  # noqa: E731
        self.both(slow, expect=0)
        self.assertIn("worse: the CPU time is 1.200", self.both(slow, "--max-cpu-ratio", 1.1, expect=5))

    def test_what_cannot_be_compared_is_refused(self):
        first = self.table_of("first", [row("s", 0.1)])
        self.assertIn("in common", self.batch("compare", first, self.table_of("b", [row("t", 0.1)]), expect=3))
        self.assertIn("kinloop batch table", self.batch("compare", first, self.folder / "nothing", expect=3))
        self.write("other.csv", "a,b\n1,2\n")
        self.assertIn("is no table of runs", self.batch("compare", first, self.folder / "other.csv", expect=3))
        self.assertIn("is not a number from 0 to 1000", self.batch("compare", first, first, "--max-ate-ratio", "nan", expect=2))


class Verify(BatchTest):
    def test_the_same_bytes_are_found_the_same_and_others_are_named(self):
        self.run_suite("sequences: [sim:room:1, sim:room:2]")
        lines = self.batch("verify", self.results, "-q").splitlines()
        self.assertEqual(sorted(lines), [f"sim:room:{i}, default, seed 1: the same" for i in (1, 2)])
        self.assertEqual(len(self.calls()), 4)
        self.run_suite("sequences: [sim:room:1]\nvariants: {a: {set: {fake.do: random}}}")
        before = {path: path.read_bytes() for path in (self.results / "runs").glob("*/*") if path.is_file()}
        self.assertIn("differs: map.ply\n", self.batch("verify", self.results, expect=5))
        self.assertEqual({path: path.read_bytes() for path in (self.results / "runs").glob("*/*") if path.is_file()}, before)

    def test_data_names_no_program(self):
        self.recording("room")
        self.run_suite("sequences: [room]\nkeep: [trajectory.txt, groundtruth.txt]")
        (run,) = (self.results / "runs").glob("*/trajectory.txt")
        self.write("groundtruth.txt", "").rename(run.with_name("groundtruth.txt"))  # so that there is something to draw
        started = self.folder / "started"
        program = self.write("bad.sh", f"#!/bin/sh\necho $* >> {started}\n")
        program.chmod(0o755)
        plan = self.results / "plan.jsonl"
        plan.write_text(plan.read_text().replace(str(self.program), str(program)))
        with unittest.mock.patch.dict(os.environ, {"KINLOOP_PROGRAM": str(self.program)}):
            self.batch("table", self.results)
            for words in (["verify", self.results], ["shard", "1/1", self.results]):
                self.assertRegex(self.batch(*words, expect=3), r"plan.jsonl: was not written by you .* give --trust if you trust it\n$")
        self.assertFalse(started.exists())
        self.batch("verify", self.results, "--trust", expect=5)
        self.assertTrue(started.exists())

    def test_a_plan_of_another_user_or_without_a_signature_is_not_own(self):
        self.run_suite("sequences: [sim:room]")
        self.assertIn("the same", self.batch("verify", self.results))
        key, plan = self.folder / "state/kinloop/plan_key", self.results / "plan.jsonl"
        self.assertEqual(key.stat().st_mode & 0o777, 0o600)
        key.rename(key.with_name("old"))
        self.assertIn("not written by you", self.batch("verify", self.results, expect=3))
        key.write_bytes(b"")  # no key can be made
        self.run_suite("sequences: [sim:room]")
        self.assertIn("not written by you", self.batch("verify", self.results, expect=3))
        key.with_name("old").rename(key)
        self.run_suite("sequences: [sim:room]")
        for header in ('{"title": "a"}', '{"title": "a", "signature": ""}', '{"title": "a", "signature": "\u00e9"}',
                       '{"title": "a", "signature": []}'):  # fmt: skip
            plan.write_text("\n".join([header, *plan.read_text().splitlines()[1:]]) + "\n")
            self.assertIn("not written by you", self.batch("verify", self.results, expect=3))

    def test_nothing_to_verify_is_said(self):
        self.assertIn("cannot be read", self.batch("verify", self.folder / "x", expect=3))


class OtherSystems(BatchTest):
    def test_a_command_is_run_and_scored_like_kinloop(self):
        self.recording("room")
        self.recording("blind", truth=False)
        peer = self.write("peer.sh", "#!/bin/sh\necho \"1.0 0.0$2 0 0 0 0 0 1\" > \"$3/trajectory.txt\"\n")
        peer.chmod(0o755)
        self.run_suite("sequences: [{path: room, camera: freiburg1}, {path: blind, camera: freiburg1}]\nvariants:\n"
                       "  kinloop:\n  peer: {command: './peer.sh {recording} {seed} {output}', seeds: [5, 7]}\n")  # fmt: skip
        rows = {(r["sequence"], r["variant"], r["seed"]): r for r in self.rows()}
        self.assertEqual(rows["room", "peer", 5]["ate_m"], 0.05)
        self.assertEqual(rows["room", "peer", 7]["ate_m"], 0.07)
        self.assertEqual(rows["blind", "peer", 7]["status"], "no truth")
        self.assertGreater(rows["room", "peer", 7]["wall_s"], 0)
        peer.write_text("#!/bin/sh\nexit 9\n")  # another program: another key
        self.run_suite("sequences: [room]\nvariants: {peer: {command: './peer.sh {output}'}}")
        self.assertEqual((self.rows()[0]["status"], self.rows()[0]["exit"]), ("failed", "9"))

    def test_an_external_trajectory_is_scored_and_a_missing_one_is_a_row(self):
        self.recording("room")
        self.recording("hall")
        self.write("orb/room.txt", "1.0 0.25 0 0 0 0 0 1\n")
        suite = "sequences: [room, hall]\nvariants: {orb: {external: 'orb/{name}.txt'}}"
        self.run_suite(suite)
        self.assertEqual([(r["status"], r["ate_m"]) for r in self.rows()], [("done", 0.25), ("no trajectory", None)])
        self.write("orb/room.txt", "1.0 0.5 0 0 0 0 0 1\n")
        self.run_suite(suite)
        self.assertEqual(self.rows()[0]["ate_m"], 0.5)
        self.assertEqual(self.calls(), [])

    def test_the_limits_hold_for_all_that_a_command_starts(self):
        self.recording("room")
        seconds = f"77.{os.getpid()}"  # of this test only
        self.run_suite(f"sequences: [room]\nvariants: {{peer: {{command: 'sh -c \"sleep {seconds} & sleep {seconds}\" {{output}}'}}}}\n"
                       "limits: {time: 1 s}")  # fmt: skip
        self.assertEqual(self.rows()[0]["status"], "time limit")
        words = f"sleep\0{seconds}\0".encode()
        end = time.monotonic() + 30  # a killed process may be seen until it is scheduled
        while any(self.text_of(path) == words for path in pathlib.Path("/proc").glob("[0-9]*/cmdline")):
            self.assertLess(time.monotonic(), end, "it goes on")
            time.sleep(0.05)

    @staticmethod
    def text_of(path):
        try:
            return path.read_bytes()
        except OSError:
            return b""

    def test_a_simulated_room_has_no_recording_for_others(self):
        self.assertIn("write the room with kinloop simulate", self.run_suite(
            "sequences: [sim:room]\nvariants: {peer: {command: 'x {recording}'}}", expect=3))  # fmt: skip


class Order(BatchTest):
    """Longest first."""

    def plan(self, suite):
        from kinloop.batch.store import Store

        self.batch("plan", self.write("suite.yaml", suite), "-o", self.results, "--program", self.program)
        return longest_first(Store(self.results).read_plan()[1])

    def test_the_pixels_of_an_image_are_in_its_header(self):
        png = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR" + (640).to_bytes(4, "big") + (480).to_bytes(4, "big")
        start = b"\xff\xc0\0\x11\x08" + (968).to_bytes(2, "big") + (1296).to_bytes(2, "big")
        jpeg = b"\xff\xd8\xff\xe0\0\x10JFIF\0\1\1\0\0\1\0\1\0\0" + start
        for name, data, pixels in (("a.png", png, 640 * 480), ("b.jpg", jpeg, 1296 * 968), ("c.jpg", jpeg[:25], None), ("d.png", b"", None)):
            (self.folder / name).write_bytes(data)
            self.assertEqual(image_pixels(self.folder / name), pixels, name)
        files = [(self.folder / "a.png", 9), (self.folder / "b.jpg", 9)] * 10
        self.assertEqual(pixels_of_files(sorted(files)), 10 * 1296 * 968)
        self.assertEqual(pixels_of_files([("room.bag", 3_000_000)]), 2_000_000)

    def test_more_frames_and_larger_images_are_expected_to_take_longer(self):
        jobs = self.plan("sequences: [sim:room]\nvariants:\n  short: {set: {sim.frames: 20}}\n  whole:\n"
                         "  small: {set: {sim.width: 160, sim.height: 120}}\n  turns: {set: {sim.seconds: 40}}\n")  # fmt: skip
        self.assertEqual([job.variant for job in jobs], ["turns", "whole", "small", "short"])
        for option in ("nan", "x", "inf"):
            self.assertGreater(by_size(type("R", (), {"path": "sim:room"}), {"sim.frames": option}, 1), 100)

    def test_a_recording_with_more_images_comes_first_and_one_of_which_nothing_is_known_last(self):
        for name, images in (("some", 2), ("none", 0), ("many", 9)):
            for i in range(images):
                self.write(f"{name}/rgb/{i}.png", "x")
                self.write(f"{name}/depth/{i}.png", "x")
            self.write(f"{name}/rgb.txt", "")
        self.assertEqual([job.sequence for job in self.plan("sequences: [none, some, many]")], ["many", "some", "none"])

    def test_earlier_results_of_the_sequence_decide_and_correct_the_others(self):
        class Job:
            def __init__(self, sequence, variant):
                self.dataset, self.sequence, self.variant, self.expected_s = "d", sequence, variant, 10.0

        jobs = [Job("s", "a"), Job("s", "b"), Job("t", "a")]
        rows = [row("s", 0.1, cpu_s=3.0), row("s", 0.1, cpu_s=5.0), row("s", 0.1, "c", cpu_s=40.0), row("s", None, cpu_s=None)]
        Durations(rows).set_expected(jobs)
        self.assertEqual([job.expected_s for job in jobs], [4, 5, 4.5])  # of the variant; of the sequence; by size, scaled
        Durations().set_expected(jobs)
        self.assertEqual([job.expected_s for job in jobs], [4, 5, 4.5])

    def test_the_time_left_is_that_of_the_work_not_of_the_number_of_runs(self):
        class Job:
            def __init__(self, key, expected_s):
                self.key, self.expected_s = key, expected_s

        stream = io.StringIO()
        progress = Progress([Job("long", 90.0), *(Job(str(i), 1.0) for i in range(10))], quiet=False, stream=stream)
        progress.begin = progress.last = time.monotonic() - 180.0
        progress.finish_one("long")
        self.assertEqual(stream.getvalue(), "1/11 runs, 20 s left\n")

    def test_the_longest_of_the_last_batch_starts_first_in_the_next(self):
        self.run_suite("sequences: ['sim:room:1..6']")
        cpu_s = {row["sequence"]: row["cpu_s"] for row in self.rows()}
        jobs = self.plan("sequences: ['sim:room:1..6']\nvariants: {default: {arguments: [--no-loop]}}")
        self.assertEqual([job.sequence for job in jobs], sorted(cpu_s, key=lambda name: -cpu_s[name]))


class Shards(BatchTest):
    def test_shards_do_all_runs_once_and_give_the_same_table(self):
        text = "sequences: ['sim:room:1..7']\nseeds: [1, 2]\n"
        self.run_suite(text, results=self.folder / "whole")
        calls = len(self.calls())
        output = self.batch("plan", self.folder / "suite.yaml", "-o", self.results, "--program", self.program, "--shards", 3)
        self.assertIn("14 runs, 14 to do, in 3 shards", output)
        for shard in (3, 1, 2):
            self.batch("shard", f"{shard}/3", self.results)
        self.assertEqual(len(self.calls()) - calls, 14)
        self.batch("shard", "1/3", self.results)
        self.batch("table", self.results)
        self.assertEqual(self.table(), self.table(self.folder / "whole"))
        self.assertEqual(len(self.calls()) - calls, 14)

    def test_a_shard_that_helps_others_leaves_nothing_and_repeats_nothing(self):
        suite = self.write("suite.yaml", "sequences: ['sim:room:1..7']\nvariants: {a: {set: {fake.sleep: 0.05}}}\n")
        self.batch("plan", suite, "-o", self.results, "--program", self.program, "--shards", 3)
        first = self.start("shard", "1/3", self.results, "--help-others")
        self.batch("shard", "2/3", self.results, "--help-others")
        self.assertEqual(first.wait(60), 0)
        first.stderr.close()
        self.batch("table", self.results)
        self.assertEqual([row["status"] for row in self.rows()], ["done"] * 7)
        self.assertEqual(len(self.calls()), 7)

    def test_long_runs_are_dealt_evenly_and_each_to_one_shard(self):
        class Job:
            def __init__(self, number, expected_s):
                self.key, self.expected_s = str(number), expected_s

        def loads(expected):
            jobs = [Job(i, seconds) for i, seconds in enumerate(expected)]
            shards = [shard_of(jobs, i, 10) for i in range(1, 11)]
            self.assertEqual(sorted(int(job.key) for shard in shards for job in shard), list(range(len(jobs))))
            return [sum(job.expected_s for job in shard) for shard in shards], [len(shard) for shard in shards]

        self.assertEqual(loads([i % 10 for i in range(100)])[0], [45] * 10)
        self.assertEqual(loads([0] * 100)[1], [10] * 10)
        self.assertEqual(max(loads([50] + [1] * 450)[0]), 50)  # dealt like cards, the long one would come on top

    def test_wrong_shards_are_refused(self):
        for shard in ("0/3", "4/3", "1", "a/b", "1/0", "1/3/5"):
            self.assertIn("e.g. 3/100", self.batch("shard", shard, self.results, expect=2))

    def test_the_scripts_are_valid_and_quote_names(self):
        self.results = self.folder / "it's $HOME"
        suite = self.write("suite.yaml", "name: My Suite!\nsequences: ['sim:room:1..5']\nlimits: {time: 10 min, memory: 1 GiB}\n")
        self.batch("plan", suite, "-o", self.results, "--program", self.program, "--shards", 2)
        slurm = (self.results / "slurm.sh").read_text()
        self.assertIn("#SBATCH --array=1-2\n", slurm)
        self.assertIn("#SBATCH --time=36\n", slurm)
        self.assertIn("#SBATCH --job-name=kinloop-my-suite\n", slurm)
        subprocess.run(["sh", "-n", str(self.results / "slurm.sh")], check=True)
        job = yaml.safe_load((self.results / "kubernetes.yaml").read_text())
        self.assertEqual((job["spec"]["completionMode"], job["spec"]["completions"]), ("Indexed", 2))
        script = job["spec"]["template"]["spec"]["containers"][0]["args"][0].replace("exec ", "printf '%s\\n' ", 1)
        words = subprocess.run(["sh", "-c", script], env={"JOB_COMPLETION_INDEX": "1"}, capture_output=True, text=True, check=True)
        self.assertEqual(words.stdout.splitlines(), [str(self.program.resolve()), "batch", "shard", "2/2", str(self.results), "--help-others", "--trust"])


if __name__ == "__main__":
    unittest.main()

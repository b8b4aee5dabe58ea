"""Keys and rows: what makes a run another one, what a run ends as, and what is kept of it."""

import json
import os
import shutil
import subprocess
import sys
import unittest

from support import PACKAGE, BatchTest, tmpfs

from kinloop.batch.files import remove

SIM = "sequences: [sim:room]\n"


def variant(**options):
    """A suite with one variant with options fake.NAME."""
    return SIM + "variants: {a: {set: {" + ", ".join(f"fake.{name}: {value}" for name, value in options.items()) + "}}}\n"


class Keys(BatchTest):
    def key(self, text, **kwargs):
        self.run_suite(text, **kwargs)
        return self.rows()[0]["key"]

    def test_a_finished_run_is_never_repeated(self):
        self.recording("room")
        first = self.run_suite("sequences: [room, sim:room]")
        self.assertIn("2 runs, 2 to do", first)
        table = self.table()
        self.assertIn("2 runs, 0 to do", self.run_suite("sequences: [room, sim:room]"))
        self.assertEqual(len(self.calls()), 2)
        self.assertEqual(self.table(), table)

    def test_what_changes_a_result_changes_its_key(self):
        self.recording("room")
        keys = {self.key("sequences: [room]")}
        changes = {
            "seed": lambda: "sequences: [room]\nseeds: 2",
            "option": lambda: "sequences: [room]\nvariants: {a: {set: {features.count: 900}}}",
            "argument": lambda: "sequences: [room]\nvariants: {a: {arguments: [--no-loop]}}",
            "name of the camera": lambda: "sequences: [{path: room, camera: freiburg1}]",
            "camera file": lambda: self.write("cam.yaml", "fx: 1") and "sequences: [{path: room, camera: cam.yaml}]",
            "bytes of the camera file": lambda: self.write("cam.yaml", "fx: 2") and "sequences: [{path: room, camera: cam.yaml}]",
            "camera above the folder": lambda: self.write("calibration.txt", "fx") and "sequences: [room]",
            "name of the folder": lambda: self.recording("room_b") and "sequences: [room_b]",
            "an image": lambda: self.write("room/rgb/1.png", "imagE") and "sequences: [room]",
            "one file more": lambda: self.write("room/rgb/2.png", "") and "sequences: [room]",
            "the program": lambda: self.program.write_text(self.program.read_text() + "\n") and "sequences: [room]",
        }
        for count, (name, change) in enumerate(changes.items(), 2):
            keys.add(self.key(change()))
            self.assertEqual(len(keys), count, name)

    def test_what_does_not_change_a_result_does_not_change_its_key(self):
        self.recording("room")
        key = self.key("sequences: [room]")
        for same in [
            "sequences: [room]\nthreads: 4\nkeep: [map.ply]\nlimits: {time: 9 s, memory: 1 GiB}\nname: x",
            "sequences: [{path: room, name: other, dataset: d}]",
            "sequences: [room]\nvariants: {b: {set: {features.count: 1000.0}}}",  # its default
        ]:
            self.assertEqual(self.key(same), key)
        os.utime(self.folder / "room/rgb/1.png", (1, 1))  # hashed again, with the same result
        self.assertEqual(self.key("sequences: [room]"), key)
        self.assertEqual(len(self.calls()), 1)

    def test_bytes_are_read_once_while_size_time_and_inode_are_the_same(self):
        image = self.recording("room") / "rgb/1.png"
        key = self.key("sequences: [room]")
        state = image.stat()
        image.write_text("imAGE")  # the same inode and size; with the old time, nobody notices
        os.utime(image, ns=(state.st_atime_ns, state.st_mtime_ns))
        self.assertEqual(self.key("sequences: [room]"), key)
        os.utime(image, ns=(state.st_atime_ns, state.st_mtime_ns + 1))
        self.assertNotEqual(self.key("sequences: [room]"), key)

    def test_files_in_arguments_are_part_of_the_key_and_begin_at_the_suite(self):
        keys = []
        for text, argument in (("white", "--mask, mask.png"), ("black", "--mask, mask.png"), ("black", "--mask=mask.png"),
                               ("black", "--vocabulary, ./mask.png")):  # fmt: skip
            self.write("mask.png", text)
            keys.append(self.key(SIM + f"variants: {{a: {{arguments: [{argument}]}}}}"))
            (job,) = [json.loads(line) for line in (self.results / "plan.jsonl").read_text().splitlines()[1:]]
            self.assertIn(str(self.folder / "mask.png"), job["words"])
            self.assertNotIn("mask.png", job["words"])
        self.assertEqual(len(set(keys)), 4)
        os.unlink(self.folder / "mask.png")
        for make in (lambda path: None, os.mkdir, lambda path: (os.rmdir(path), os.mkfifo(path))):
            make(self.folder / "mask.png")
            self.assertRegex(self.run_suite(SIM + "variants: {a: {arguments: [--mask, mask.png]}}", expect=3),
                             r"^error: variant a: .*/mask.png: cannot be read \(.*\); paths begin at the suite's folder\n$")  # fmt: skip

    def test_the_build_id_identifies_a_program_of_elf(self):
        from kinloop.batch.program import build_id, identity_of

        note = b"\x04\0\0\0\x04\0\0\0\x03\0\0\0GNU\0\xde\xad\xbe\xef"
        header = b"\x7fELF\x02\x01".ljust(32, b"\0") + (64).to_bytes(8, "little") + bytes(14) + b"\x38\0\x01\0" + bytes(6)
        segment = (4).to_bytes(8, "little") + (120).to_bytes(8, "little") + bytes(16) + len(note).to_bytes(8, "little") + bytes(16)
        for end in (b"", b"debug symbols"):
            path = self.folder / "elf"
            path.write_bytes(header + segment + note + end)
            self.assertEqual(identity_of(path), "build-id:deadbeef")
        for length in range(len(header + segment + note)):  # truncated, and garbage
            path.write_bytes((header + segment + note)[:length])
            self.assertIsNone(build_id(path))
        path.write_bytes(header[:56] + b"\xff" * 100)
        self.assertIsNone(build_id(path))


class Rows(BatchTest):
    def row(self, text):
        self.run_suite(text)
        return self.rows()[0]

    def test_a_row_has_the_figures_of_run_json(self):
        row = self.row("sequences: [{path: sim:room:4, dataset: rooms}]")
        expected = {"dataset": "rooms", "sequence": "sim:room:4", "variant": "default", "seed": 1, "status": "done", "exit": "0",
                    "verdict": "good", "rpe_1s_deg": 0.5, "coverage": 1, "frames": 100, "tracked": 99, "doubtful_s": 0.1,
                    "lost_s": 0, "keyframes": 7, "loops": 2, "sensor": "kinect1", "wall_s": 1, "peak_mib": 100.5, "frame_ms": 5}  # fmt: skip
        self.assertEqual({name: row[name] for name in expected}, expected)
        self.assertAlmostEqual(row["live_ate_m"], 2 * row["ate_m"], 6)

    def test_a_run_that_fails_is_a_row_with_its_log(self):
        limits = "limits: {time: 1 s, memory: 300 MiB}\n"
        for do, status, code in [("crash", "crashed", "SIGSEGV"), ("hang", "time limit", ""), ("memory", "out of memory", "3"),
                                 ("bad", "bad input", "3"), ("lost", "lost", "4"), ("no_frames", "no frames", "0"),
                                 ("no_truth", "no truth", "0"), ("kill", "killed", "SIGKILL"), ("limit", "killed", "3")]:  # fmt: skip
            with self.subTest(do):
                row = self.row(variant(do=do) + limits)
                self.assertEqual((row["status"], row["exit"]), (status, code))
                self.assertTrue((self.results / "runs" / row["key"] / "log.txt").exists())
                calls = len(self.calls())
                self.row(variant(do=do) + limits)
                again = 3 if status == "killed" else 0  # a failure is a result, unless it came from outside
                self.assertEqual(len(self.calls()), calls + again)
        self.assertIn("no such thing", (self.results / "runs" / self.row(variant(do="bad"))["key"] / "log.txt").read_text())

    def test_a_standard_error_that_is_full_is_no_traceback(self):
        with open("/dev/full", "w") as full:
            ended = subprocess.run([sys.executable, PACKAGE, self.folder / "absent.yaml"], stdout=subprocess.PIPE, stderr=full)
        self.assertEqual((ended.returncode, ended.stdout), (3, b""))

    def test_a_program_that_cannot_be_started_is_a_row(self):
        self.recording("room")
        row = self.row("sequences: [room]\nvariants: {a: {command: '/no/such/program {recording}'}}")
        self.assertEqual((row["status"], row["exit"]), ("not started", "127"))

    def test_a_run_that_is_killed_from_outside_is_repeated(self):
        row = self.row(variant(do="kill_once"))
        self.assertEqual((row["status"], len(self.calls())), ("done", 2))
        self.assertEqual(self.row(variant(do="kill"))["status"], "killed")
        self.assertEqual(len(self.calls()), 2 + 3)

    def test_a_run_that_was_killed_each_time_is_repeated_by_the_next_batch(self):
        suite = variant(do="kill_while")
        self.write("killing", "")
        self.assertEqual(self.row(suite)["status"], "killed")
        self.batch("table", self.results)
        self.assertEqual(self.rows()[0]["status"], "killed")
        (self.folder / "killing").unlink()
        self.assertEqual(self.row(suite)["status"], "done")
        self.assertEqual(len(self.calls()), 3 + 1)

    def test_a_run_whose_files_cannot_be_written_stops_the_batch_and_is_no_row(self):
        output = self.run_suite(variant(do="output"), expect=3)
        self.assertRegex(output, r"error: sim:room, a, seed 1: its files cannot be written \(x: .*\); make room or .* run the same command again")
        self.batch("table", self.results)
        self.assertEqual(self.rows()[0]["status"], "not run")

    def test_errors_are_not_recognised_by_words_in_names(self):
        for name in ("No space left on device", "Disk quota exceeded", "out of memory", "MemoryError"):
            self.recording(name)
            text = f"sequences: ['{name}']\nvariants: {{a: {{set: {{fake.do: bad}}}}}}\nlimits: {{memory: 1 GiB}}\n"
            self.run_suite(text)
            self.assertEqual(self.rows()[0]["status"], "bad input")

    def test_what_cannot_be_read_or_written_is_one_line(self):
        suite = self.write("suite.yaml", SIM)
        for name in ("results", "results/runs", "results/runs/.claims", "results/inputs/hashes", "results/plan.jsonl"):
            self.write("results", "") if name == "results" else (self.folder / name).parent.mkdir(parents=True, exist_ok=True)
            if name == "results/plan.jsonl":
                (self.folder / name).mkdir()  # cannot be replaced by a file
            else:
                self.write(name, "a file where a folder should be")
            output = self.batch(suite, "-o", self.results, "--program", self.program, "-q", expect=3)
            self.assertRegex(output, rf"^error: .*{name}.*: cannot be written \(.*\n$")
            remove(self.results)
        for words in (["verify", self.results], ["shard", "1/1", self.results], ["table", self.results]):
            self.assertRegex(self.batch(*words, expect=3), "^error: .*\n$")

    def test_results_on_a_disk_that_is_read_only(self):
        self.run_suite(SIM)
        with tmpfs(self.folder / "disk", "1m") as disk:
            shutil.copytree(self.results, disk / "results")
            subprocess.run(["mount", "-o", "remount,ro", disk], check=True)
            for words in (["verify"], ["table"], ["shard", "1/1"]):
                self.batch(*words, disk / "results", "-q", expect=0 if words[0] == "shard" else 3)
            output = self.run_suite(SIM, results=disk / "results", expect=3)
            self.assertRegex(output, r"^error: .*: cannot be written \(Read-only file system\); .*\n$")

    def test_only_what_the_suite_says_is_kept(self):
        for keep, files in [("[trajectory.txt]", {"trajectory.txt"}), ("['*.ply', run.json]", {"map.ply", "run.json"}), ("[]", set())]:
            row = self.row(variant(sleep=0, keep=len(files)) + f"keep: {keep}\n")
            found = {path.name for path in (self.results / "runs" / row["key"]).iterdir()}
            self.assertEqual(found, files | {"log.txt", "result.json"})

    def test_the_result_has_the_hashes_of_all_repeatable_files(self):
        key = self.row(SIM + "keep: []")["key"]
        result = json.loads((self.results / "runs" / key / "result.json").read_text())
        self.assertEqual(set(result["files"]), {"trajectory.txt", "map.ply"})
        self.assertEqual(result["identity"]["recording"], {"camera": "", "simulated": "sim:room"})

    def test_a_run_json_with_nonsense_is_no_crash(self):
        from kinloop.batch.figures import of_evaluation, of_run

        for text in ["", "[", "[]", "null", '{"evaluation": 3, "quality": [], "loops": 5, "frames": true, "cpu_s": NaN}']:
            (self.folder / "run.json").write_text(text)
            self.assertIn(of_run(self.folder), (None, ({}, {})))
        self.assertEqual(of_evaluation({"ate": {"rmse_m": float("inf")}}), {})


if __name__ == "__main__":
    unittest.main()

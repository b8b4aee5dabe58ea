"""What a suite may say, and the message for each mistake in it."""

import unittest

from support import SOURCE, BatchTest

from kinloop.batch.compare import read_summaries
from kinloop.batch.errors import BatchError
from kinloop.batch.recordings import DATASET_NAME
from kinloop.batch.suite import read_suite

# The suite, and what its message must contain: line and remedy.
MISTAKES = [
    ("sequenzes: [sim:room]", ":1: unknown key 'sequenzes'; did you mean 'sequences'?"),
    ("sequences: [sim:room]\ncolour: 1", ":2: unknown key 'colour'; known here: name"),
    ("sequences: [sim:room]\nsequences: [sim:room]", ":2: 'sequences' is given twice"),
    ("name: a", ":1: 'sequences:' is missing"),
    ("sequences: []", "is empty"),
    ("sequences: {a: b}", ":1: sequences: expected a list"),
    ("sequences:\n- name: a", ":2: sequences: a sequence needs 'path: ...'"),
    ("sequences:\n- {path: a, pth: b}", ":2: sequences: unknown key 'pth'; did you mean 'path'?"),
    ("sequences: [sim:room:5..2]", "expected a range such as 1..20"),
    ("sequences: [sim:room:1..999999999]", "at most 100000 rooms"),
    ("sequences:" + 900 * "\n- sim:room:1..100000", ":2: sequences: more than 1000000 runs, with 1 of each sequence; divide the suite"),
    ("sequences: [sim:room:1..1000]\nseeds: [" + ",".join(map(str, range(9999))) + "]", "more than 1000000 runs, with 9999 of each"),
    ("sequences: [" + 400_000 * "a, " + "a]", "cannot be read (is larger than 1 MB); is this a suite?"),
    ('sequences: ["a\\0"]', "sequences: holds a character that no name can have"),
    ('sequences: [{path: a, name: "\\uD800"}]', "name: holds a character that no name can have"),
    ("sequences: [a]\nseeds: [1, 1]", ":2: seeds: expected seeds that differ"),
    ("sequences: [a]\nseeds: [-1]", ":2: seeds: '-1': expected a whole number"),
    ("sequences: [a]\nseeds: [1.5]", "expected a whole number"),
    ("sequences: [a]\nlimits: {time: 10}", "e.g. 90 s, 10 min or 2 h"),
    ("sequences: [a]\nlimits: {time: nan s}", "e.g. 90 s, 10 min or 2 h"),
    ("sequences: [a]\nlimits: {memory: 4 GB}", "e.g. 500 MiB or 4 GiB"),
    ("sequences: [a]\nthreads: 0", "expected a whole number from 1 to 1024"),
    ("sequences: [a]\nkeep: [../x]", "expected names of files in the folder of a run"),
    ("sequences: [a]\nvariants: {a: {set: {seed: 2}}}", "write 'seeds: [...]'"),
    ("sequences: [a]\nvariants: {a: {arguments: [--camera=x]}}", "write 'camera:' for a sequence"),
    ("sequences: [a]\nvariants: {a: {command: x, external: y}}", "exclude each other"),
    ("sequences: [a]\nvariants: {a: {command: x, set: {a: 1}}}", "'set' is for kinloop run; remove it or 'command'"),
    ("sequences: [a]\nvariants: {a: {external: x, every: 2}}", "'every' is for kinloop run; remove it or 'external'"),
    ("sequences: [a]\nvariants: {a: {every: 0}}", "every: '0': expected a whole number from 1 to 100000"),
    ("sequences: [a]\nvariants: {a: {arguments: [--every=2]}}", "write 'every:'"),
    ("sequences: [a]\nvariants:\n  a: {prepare: 'x {recording}'}", ":3: prepare: {output} is missing"),
    ("sequences: [a]\nvariants: {a: {prepare: 'x {output}'}}", "{recording} is missing"),
    ("sequences: [a]\nvariants: {a: {prepare: 'x {recording} {output}', external: y}}", "'external' reads none"),
    ("sequences: [a]\nvariants:\n  a: {command: 'x {outptu}'}", ":3: command: unknown placeholder {outptu}; known: {recording}"),
    ("sequences: [a]\nvariants: {a: {command: 'x {'}}", "write {{ for a brace"),
    ("sequences: [a]\nvariants: {a: {command: 'x {name:>999999999999}'}}", "'{name' is followed by more than a brace; write {{"),
    ("sequences: [a]\nvariants: {a: {command: 'x {name!r}'}}", "'{name' is followed by more"),
    ("sequences: [a]\nvariants: {a: {command: 'x {name:{seed}}'}}", "'{name' is followed by more"),
    ("sequences: [a]\nvariants: {a: {command: 'x {name.__class__}'}}", "unknown placeholder {name.__class__}"),
    ("sequences: [a]\nvariants: {a: {command: 'x {}'}}", "unknown placeholder {}"),
    ("sequences: [a]\nvariants: {a: {external: '{output}/x'}}", "unknown placeholder {output}"),
    ("sequences: [a]\nvariants: [a]", "expected 'name: value'"),
    ("sequences: [a\n", ": not YAML:"),
    ("sequences: ['\x00']", "not YAML"),
    ("", "empty"),
    ("just text", "expected name, sequences"),
    ("[" * 5000, "not YAML"),
]  # fmt: skip


class Suites(BatchTest):
    def read(self, text):
        return read_suite(self.write("suite.yaml", text))

    def test_each_mistake_is_named_with_its_line_and_remedy(self):
        for text, message in MISTAKES:
            with self.subTest(text[:60]), self.assertRaises(BatchError) as raised:
                self.read(text)
            self.assertIn(message, str(raised.exception))
            self.assertTrue(str(raised.exception).startswith(str(self.folder / "suite.yaml")))
            self.assertNotIn("\n", str(raised.exception))

    def test_a_suite_that_cannot_be_read_is_named(self):
        self.assertIn("nothing.yaml: cannot be read", self.batch(self.folder / "nothing.yaml", expect=3))

    def test_a_list_of_sequences_is_one_variant_with_seed_1(self):
        suite = self.read("sequences: [sim:room:7..9]")
        self.assertEqual([s.pattern for s in suite.sequences], ["sim:room:7", "sim:room:8", "sim:room:9"])
        self.assertEqual([(v.name, v.seeds) for v in suite.variants], [("default", [1])])
        self.assertEqual(suite.name, "suite")

    def test_options_are_taken_as_they_are_written(self):
        suite = self.read("sequences: [a]\nvariants: {a: {set: {x: true, y: 0.50, z: 1e-3}, arguments: [--no-loop]}}\n"
                          "limits: {time: 1.5 h, memory: 2 GiB}\nthreads: 3\nkeep: ['*.ply']")  # fmt: skip
        self.assertEqual(suite.variants[0].options, {"x": "true", "y": "0.50", "z": "1e-3"})
        self.assertEqual((suite.time_s, suite.memory_mib, suite.threads, suite.keep), (5400, 2048, 3, ["*.ply"]))

    def test_a_variant_has_the_seeds_of_the_suite_or_its_own(self):
        suite = self.read("sequences: [a]\nseeds: [1, 2]\nvariants: {a: , b: {seeds: 5}, c: {external: x}, d: {command: x}}")
        self.assertEqual([v.seeds for v in suite.variants], [[1, 2], [5], [0], [0]])

    def test_globs_are_sorted_and_names_must_differ(self):
        for name in ("b/two", "b/one", "c/one"):
            self.recording(name)
        self.run_suite("sequences: ['b/*']")
        self.assertEqual([(r["dataset"], r["sequence"]) for r in self.rows()], [("b", "one"), ("b", "two")])
        self.assertIn("two sequences are named one", self.run_suite("sequences: ['b/*', c/one]", expect=3))
        self.run_suite("sequences: ['b/*', {path: c/one, name: other, dataset: d}]")
        self.assertEqual([(r["dataset"], r["sequence"]) for r in self.rows()][2], ("d", "other"))

    def test_sequences_of_datasets_are_fetched_by_name_once(self):
        for _ in range(2):
            self.run_suite("sequences: [tum/fr1_room]")
            self.assertEqual([(r["dataset"], r["sequence"]) for r in self.rows()], [("tum", "fr1_room")])
        self.run_suite("sequences: [{path: 7scenes/chess/seq-01, name: chess_seq-01, dataset: 7-Scenes}]")
        self.assertIn(("7-Scenes", "chess_seq-01"), [(r["dataset"], r["sequence"]) for r in self.rows()])
        self.assertIn("tum/fr1_unknown: kinloop fetch failed: fetch: the server says 404",
                      self.run_suite("sequences: [tum/fr1_unknown]", expect=3))  # fmt: skip

    def test_the_suites_of_the_project_can_be_read(self):
        suites = {path.stem: read_suite(path) for path in (SOURCE / "bench" / "suites").glob("*.yaml")}
        names = {stem: {s.pattern for s in suite.sequences} for stem, suite in suites.items() if stem not in ("docs", "regression")}
        self.assertEqual({stem: len(found) for stem, found in names.items()},
                         {"tum": 47, "eth3d": 61, "icl_nuim": 8, "7scenes": 46, "bonn": 26, "replica": 8, "openloris": 22, "scannet": 1513})  # fmt: skip
        for found in names.values():
            self.assertEqual([name for name in found if not DATASET_NAME.fullmatch(name)], [])
        self.assertIn("docs", suites)
        before = read_summaries(SOURCE / "bench" / "suites" / "regression.csv")  # what .ci/check_accuracy.sh compares with
        self.assertEqual([s["sequence"] for s in before if s["ate_m"] is not None], [s.pattern for s in suites["regression"].sequences])

    def test_a_recording_with_other_bytes_than_the_suite_says_is_refused(self):
        self.recording("room")
        output = self.run_suite(f"sequences:\n- {{path: room, sha256: {'0' * 64}}}", expect=3)
        self.assertIn("suite.yaml:2: ", output)
        digest = output.split("its sha256 is ")[1].split(";")[0]
        self.run_suite(f"sequences:\n- {{path: room, sha256: {digest}}}")
        self.write("room/rgb/1.png", "another image")
        self.assertIn("is another recording", self.run_suite(f"sequences:\n- {{path: room, sha256: {digest}}}", expect=3))

    def test_a_missing_recording_is_named_with_the_line_of_the_suite(self):
        self.assertIn("suite.yaml:2: nowhere: no such recording", self.run_suite("sequences:\n- nowhere", expect=3))

    def test_another_program_is_refused(self):
        self.assertIn("is it kinloop", self.run_suite("sequences: [sim:room]", "--program", "false", expect=3))
        text = self.write("text", "no program")
        text.chmod(0o755)
        self.assertIn("is it kinloop?", self.run_suite("sequences: [sim:room]", "--program", text, expect=3))

    def test_a_missing_program_is_named(self):
        self.assertIn("--program", self.run_suite("sequences: [sim:room]", "--program", "no-such-program", expect=3))


if __name__ == "__main__":
    unittest.main()

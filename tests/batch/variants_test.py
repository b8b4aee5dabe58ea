"""Variants that use a part of a recording, or a changed copy of it."""

import json
import unittest

from support import BatchTest

from kinloop.batch.templates import filled

# Copies the recording and writes one more file, with the seed in it.
DISTURB = '#!/bin/sh\ncp -r "$1" "$2" && echo "$3" > "$2/disturbed.txt"\n'
# Prints what the run sees; its ATE is the number of files in the recording.
PEER = '#!/bin/sh\nls "$1"; echo "1.0 $(ls "$1" | wc -l) 0 0 0 0 0 1" > "$2/trajectory.txt"\n'


class Variants(BatchTest):
    def script(self, name, text):
        path = self.write(name, text)
        path.chmod(0o755)
        return path

    def jobs(self):
        return [json.loads(line) for line in (self.results / "plan.jsonl").read_text().splitlines()[1:]]

    def run_variants(self, text, **kwargs):
        self.run_suite(f"sequences: [room]\nvariants:\n{text}", **kwargs)
        return self.rows()

    def test_every_nth_frame_is_asked_of_the_program_and_has_a_key_of_its_own(self):
        self.recording("room")
        rows = self.run_variants("  all:\n  third: {every: 3}\n  fifth: {every: 5}\n  first: {every: 1}\n")
        words = [job["words"] for job in self.jobs()]
        self.assertEqual([w[w.index("--every") + 1] if "--every" in w else "" for w in words], ["", "3", "5", ""])
        self.assertEqual(len({row["key"] for row in rows}), 3)
        self.assertEqual(rows[0]["key"], rows[3]["key"])


    def test_placeholders_in_names_are_not_replaced(self):
        name = "k{output}x{prepared}{{y}}{"
        self.recording(name)
        self.script("peer.sh", PEER)
        self.script("copy.sh", DISTURB)
        self.write(f"orb/{name}.txt", "1.0 0.25 0 0 0 0 0 1\n")
        self.run_suite("sequences: ['k{*']\nvariants:\n  run: {arguments: ['{output}']}\n"
                       "  peer: {command: './peer.sh {recording} {output} {name} {{x}}'}\n  orb: {external: 'orb/{name}.txt'}\n"
                       "  copy: {prepare: './copy.sh {recording} {output}', command: './peer.sh {recording} {output}'}\n")  # fmt: skip
        self.assertEqual([(row["sequence"], row["status"]) for row in self.rows()], [(name, "done")] * 4)
        words = {job["variant"]: [filled(word, {"output": "OUT", "prepared": "COPY"}) for word in job["words"]] for job in self.jobs()}
        self.assertEqual(words["run"][2:5], [f"{self.folder}/{name}", "-o", "OUT"])
        self.assertEqual(words["run"][8], "{output}")
        self.assertEqual(words["peer"][1:], [f"{self.folder}/{name}", "OUT", name, "{x}"])


class Prepare(Variants):
    def setUp(self):
        super().setUp()
        self.recording("room")
        self.script("scripts/disturb.sh", DISTURB)
        self.script("peer.sh", PEER)

    def test_a_run_sees_the_changed_copy_under_the_name_of_the_recording(self):
        text = "  a: {prepare: './scripts/disturb.sh {recording} {output} x', command: './peer.sh {recording} {output}'}\n"
        (row,) = self.run_variants("  b: {command: './peer.sh {recording} {output}'}\n" + text)[1:]
        self.assertEqual((row["status"], row["ate_m"]), ("done", 3))
        folder = self.results / "runs" / row["key"]
        self.assertEqual((folder / "log.txt").read_text().split(), ["disturbed.txt", "groundtruth.txt", "rgb"])
        self.assertEqual({path.name for path in folder.iterdir()}, {"log.txt", "result.json", "trajectory.txt"})
        self.assertEqual(list((self.results / "runs/.work").iterdir()), [])
        self.assertFalse((self.folder / "room/disturbed.txt").exists())

    def test_kinloop_runs_on_the_copy(self):
        (row,) = self.run_variants("  a: {prepare: './scripts/disturb.sh {recording} {output} x'}\n")
        self.assertEqual(row["status"], "done")
        (job,) = self.jobs()
        self.assertIn("{prepared}", job["words"])
        self.assertEqual(job["prepare"], [str(self.folder / "scripts/disturb.sh"), str(self.folder / "room"), "{output}", "x"])

    def test_a_program_is_started_by_the_name_of_its_link(self):
        self.script("real.sh", '#!/bin/sh\necho "$0"; mkdir "$2"\n')
        (self.folder / "link.sh").symlink_to("real.sh")
        (row,) = self.run_variants("  a: {prepare: './link.sh {recording} {output}'}\n")
        self.assertIn(f"{self.folder}/link.sh\n", (self.results / "runs" / row["key"] / "log.txt").read_text())

    def test_what_changes_the_copy_changes_the_key(self):
        def key(arguments, more=""):
            return self.run_variants(f"  a: {{prepare: './scripts/disturb.sh {{recording}} {{output}} {arguments}'{more}}}\n")[0]["key"]

        keys = {self.run_variants("  a:\n")[0]["key"], key("x"), key("y"), key("{seed}"), key("{seed}", ", seeds: 2")}
        keys.add(key("x", ", version: 2"))
        self.script("scripts/disturb.sh", DISTURB + "\n")
        keys.add(key("x"))
        self.assertEqual(len(keys), 7)
        calls = len(self.calls())
        key("x")
        self.assertEqual(len(self.calls()), calls)

    def test_a_script_that_an_interpreter_runs_is_part_of_the_key(self):
        def key():
            return self.run_variants("  a: {prepare: 'sh scripts/disturb.sh {recording} {output}'}\n")[0]

        first = key()
        self.assertEqual(first["status"], "done")
        self.script("scripts/disturb.sh", DISTURB + "\n")
        self.assertNotEqual(key()["key"], first["key"])

    def test_a_copy_that_cannot_be_made_is_a_row_with_its_log(self):
        self.script("scripts/disturb.sh", "#!/bin/sh\necho no such disturbance >&2; exit 4\n")
        (row,) = self.run_variants("  a: {prepare: './scripts/disturb.sh {recording} {output}'}\n")
        self.assertEqual((row["status"], row["exit"]), ("not prepared", "4"))
        self.assertIn("no such disturbance", (self.results / "runs" / row["key"] / "log.txt").read_text())
        self.assertEqual(self.calls(), [])
        self.script("scripts/disturb.sh", "#!/bin/sh\nsleep 1000\n")
        self.run_suite("sequences: [room]\nvariants: {a: {prepare: './scripts/disturb.sh {recording} {output}'}}\nlimits: {time: 1 s}")
        self.assertEqual(self.rows()[0]["status"], "time limit")
        self.assertEqual(list((self.results / "runs/.work").iterdir()), [])


if __name__ == "__main__":
    unittest.main()

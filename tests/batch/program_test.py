"""kinloop batch by the program itself: $KINLOOP_PROGRAM."""

import json
import os
import re
import subprocess
import sys
import unittest

from support import SOURCE, BatchTest

from kinloop.batch import command

PROGRAM = os.environ["KINLOOP_PROGRAM"]
SUITE = """
sequences: [sim:room:1]
variants:
  default: {set: {sim.fps: 5, sim.frames: 8, sim.width: 160, sim.height: 120}}
keep: [trajectory.txt, groundtruth.txt, run.json, report.html]
"""


class Program(BatchTest):
    def kinloop(self, *words, expect=0, **environment):
        done = subprocess.run([PROGRAM, "batch", *(str(word) for word in words)], capture_output=True, text=True, cwd=self.folder,
                              env=os.environ | environment)  # fmt: skip
        self.assertEqual(done.returncode, expect, done.stderr)
        return done.stdout + done.stderr

    def test_a_room_is_mapped_verified_and_compared(self):
        self.write("suite.yaml", SUITE)
        self.assertIn("1 done\n", self.kinloop("suite.yaml", "-o", "results", "--workers", 1))
        (row,) = self.rows()
        self.assertTrue(0 < row["ate_m"] < 0.5 and 0 < row["live_ate_m"] < 0.5 and row["frames"] == 8 and row["coverage"] > 0.5, row)
        self.assertIn("1 runs, 0 to do", self.kinloop("suite.yaml", "-o", "results"))
        self.assertIn("1 runs repeated, 0 differ", self.kinloop("verify", "results"))
        self.assertIn("not worse", self.kinloop("compare", "results", "results"))
        page = (self.results / "index.html").read_text()
        data = json.loads(re.search(r'id="data">(.*)</script>', page)[1])
        self.assertEqual(data["rows"][0][-1], "report.html")
        self.assertTrue(data["worst"][0]["picture"].startswith("data:image/svg+xml"))
        identity = json.loads((self.results / "runs" / row["key"] / "result.json").read_text())["identity"]
        self.assertRegex(identity["program"], "^build-id:[0-9a-f]{16,}$")
        self.assertNotIn("seed", identity["options"])  # 1, its default

    def test_every_second_frame_is_mapped(self):
        self.write("suite.yaml", SUITE.replace("default: {", "default: {every: 2, "))
        self.kinloop("suite.yaml", "-o", "results", "--workers", 1)
        self.assertEqual(self.rows()[0]["frames"], 4)

    def test_help_is_that_of_the_package_in_the_layout_of_the_program(self):
        sys.path.insert(0, str(SOURCE / "scripts"))
        from command_help import read_commands

        batch = read_commands(PROGRAM, "batch")
        self.assertEqual([child.name for child in batch.children],
                         [f"batch {name}" for name in command.COMMANDS if name != "task"])  # fmt: skip
        for parsed in batch.walk():
            name = parsed.name.removeprefix("batch").strip()
            make_parser = command.COMMANDS[name][0] if name else command.run_parser
            actions = make_parser()._actions
            self.assertEqual(parsed.flags, [flag for action in actions for flag in action.option_strings])
            self.assertEqual([p.left.split()[0] for p in parsed.positionals], [a.metavar for a in actions if not a.option_strings])
            self.assertTrue(all(item.text for item in parsed.options + parsed.positionals + parsed.subcommands), parsed)
            run = lambda *words: subprocess.run([PROGRAM, *words], capture_output=True, text=True).stdout  # noqa: E731
            self.assertEqual(run("help", *parsed.name.split()), run(*parsed.name.split(), "--help"))

    def test_wrong_use_is_refused_by_the_program(self):
        self.assertIn("SUITE is missing", self.kinloop(expect=2))
        self.assertIn("did you mean '--workers'?", self.kinloop("suite.yaml", "--wrokers", 2, expect=2))
        self.assertIn("whole number", self.kinloop("suite.yaml", "--workers", "0", expect=2))
        self.assertIn("RESULTS", self.kinloop("table", expect=2))
        self.assertIn("suite.yaml: cannot be read", self.kinloop("suite.yaml", expect=3))

    def test_a_missing_python_is_named(self):
        self.assertIn("there is no python3: apt install python3", self.kinloop("suite.yaml", expect=3, PATH=str(self.folder)))


if __name__ == "__main__":
    unittest.main()

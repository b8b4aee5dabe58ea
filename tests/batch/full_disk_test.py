"""Batches on a disk that gets full: whatever ends them, they have no wrong row, and go on once there is room."""

import os
import subprocess
import unittest
import unittest.mock

from support import BatchTest, tmpfs

SUITE = "sequences: ['sim:room:1..4']\nvariants: {a: {set: {fake.bytes: 150000}}}\nkeep: ['*.ply', trajectory.txt]\n"
# Without fallible words of the program: a shell that does not see that its disk is full.
HEEDLESS = """sequences: [room]
variants: {a: {command: 'sh heedless.sh {output}', version: '1'}}
keep: [trajectory.txt]
"""
REAL = """sequences: ['sim:room:1..2']
variants: {a: {set: {sim.fps: 5, sim.frames: 8, sim.width: 160, sim.height: 120}}}
keep: [trajectory.txt, map.ply, map.kinmap]
"""


class FullDisk(BatchTest):
    def check(self, suite, sizes_kib):
        """Runs a suite on disks of these sizes, then with more room; returns how many batches ended early."""
        undisturbed, ended = self.folder / "undisturbed", 0
        self.run_suite(suite, results=undisturbed)
        for size in sizes_kib:
            with self.subTest(size), tmpfs(self.folder / f"disk{size}", f"{size}k") as disk:
                results = disk / "results"
                output = self.run_suite(suite, results=results, expect=unittest.mock.ANY)
                if "error: " in output:
                    ended += 1
                    self.assertRegex(output, r"error: .*(is full|cannot be written).* run the same command again.*\n$")
                if (results / "runs.csv").exists():
                    self.assertLessEqual({row["status"] for row in self.rows(results)}, {"done", "not run"})
                subprocess.run(["mount", "-o", "remount,size=1g", disk], check=True)
                self.run_suite(suite, results=results)
                self.assertEqual(self.table(results), self.table(undisturbed))
                self.assertEqual([list((results / "runs" / name).iterdir()) for name in (".claims", ".work")], [[], []])
        return ended

    def test_a_program_that_tells_its_error(self):
        ended = self.check(SUITE, (16, 48, 96, 176, 256, 352, 464, 592, 720, 4096))
        self.assertTrue(5 <= ended < 10, ended)

    def test_a_program_that_does_not_notice(self):
        self.recording("room")
        self.write("heedless.sh", "head -c 200000 /dev/zero > $1/big 2>&-; echo '1.0 0.5 0 0 0 0 0 1' > $1/trajectory.txt; exit 0\n")
        self.assertEqual(self.check(HEEDLESS, (64, 128, 200, 224, 4096)), 4)

    @unittest.skipUnless("KINLOOP_PROGRAM" in os.environ, "there is no $KINLOOP_PROGRAM")
    def test_kinloop(self):
        self.program = os.environ["KINLOOP_PROGRAM"]
        ended = self.check(REAL, (64, 128, 256, 384, 512, 768, 1024, 1536, 2048, 65536))
        self.assertTrue(3 <= ended < 10, ended)


if __name__ == "__main__":
    unittest.main()

"""scripts/update_figures.py: figures of a batch in documents."""

import subprocess
import sys
import unittest

from support import SOURCE, BatchTest

SUITE = "sequences: ['sim:room:1..2']\nvariants: {default: , no_loop: {arguments: [--no-loop]}}\n"
DOCUMENT = """# Title

<!-- figures: main -->
<!-- end of figures -->

<!-- figures: short -->
old
<!-- end of figures -->
end
"""


class Figures(BatchTest):
    def setUp(self):
        super().setUp()
        self.run_suite(SUITE)
        self.document = self.write("doc.md", DOCUMENT)

    def update(self, *options, expect=0):
        call = [sys.executable, SOURCE / "scripts/update_figures.py", self.results, self.document, *options]
        done = subprocess.run([str(word) for word in call], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, expect, done.stderr)
        return done.stdout + done.stderr

    def replace(self, before, after):
        text = self.document.read_text()
        self.assertIn(before, text)
        self.document.write_text(text.replace(before, after, 1))

    def test_blocks_become_tables_and_the_rest_stays(self):
        self.update()
        text = self.document.read_text()
        errors = [f"{row['ate_m']:.4f} | {row['live_ate_m']:.4f}" for row in self.rows()]
        self.assertIn("| run | tracked | keyframes | loops | ATE m | live ATE m | CPU s | peak MiB |\n|---|---|---|---|---|---|---|---|\n",
                      text)  # fmt: skip
        self.assertIn(f"| `sim:room:1` | 99 / 100 | 7 | 2 | {errors[0]} | ", text)
        self.assertIn(f"| the same, `no_loop` | 99 / 100 | 7 | 2 | {errors[1]} | ", text)
        short = text[text.index("short"):]  # fmt: skip
        self.assertIn(f"| `sim:room:2` | 99 / 100 | {errors[2]} |\n", short)
        self.assertNotIn("no_loop", short)
        self.assertTrue(text.startswith("# Title\n\n<!-- figures: main -->\n| run") and text.endswith("|\n<!-- end of figures -->\nend\n"))
        self.update()
        self.assertEqual(self.document.read_text(), text)

    def test_a_stale_block_is_found(self):
        self.assertIn("doc.md:3: stale figures, e.g. ", self.update("--check", expect=1))
        self.update()
        self.assertIn("all figures are those", self.update("--check"))
        for before, after in [("99 / 100", "98 / 100"), ("0.0", "0.1"), ("| the same, `no_loop` |", "| the same |")]:
            text = self.document.read_text()
            self.replace(before, after)
            self.assertIn("doc.md:3: stale figures", self.update("--check", expect=1))
            self.document.write_text(text)
        line = next(line for line in self.document.read_text().splitlines() if "no_loop" in line)
        self.replace(line + "\n", "")
        self.update("--check", expect=1)

    def test_times_and_memory_may_differ(self):
        self.update()
        self.replace("| 100 |\n", "| 140 |\n")
        self.update("--check")

    def test_marks_and_tables_that_are_wrong_are_named(self):
        for text, message in [("no mark", "needs pairs"), ("<!-- figures: main -->\n", "needs pairs"),
                              ("\n<!-- figures: maim -->\n<!-- end of figures -->\n", "doc.md:2: unknown table 'maim'; known: main")]:  # fmt: skip
            self.document.write_text(text)
            self.assertIn(message, self.update(expect=3))
            self.assertEqual(self.document.read_text(), text)
        self.document.write_text(DOCUMENT)
        (self.results / "runs.csv").write_text("a,b\n1,2\n")
        self.assertIn("runs.csv: no table of runs; kinloop batch table", self.update(expect=3))
        (self.results / "runs.csv").unlink()
        self.assertIn("runs.csv: No such file", self.update(expect=3))

    def test_a_batch_that_is_not_finished_has_no_figures(self):
        self.write("results/runs.csv", (self.results / "runs.csv").read_text().replace(",done,", ",not run,", 1))
        self.assertIn("not all runs are finished", self.update(expect=3))


class Documents(unittest.TestCase):
    def test_the_documents_of_the_project_have_blocks(self):
        sys.path.insert(0, str(SOURCE / "scripts"))
        import update_figures

        self.assertTrue(update_figures.DOCUMENTS)
        for path in update_figures.DOCUMENTS:
            self.assertTrue(update_figures.read_document(path))


if __name__ == "__main__":
    unittest.main()

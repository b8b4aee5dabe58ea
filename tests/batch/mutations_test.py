"""Damaged files in a folder of results: each message is one line, and nothing hangs or ends in a traceback."""

import copy
import json
import os
import random
import unittest
import unittest.mock

from support import BatchTest

from kinloop.batch.files import remove

VALUES = (None, True, -1, 0.5, 1e308, 10**400, float("nan"), "", "\x1b[2J\n=1", "../..", "\ud800", [], [[]], {}, {"a": [1]})


def shapes(value):
    """The value with each of its parts replaced by each of VALUES, or left out."""
    yield from VALUES
    for place in list(value) if isinstance(value, dict) else range(len(value)) if isinstance(value, list) else ():
        for part in shapes(value[place]):
            changed = copy.copy(value)
            changed[place] = part
            yield changed
        if isinstance(value, dict):
            yield {name: part for name, part in value.items() if name != place}


def damaged(data, rng, count):
    """Copies of bytes that are cut off, or have some bytes changed, put in or taken out."""
    for _ in range(count):
        changed = bytearray(data)
        for _ in range(rng.randrange(1, 4)):
            place = rng.randrange(len(changed) or 1)
            changed[place : place + rng.choice((0, 1, 9))] = rng.choice((b"", b"\xff", b"\0", b"[" * 9, b'"', b"9" * 30, b"-", b"}"))
        yield bytes(changed[: rng.choice((len(changed), rng.randrange(len(changed) or 1)))])


class Mutations(BatchTest):
    def setUp(self):
        super().setUp()
        self.suite = "sequences: [sim:room]\nkeep: []\n"
        self.run_suite(self.suite)
        self.good = self.table()
        (self.result,) = (self.results / "runs").glob("*/result.json")
        self.plan = self.results / "plan.jsonl"

    def check(self, *words):
        """Runs a command that may succeed or refuse in one line; returns its output."""
        output = self.batch(*words, "-q", expect=unittest.mock.ANY)
        self.assertNotRegex(output, "[\x1b\ud800]")
        self.assertTrue(output.count("\n") <= 1 or "compare" in words, output)
        return output

    def test_a_result_of_any_shape_is_a_row_or_missing(self):
        result = json.loads(self.result.read_text())
        texts = [json.dumps(shape) for shape in shapes(result)]
        texts += [text.decode(errors="surrogateescape") for text in damaged(self.result.read_bytes(), random.Random(1), 300)]
        for number, text in enumerate(texts):
            self.result.write_text(text, errors="surrogateescape")
            self.check("table", self.results)
            row = self.rows()[0]
            self.assertEqual((row["sequence"], row["variant"]), ("sim:room", "default"))
            if number % 8 == 0:
                self.check("compare", self.results, self.results)

    def test_a_run_without_a_readable_result_is_repeated(self):
        for make in (os.unlink, lambda path: path.write_text("{"), lambda path: path.write_text('{"status": 3}'),
                     lambda path: (os.unlink(path), os.mkdir(path)), lambda path: (os.unlink(path), os.mkfifo(path)),
                     lambda path: (os.unlink(path), path.symlink_to("result.json"))):  # fmt: skip
            make(self.result)
            self.batch("table", self.results)
            self.assertEqual(self.rows()[0]["status"], "not run")
            calls = len(self.calls())
            self.assertIn("1 runs, 1 to do", self.run_suite(self.suite))
            self.assertEqual((self.table(), len(self.calls())), (self.good, calls + 1))
        for make in (remove, lambda path: (remove(path), path.write_text("a file"))):
            make(self.result.parent)
            self.run_suite(self.suite)
            self.assertEqual(self.table(), self.good)
        self.assertEqual(list((self.results / "runs/.work").iterdir()), [])

    def test_a_plan_of_any_shape_is_read_or_refused_with_its_line(self):
        first, line = self.plan.read_text().splitlines()
        plans = [f"{first}\n{json.dumps(shape)}\n".encode() for shape in shapes(json.loads(line) | {"identity": {}})]
        plans += [f"{json.dumps(shape)}\n{line}\n".encode() for shape in shapes({"title": "a"})]
        plans += damaged(self.plan.read_bytes(), random.Random(2), 300)
        refused = 0
        for plan in plans:
            self.plan.write_bytes(plan)
            refused += "error: " in self.check("table", self.results)
        self.assertGreater(refused, 100)

    def test_claims_of_any_shape_are_of_an_owner_or_lapse(self):
        from kinloop.batch.store import Store

        store = Store(self.results)
        claim, owner = store.claims / "key.0", {"machine": "a", "pid": 1, "started": "1"}
        texts = [json.dumps(shape).encode() for shape in shapes(owner)] + list(damaged(json.dumps(owner).encode(), random.Random(3), 200))
        for text in texts:
            claim.write_bytes(text)
            self.assertIsNone(store.claim("key"), text)
            self.assertIn("machine", store.owner("key"))
            os.utime(claim, (1, 1))
            store.claim("key").release()
            self.assertEqual(list(store.claims.iterdir()), [], text)


if __name__ == "__main__":
    unittest.main()

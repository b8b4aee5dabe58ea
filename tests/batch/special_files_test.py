"""Paths that lead to pipes, devices, sockets, nowhere, or in a circle."""

import os
import socket
import unittest

from support import BatchTest

from kinloop.batch.files import hash_of_file, kind_of, read_json
from kinloop.batch.recordings import Hashes, matching


class SpecialFiles(BatchTest):
    """A folder `odd` with one path of each kind."""

    def setUp(self):
        super().setUp()
        self.odd = self.folder / "odd"
        self.odd.mkdir()
        os.mkfifo(self.odd / "pipe")
        with socket.socket(socket.AF_UNIX) as bound:
            bound.bind(str(self.odd / "socket"))
        for name, target in (("device", "/dev/zero"), ("nothing", "nowhere"), ("itself", "itself")):
            (self.odd / name).symlink_to(target)

    def test_each_kind_is_told_and_only_files_are_read(self):
        kinds = {path.name: kind_of(path) for path in self.odd.iterdir()}
        self.assertEqual(kinds, {name: name for name in ("pipe", "socket", "device", "nothing")} | {"itself": "nothing"})
        for path in self.odd.iterdir():
            self.assertIsNone(read_json(path))
            with self.assertRaises(OSError):
                hash_of_file(path)
        self.assertEqual((kind_of(self.folder), kind_of("a\0b")), ("folder", "nothing"))

    def test_a_recording_may_hold_them_and_they_are_part_of_its_key(self):
        plain = Hashes(self.folder / "hashes").of(self.recording("room"))[0]
        for path in list(self.odd.iterdir()):
            path.rename(self.folder / "room" / path.name)
        self.run_suite("sequences: [room]")
        self.assertEqual(self.rows()[0]["status"], "done")
        self.assertNotEqual(Hashes(self.folder / "hashes").of(self.folder / "room")[0], plain)

    def test_links_in_a_circle_end(self):
        self.recording("rooms/room")
        for name in "ab":  # 2^40 paths
            (self.folder / "rooms/room" / name).symlink_to(".")
        for level in range(40):  # and without a circle
            (self.folder / f"chain/{level}").mkdir(parents=True)
            for name in "ab":
                (self.folder / f"chain/{level}/{name}").symlink_to(f"../{level + 1}")
        (self.folder / "rooms/room/chain").symlink_to("../../chain/0")
        self.run_suite("sequences: ['rooms/**/room']")
        self.assertEqual([(row["sequence"], row["status"]) for row in self.rows()], [("room", "done")])

    def test_two_stars_match_folders_at_any_depth(self):
        for name in ("b/two/x", "b/x", "b/.hidden/x", "b/two/deep/x"):
            self.recording(name)
        for pattern, names in (("b/**/x", ["b/two/deep", "b/two", "b"]), ("b/t**/x", ["b/two"]), ("b/*/**/x", ["b/two/deep", "b/two"])):
            self.assertEqual(matching(f"{self.folder}/{pattern}"), {f"{self.folder}/{name}/x" for name in names})

    def test_a_recording_or_truth_of_another_kind_is_refused_with_its_line(self):
        self.recording("room")
        for kind in ("pipe", "socket", "device"):
            for suite in (f"sequences:\n- odd/{kind}", f"sequences:\n- {{path: room, truth: odd/{kind}}}", f"sequences:\n- odd/{kind}*"):
                self.assertRegex(self.run_suite(suite, expect=3), rf"suite.yaml:2: .*/odd/{kind}: is a {kind}; give the folder or the file")
        self.assertIn("no such recording", self.run_suite("sequences: [odd/nothing]", expect=3))

    def test_a_suite_camera_script_or_trajectory_of_another_kind_is_no_hang(self):
        self.recording("room")
        self.assertIn("is a pipe, not a file", self.batch(self.odd / "pipe", "-o", self.results, expect=3))
        self.run_suite("sequences: [{path: room, camera: odd/pipe}]")
        self.run_suite("sequences: [room]\nvariants: {a: {external: odd/pipe}, b: {command: 'true odd/pipe'}}")
        self.assertEqual([row["status"] for row in self.rows()], ["no trajectory", "no truth"])
        self.assertIn("is a pipe", self.batch("compare", self.odd / "pipe", self.odd / "pipe", expect=3))

    def test_a_damaged_cache_of_hashes_is_renewed(self):
        hashes, room = Hashes(self.folder / "hashes"), self.recording("room")
        digest = hashes.of(room)[0]
        (cache,) = (self.folder / "hashes").iterdir()
        good = cache.read_text()
        for text in ("", "[]", "7", '{"rgb/1.png": 1}', '{"rgb/1.png": []}', good.replace('"', "'"), good[: len(good) // 2]):
            cache.write_text(text)
            self.assertEqual(hashes.of(room)[0], digest, text)
            self.assertEqual(cache.read_text(), good)


if __name__ == "__main__":
    unittest.main()

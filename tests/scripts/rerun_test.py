#!/usr/bin/env python3
"""Reads what `kinloop export --rrd` writes with Rerun's own reader, and compares it with the run.

Usage: rerun_test.py KINLOOP SHARED_DATA      skipped (77) without rerun-sdk, which scripts/install_test_packages.sh
installs. SHARED_DATA is not used.
"""

import contextlib
import io
import json
import os
import subprocess
import sys
import unittest
from pathlib import Path

from program import PROGRAM, SmallRunTest, kinloop

# Without the package around it, which needs the compiled module.
sys.path.insert(0, str(Path(__file__).parents[2] / "python/kinloop"))
import _rerun  # noqa: E402

try:
    import numpy as np
    from PIL import Image
    from rerun.chunk import RrdReader
    from scipy.spatial import KDTree
    from scipy.spatial.transform import Rotation
except ImportError as error:
    print(f"skipped: {error}; see scripts/install_test_packages.sh")
    sys.exit(77)

FLOAT_M = 1e-5  # float32 of Rerun
MAX_MEDIAN_M = 0.015  # voxels of 10 mm, a single depth image against their fusion
CAMERA, CLOUD = "/world/run/camera", "/world/cloud"


def stamps_ns(texts):
    """Exact nanoseconds of stamps such as 1.033333."""
    return [int(whole) * 10**9 + int(part.ljust(9, "0")) for whole, part in (text.split(".") for text in texts)]


def table_of(path):
    return [line.split() for line in path.read_text().splitlines() if not line.startswith("#")]


def chunks_of(parts, file):
    _rerun.write_rrd(parts, file)
    return [chunk.to_record_batch() for chunk in RrdReader(file).stream().to_chunks()]


class Rerun(SmallRunTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.rrd = cls.folder / "run.rrd"
        # The program starts the first python3, which must be the one with rerun-sdk.
        os.environ["PATH"] = f"{Path(sys.executable).parent}:{os.environ['PATH']}"
        kinloop("export", cls.run_folder, "-q", "--rrd", cls.rrd)
        cls.chunks = [chunk.to_record_batch() for chunk in RrdReader(cls.rrd).stream().to_chunks()]

    def rows(self, entity, component, static=False):
        """Stamps in ns (None if static) and values of the rows of a component."""
        rows = []
        for chunk in self.chunks:
            if chunk.schema.metadata[b"rerun:entity_path"].decode() != entity or component not in chunk.schema.names:
                continue
            stamps = chunk["stamp"].cast("int64").to_pylist() if not static else [None] * len(chunk)
            rows += [row for row in zip(stamps, chunk[component].to_pylist()) if row[1] is not None]
        return list(zip(*sorted(rows, key=lambda row: row[0] or 0)))

    def static(self, entity, component):
        (_, (value,)) = self.rows(entity, component, static=True)
        return value

    def write_parts(self, **changes):
        """Writes the parts of a run without images, with one frame."""
        self.parts = self.folder / "parts"
        self.parts.mkdir(exist_ok=True)
        poses = {"stamps_ns": [0], "poses": [[0, 0, 0, 0, 0, 0, 1]]}
        run = {"name": "parts", "frame": {"frame": "camera"}, "trajectory": poses, "keyframes": poses, "loops": [],
               "frames": {"stamps_ns": [0], "located": [True], "doubtful": [False]}, "frame_table": "", **changes}
        (self.parts / "run.json").write_text(json.dumps(run))
        (self.parts / "transforms.json").write_text(
            json.dumps({"w": 4, "h": 3, "fl_x": 4, "fl_y": 4, "cx": 2, "cy": 1.5, "frames": []}))
        properties = [f"property float {axis}" for axis in "xyz"] + \
                     [f"property uchar {color}" for color in ("red", "green", "blue")]
        header = "\n".join(["ply", "format binary_little_endian 1.0", "element vertex 1", *properties, "end_header\n"])
        (self.parts / "cloud.ply").write_bytes(header.encode() + bytes(15))

    def test_camera_moves_along_the_trajectory(self):
        lines = table_of(self.run_folder / "trajectory.txt")
        stamps, translations = self.rows(CAMERA, "Transform3D:translation")
        _, quaternions = self.rows(CAMERA, "Transform3D:quaternion")
        self.assertEqual(list(stamps), stamps_ns([line[0] for line in lines]))
        poses = np.array([line[1:] for line in lines], float)
        np.testing.assert_allclose(np.array(translations)[:, 0], poses[:, :3], atol=FLOAT_M)
        np.testing.assert_allclose(np.array(quaternions)[:, 0], poses[:, 3:], atol=FLOAT_M)

    def test_cloud_has_the_points_and_colours_of_the_run(self):
        header, _, body = (self.run_folder / "map.ply").read_bytes().partition(b"end_header\n")
        fields = [(name, "<f4") for name in ("x", "y", "z", "nx", "ny", "nz")] + [(name, "u1") for name in "rgb"]
        points = np.frombuffer(body, fields)
        self.assertIn(f"element vertex {len(points)}\n".encode(), header)
        written = np.array(self.static(CLOUD, "Points3D:positions"))
        np.testing.assert_array_equal(written, np.stack([points[axis] for axis in "xyz"], axis=1))
        colors = np.array(self.static(CLOUD, "Points3D:colors"), np.uint32)  # 0xRRGGBBAA
        np.testing.assert_array_equal(np.stack([colors >> 24, colors >> 16 & 255, colors >> 8 & 255], axis=1),
                                      np.stack([points[channel] for channel in "rgb"], axis=1))

    def test_keyframes_are_those_of_the_run(self):
        written = self.static("/world/run/keyframes", "Points3D:positions")
        expected = np.array([line[1:4] for line in table_of(self.run_folder / "keyframes.txt")], float)
        np.testing.assert_allclose(written, expected, atol=FLOAT_M)

    def test_loops_join_the_positions_of_the_parts(self):
        loops = [[[0, 0, 0], [1, 0.5, 2]], [[3, 0, 0], [0, 4, 0]]]
        self.write_parts(loops=loops)
        self.chunks = chunks_of(self.parts, self.folder / "loops.rrd")
        np.testing.assert_array_equal(self.static("/world/run/loops", "LineStrips3D:strips"), loops)

    def test_unrelated_table_is_left_out_with_a_warning(self):
        table = self.folder / "unrelated.txt"
        table.write_text("a b c d e f\n")
        self.write_parts(frame_table=str(table))
        with contextlib.redirect_stderr(io.StringIO()) as printed:
            self.chunks = chunks_of(self.parts, self.folder / "unrelated.rrd")
        self.assertIn(f"warning: {table}: is not a table of frames", printed.getvalue())
        self.assertEqual(self.rows("/plots/sigma_m", "Scalars:scalars"), [])

    def test_negative_stamps_of_the_table_are_kept(self):
        table = self.folder / "negative.txt"
        table.write_text("# stamp\n-0.5 tracked 0 0 0 0.25\n0.5 tracked 0 0 0 0\n")
        self.assertEqual(_rerun._known_sigmas(table), {-(10**9) // 2: 0.25})

    def test_uncertainty_and_status_are_those_of_frames(self):
        lines = table_of(self.run_folder / "frames.txt")
        code = {"lost": 0, "doubtful": 1, "dense": 2, "predicted": 2, "tracked": 2}
        stamps, status = self.rows("/plots/status", "Scalars:scalars")
        self.assertEqual(list(stamps), stamps_ns([line[0] for line in lines]))
        self.assertEqual([value for (value,) in status], [code[line[1]] for line in lines])
        known = [line for line in lines if float(line[5]) > 0]
        stamps, sigma_m = self.rows("/plots/sigma_m", "Scalars:scalars")
        self.assertEqual(list(stamps), stamps_ns([line[0] for line in known]))
        np.testing.assert_allclose([value for (value,) in sigma_m], [float(line[5]) for line in known], atol=1e-6)

    def test_images_have_the_size_of_their_camera_and_stamps_of_the_trajectory(self):
        width, height = self.static(f"{CAMERA}/image", "Pinhole:resolution")[0]
        stamps, colors = self.rows(f"{CAMERA}/image/color", "EncodedImage:blob")
        depth_stamps, depths = self.rows(f"{CAMERA}/image/depth", "EncodedDepthImage:blob")
        self.assertEqual(stamps, depth_stamps)
        located = stamps_ns([line[0] for line in table_of(self.run_folder / "trajectory.txt")])
        self.assertLessEqual(set(stamps), set(located))
        for blob in (*colors, *depths):
            self.assertEqual(Image.open(io.BytesIO(bytes(blob[0]))).size, (width, height))

    def test_depth_images_lie_on_the_cloud(self):
        stamps, depths = self.rows(f"{CAMERA}/image/depth", "EncodedDepthImage:blob")
        depth_m = np.array(Image.open(io.BytesIO(bytes(depths[-1][0]))), float) / 1000
        v, u = np.nonzero(depth_m)
        K = np.array(self.static(f"{CAMERA}/image", "Pinhole:image_from_camera")[0]).reshape(3, 3).T
        pixels = np.stack([u + 0.5, v + 0.5, np.ones(len(u))])  # Rerun counts from the corner of the image
        in_camera = (np.linalg.inv(K) @ pixels * depth_m[v, u]).T
        pose_stamps, translations = self.rows(CAMERA, "Transform3D:translation")
        _, quaternions = self.rows(CAMERA, "Transform3D:quaternion")
        at = pose_stamps.index(stamps[-1])
        in_run = Rotation.from_quat(quaternions[at][0]).apply(in_camera) + translations[at][0]
        in_world = Rotation.from_quat(self.static("/world/run", "Transform3D:quaternion")[0]).apply(in_run)
        distances, _ = KDTree(self.static(CLOUD, "Points3D:positions")).query(in_world[::10])
        self.assertLess(np.median(distances), MAX_MEDIAN_M)

    def test_missing_package_is_named_before_any_work(self):
        programs = self.folder / "programs"
        programs.mkdir()
        stand_in = programs / "python3"  # without any package: -S leaves out those that are installed
        stand_in.write_text(f'#!/bin/sh\nexec "{sys.executable}" -I -S "$@"\n')
        stand_in.chmod(0o755)
        done = subprocess.run([PROGRAM, "export", str(self.run_folder), "--rrd", str(self.folder / "no.rrd")],
                              capture_output=True, text=True, check=False,
                              env={**os.environ, "PATH": f"{programs}:/usr/bin:/bin"})
        self.assertEqual(done.returncode, 3)
        self.assertIn("pip install rerun-sdk", done.stderr)
        self.assertFalse((self.folder / "no.rrd").exists())


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])

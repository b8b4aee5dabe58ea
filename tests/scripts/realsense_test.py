#!/usr/bin/env python3
"""Reads what the RealSense SDK's own recorder wrote of known frames of its software device: .bag, since 2.58 .db3.

Usage: realsense_test.py KINLOOP      skipped (77) without pyrealsense2, which scripts/install_test_packages.sh installs
"""

import subprocess
import sys
import tempfile
import unittest
from importlib.metadata import version
from pathlib import Path

try:
    import numpy as np
    import pyrealsense2 as rs
    from PIL import Image
except ImportError as error:
    print(f"skipped: {error}; see scripts/install_test_packages.sh")
    sys.exit(77)

KINLOOP = sys.argv[1]
EXTENSION = ".db3" if tuple(map(int, version("pyrealsense2").split(".")[:2])) >= (2, 58) else ".bag"
WIDTH, HEIGHT, FRAMES = 96, 72, 5
FOCAL_PX, CENTER_PX, BEGIN_MS, PERIOD_MS = 60.0, (47.5, 35.5), 1_700_000_000_000.0, 1000 / 30
UNIT_M = 0.0005
NEAR_M, FAR_M = 1.5, 3.0
DEPTH_X_M, DEPTH_ANGLE = 0.05, 0.15  # pose of the depth camera in colour: to the right, turned about z, rad


def color(i):
    """RGB noise, which any loss would change."""
    return np.random.default_rng(i).integers(0, 256, (HEIGHT, WIDTH, 3), np.uint8)


def border(i):
    """The column where a near surface ends and a far one begins."""
    return 40 + i


def depth_units(i):
    return np.rint(np.where(np.arange(WIDTH) < border(i), NEAR_M, FAR_M) * np.ones((HEIGHT, 1)) / UNIT_M).astype(np.uint16)


def depth_column(z_m):
    """For each pixel of colour: the column where the depth camera sees a surface at this distance."""
    row, column = np.mgrid[:HEIGHT, :WIDTH]
    x, y = column - CENTER_PX[0] - FOCAL_PX * DEPTH_X_M / z_m, row - CENTER_PX[1]
    return CENTER_PX[0] + np.cos(DEPTH_ANGLE) * x + np.sin(DEPTH_ANGLE) * y


def video_stream(kind, uid, bytes_per_pixel, pixel_format):
    stream = rs.video_stream()
    stream.type, stream.index, stream.uid, stream.fps = kind, 0, uid, 30
    stream.width, stream.height, stream.bpp, stream.fmt = WIDTH, HEIGHT, bytes_per_pixel, pixel_format
    lens = rs.intrinsics()
    lens.width, lens.height, lens.fx, lens.fy, lens.ppx, lens.ppy = WIDTH, HEIGHT, FOCAL_PX, FOCAL_PX, *CENTER_PX
    lens.model, lens.coeffs = rs.distortion.brown_conrady, [0.0] * 5
    stream.intrinsics = lens
    return stream


def send(sensor, profile, pixels, i, delay_ms=0.0):
    frame = rs.software_video_frame()
    frame.pixels, frame.stride, frame.bpp = pixels, pixels.strides[0], pixels.strides[1]
    frame.timestamp, frame.frame_number = BEGIN_MS + i * PERIOD_MS + delay_ms, i
    frame.domain, frame.profile = rs.timestamp_domain.global_time, profile.as_video_stream_profile()
    if profile.stream_type() == rs.stream.depth:
        frame.depth_units = UNIT_M
    sensor.on_video_frame(frame)


def record(path):
    """FRAMES frames as the SDK writes them."""
    device = rs.software_device()
    device.register_info(rs.camera_info.name, "Intel RealSense D435I")
    device.register_info(rs.camera_info.serial_number, "7001")
    sensors = [device.add_sensor(name) for name in ("Stereo Module", "RGB Camera")]
    sensors[0].add_read_only_option(rs.option.depth_units, UNIT_M)
    profiles = [sensors[0].add_video_stream(video_stream(rs.stream.depth, 1, 2, rs.format.z16)),
                sensors[1].add_video_stream(video_stream(rs.stream.color, 2, 3, rs.format.rgb8))]
    pose = rs.extrinsics()
    cos, sin = np.cos(DEPTH_ANGLE), np.sin(DEPTH_ANGLE)
    pose.rotation, pose.translation = [cos, sin, 0, -sin, cos, 0, 0, 0, 1], [DEPTH_X_M, 0, 0]  # columns
    profiles[0].register_extrinsics_to(profiles[1], pose)

    recorder = rs.recorder(str(path), device)
    queue = rs.frame_queue(4 * FRAMES)
    recorded = recorder.query_sensors()
    for sensor, profile in zip(recorded, profiles):
        sensor.open(profile)
        sensor.start(queue)
    for i in range(FRAMES):
        send(sensors[1], profiles[1], color(i), i)
        send(sensors[0], profiles[0], depth_units(i), i, 0.5)
    for _ in range(2 * FRAMES):
        queue.wait_for_frame(5000)
    for sensor in recorded:
        sensor.stop()
        sensor.close()
    recorder.pause()
    del recorder, recorded  # the file is complete when nothing holds the recorder


class Recordings(unittest.TestCase):
    def test_every_frame(self):
        with tempfile.TemporaryDirectory() as folder:
            folder = Path(folder)
            file = folder / f"recording{EXTENSION}"
            record(file)
            done = subprocess.run([KINLOOP, "record", file, "-o", folder / "frames"], capture_output=True,
                                  text=True, check=False)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            rows = {name: [line.split() for line in (folder / "frames" / name).read_text().splitlines() if line[0] != "#"]
                    for name in ("rgb.txt", "depth.txt")}
            self.assertEqual([len(found) for found in rows.values()], [FRAMES, FRAMES])
            for i, ((stamp_s, image), (_, depth)) in enumerate(zip(rows["rgb.txt"], rows["depth.txt"])):
                self.assertAlmostEqual(float(stamp_s) - BEGIN_MS / 1e3, i * PERIOD_MS / 1e3, delta=2e-6)
                np.testing.assert_array_equal(np.asarray(Image.open(folder / "frames" / image)), color(i))
                self.check_depth(np.asarray(Image.open(folder / "frames" / depth)) / 5000, i)

    def check_depth(self, registered_m, i):
        """Away from the image's and the surfaces' borders, colour has the depth that the poses say."""
        inner = np.zeros_like(registered_m, bool)
        inner[12:-12, 12:-12] = True
        near, far = depth_column(NEAR_M) < border(i) - 2, depth_column(FAR_M) > border(i) + 2
        np.testing.assert_allclose(registered_m[inner & near], NEAR_M, atol=1e-3)
        np.testing.assert_allclose(registered_m[inner & far], FAR_M, atol=1e-3)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])

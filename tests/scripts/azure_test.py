#!/usr/bin/env python3
"""Reads what the recorder of the Azure Kinect's SDK wrote of known images: .mkv.

Usage: azure_test.py KINLOOP      skipped (77) without pyk4a-bundle, which scripts/install_test_packages.sh installs

The package brings the SDK's libraries, whose recorder needs no camera. They are called as in k4a.h and k4arecord.h."""

import ctypes
import io
import json
import subprocess
import sys
import tempfile
import unittest
from importlib.metadata import PackageNotFoundError, files
from pathlib import Path

try:
    import numpy as np
    from PIL import Image

    LIBRARIES = sorted(str(file.locate()) for file in files("pyk4a-bundle") if ".libs/lib" in str(file))
except (ImportError, PackageNotFoundError) as error:
    print(f"skipped: {error}; see scripts/install_test_packages.sh")
    sys.exit(77)

KINLOOP = sys.argv[1]
FRAMES, BEGIN_US, PERIOD_US, DEPTH_DELAY_US = 4, 500_000, 33_333, 160
COLOR, DEPTH = (1280, 720), (320, 288)  # width and height: 720P, and NFOV binned
COLOR_FOCAL_PX, COLOR_CENTER_PX = 600.0, (639.5, 359.5)
DEPTH_FOCAL_PX, DEPTH_CENTER_PX = 250.0, (159.5, 143.5)
NEAR_M, FAR_M = 1.5, 3.0
DEPTH_X_M, DEPTH_ANGLE = 0.032, 0.1  # pose of the depth camera in colour: to the right, turned about z, rad
MJPG, NV12, YUY2, DEPTH16, INFRARED16 = 0, 1, 2, 4, 5  # k4a_image_format_t


class Configuration(ctypes.Structure):  # k4a_device_configuration_t
    _fields_ = [("color_format", ctypes.c_int), ("color_resolution", ctypes.c_int), ("depth_mode", ctypes.c_int),
                ("camera_fps", ctypes.c_int), ("synchronized_images_only", ctypes.c_bool),
                ("depth_delay_off_color_usec", ctypes.c_int32), ("wired_sync_mode", ctypes.c_int),
                ("subordinate_delay_off_master_usec", ctypes.c_uint32), ("disable_streaming_indicator", ctypes.c_bool)]


def load(name):
    return ctypes.CDLL(next(file for file in LIBRARIES if name in file), mode=ctypes.RTLD_GLOBAL)


load("libudev")  # the other two need it
K4A, RECORD = load("libk4a-"), load("libk4arecord")
K4A.k4a_image_get_buffer.restype = ctypes.c_void_p


def check(result):
    if result != 0:
        raise RuntimeError(f"the SDK returned {result}")


def border(i):
    """The column of depth where a near surface ends and a far one begins."""
    return 140 + 5 * i


def depth_mm(i):
    return np.where(np.arange(DEPTH[0]) < border(i), 1000 * NEAR_M, 1000 * FAR_M).astype(np.uint16) + np.zeros(
        (DEPTH[1], 1), np.uint16)


def depth_column(z_m):
    """For each pixel of colour: the column where the depth camera sees a surface at this distance."""
    row, column = np.mgrid[:COLOR[1], :COLOR[0]]
    x_m = (column - COLOR_CENTER_PX[0]) / COLOR_FOCAL_PX * z_m - DEPTH_X_M
    y_m = (row - COLOR_CENTER_PX[1]) / COLOR_FOCAL_PX * z_m
    turned_m = np.cos(DEPTH_ANGLE) * x_m + np.sin(DEPTH_ANGLE) * y_m
    return DEPTH_CENTER_PX[0] + DEPTH_FOCAL_PX * turned_m / z_m


def gray(i):
    """A ramp of brightness that moves, without colour, as luminance of 16 to 235."""
    return (16 + (np.arange(COLOR[0]) + 100 * i) % 1280 * 219 // 1279).astype(np.uint8) + np.zeros((COLOR[1], 1), np.uint8)


def jpeg(i):
    noise = np.random.default_rng(i).integers(0, 256, (45, 80, 3), np.uint8)
    data = io.BytesIO()
    Image.fromarray(noise).resize(COLOR, Image.BILINEAR).save(data, "JPEG", quality=90)
    return data.getvalue()


def color_bytes(pixel_format, i):
    if pixel_format == MJPG:
        return jpeg(i)
    if pixel_format == NV12:
        return gray(i).tobytes() + bytes([128]) * (COLOR[0] * COLOR[1] // 2)
    return np.stack([gray(i), np.full_like(gray(i), 128)], axis=-1).tobytes()


def camera(location, scaled, crop, focal_px, center_px, rotation, translation_m):
    """As in the factory's calibration: relative to the whole sensor, from the corner of its first pixel."""
    center = [(c + crop_px + 0.5) / size for c, crop_px, size in zip(center_px, crop, scaled)]
    return {"Location": f"CALIBRATION_CameraLocation{location}",
            "Intrinsics": {"ModelParameterCount": 14, "ModelType": "CALIBRATION_LensDistortionModelBrownConrady",
                           "ModelParameters": center + [focal_px / size for size in scaled] + [0] * 10},
            "Rt": {"Rotation": rotation, "Translation": translation_m}}


def calibration():
    cos, sin = np.cos(DEPTH_ANGLE), np.sin(DEPTH_ANGLE)
    cameras = [camera("D0", (512, 512), (96, 90), DEPTH_FOCAL_PX, DEPTH_CENTER_PX, [1, 0, 0, 0, 1, 0, 0, 0, 1], [0, 0, 0]),
               camera("PV0", (1280, 960), (0, 120), COLOR_FOCAL_PX, COLOR_CENTER_PX,
                      [cos, -sin, 0, sin, cos, 0, 0, 0, 1], [DEPTH_X_M, 0, 0])]
    return json.dumps({"CalibrationInformation": {"Cameras": cameras}}).encode()


def add_image(capture, what, pixel_format, size, pixels, stamp_us):
    """`size` in pixels; the image of a JPEG has the length of its data as stride."""
    image, (width, height) = ctypes.c_void_p(), size
    if pixel_format == MJPG:
        check(K4A.k4a_image_create_from_buffer(pixel_format, width, height, 0, pixels, ctypes.c_size_t(len(pixels)), None,
                                               None, ctypes.byref(image)))
    else:
        stride = 2 * width if pixel_format != NV12 else width
        check(K4A.k4a_image_create(pixel_format, width, height, stride, ctypes.byref(image)))
        ctypes.memmove(K4A.k4a_image_get_buffer(image), pixels, len(pixels))
    K4A.k4a_image_set_device_timestamp_usec(image, ctypes.c_uint64(stamp_us))
    getattr(K4A, f"k4a_capture_set_{what}_image")(capture, image)
    K4A.k4a_image_release(image)


def record(path, pixel_format):
    """FRAMES frames as the SDK writes them."""
    handle, text = ctypes.c_void_p(), calibration()
    configuration = Configuration(pixel_format, 1, 1, 2, True, DEPTH_DELAY_US, 0, 0, False)  # 720P, NFOV binned, 30 Hz
    check(RECORD.k4a_record_create(str(path).encode(), None, configuration, ctypes.byref(handle)))
    check(RECORD.k4a_record_add_attachment(handle, b"calibration.json", text, ctypes.c_size_t(len(text))))
    check(RECORD.k4a_record_write_header(handle))
    for i in range(FRAMES):
        capture, stamp_us, pixels = ctypes.c_void_p(), BEGIN_US + i * PERIOD_US, color_bytes(pixel_format, i)
        check(K4A.k4a_capture_create(ctypes.byref(capture)))
        add_image(capture, "color", pixel_format, COLOR, pixels, stamp_us)
        add_image(capture, "depth", DEPTH16, DEPTH, depth_mm(i).tobytes(), stamp_us + DEPTH_DELAY_US)
        add_image(capture, "ir", INFRARED16, DEPTH, depth_mm(i).tobytes(), stamp_us + DEPTH_DELAY_US)
        check(RECORD.k4a_record_write_capture(handle, capture))
        K4A.k4a_capture_release(capture)
        check(RECORD.k4a_record_flush(handle))
    RECORD.k4a_record_close(handle)


class Recordings(unittest.TestCase):
    def frames_of(self, folder, pixel_format):
        """(stamp of colour, colour file, stamp of depth, depth file) of each frame, stamps in seconds."""
        file, out = Path(folder) / "recording.mkv", Path(folder) / "frames"
        record(file, pixel_format)
        done = subprocess.run([KINLOOP, "record", file, "-o", out], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        rows = [[line.split() for line in (out / name).read_text().splitlines() if line[0] != "#"]
                for name in ("rgb.txt", "depth.txt")]
        self.assertEqual([len(found) for found in rows], [FRAMES, FRAMES])
        return [(float(a), out / color, float(b), out / depth) for (a, color), (b, depth) in zip(*rows)]

    def test_stamps_jpegs_and_registered_depth(self):
        with tempfile.TemporaryDirectory() as folder:
            rows = self.frames_of(folder, MJPG)
            for i, (stamp_s, image, depth_stamp_s, depth) in enumerate(rows):
                self.assertAlmostEqual(stamp_s - rows[0][0], i * PERIOD_US / 1e6, delta=2e-6)
                self.assertAlmostEqual(depth_stamp_s - stamp_s, DEPTH_DELAY_US / 1e6, delta=2e-6)
                self.assertEqual(image.read_bytes(), jpeg(i))
                self.check_depth(np.asarray(Image.open(depth)) / 5000, i)

    def check_depth(self, registered_m, i):
        """Away from the image's and the surfaces' borders, colour has the depth that the poses say."""
        inner = np.zeros_like(registered_m, bool)
        inner[200:-200, 350:-350] = True  # what both cameras see
        near, far = depth_column(NEAR_M) < border(i) - 2, depth_column(FAR_M) > border(i) + 2
        self.assertGreater(min(np.sum(inner & near), np.sum(inner & far)), 20_000)
        np.testing.assert_allclose(registered_m[inner & near], NEAR_M, atol=1e-3)
        np.testing.assert_allclose(registered_m[inner & far], FAR_M, atol=1e-3)

    def test_colour_without_compression(self):
        for pixel_format in (NV12, YUY2):
            with self.subTest(pixel_format), tempfile.TemporaryDirectory() as folder:
                for i, (_, image, _, _) in enumerate(self.frames_of(folder, pixel_format)):
                    expected = (gray(i).astype(float) - 16) * 255 / 219
                    np.testing.assert_allclose(np.asarray(Image.open(image)), expected[..., None] + np.zeros(3), atol=2)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])

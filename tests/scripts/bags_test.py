#!/usr/bin/env python3
"""Exchanges bags with the packages rosbags and mcap: kinloop reads every image of theirs unchanged, and they read ours.

Usage: bags_test.py KINLOOP      skipped (77) without them; scripts/install_test_packages.sh installs them
"""

import io
import json
import struct
import sys
import tempfile
import unittest
from pathlib import Path

from program import kinloop

try:
    import mcap.reader
    import mcap.writer
    import numpy as np
    from PIL import Image
    from rosbags import rosbag1, rosbag2
    from rosbags.highlevel import AnyReader
    from rosbags.typesys import Stores, get_typestore
except ImportError as error:
    print(f"skipped: {error}; see scripts/install_test_packages.sh")
    sys.exit(77)

WIDTH, HEIGHT, FRAMES = 64, 48, 6
BEGIN_NS, PERIOD_NS = 1_700_000_000_000_000_000, 33_333_333
COLOR, DEPTH, INFO = "/camera/color/image_raw", "/camera/aligned_depth_to_color/image_raw", "/camera/color/camera_info"
IMAGE_TYPE, INFO_TYPE = "sensor_msgs/msg/Image", "sensor_msgs/msg/CameraInfo"
FOCAL_PX, CENTER_PX = 60.0, (31.5, 23.5)


def stamp_ns(i):
    return BEGIN_NS + i * PERIOD_NS


def color(i):
    """RGB noise, which any loss would change."""
    return np.random.default_rng(i).integers(0, 256, (HEIGHT, WIDTH, 3), np.uint8)


def depth_mm(i):
    depth = np.random.default_rng(100 + i).integers(500, 5000, (HEIGHT, WIDTH), np.uint16)
    depth[:4] = 0  # no measurement
    return depth


class Messages:
    """The frames as messages of one generation of ROS."""

    def __init__(self, ros):
        self.ros = ros
        self.store = get_typestore(Stores.ROS1_NOETIC if ros == 1 else Stores.ROS2_HUMBLE)

    def make(self, type_name, **fields):
        return self.store.types[type_name](**fields)

    def header(self, i):
        stamp = self.make("builtin_interfaces/msg/Time", sec=stamp_ns(i) // 10**9, nanosec=stamp_ns(i) % 10**9)
        sequence = {"seq": i} if self.ros == 1 else {}
        return self.make("std_msgs/msg/Header", stamp=stamp, frame_id="camera_color_optical_frame", **sequence)

    def image(self, i, pixels, encoding):
        row = pixels.strides[0]
        return self.make(IMAGE_TYPE, header=self.header(i), height=HEIGHT, width=WIDTH, encoding=encoding, is_bigendian=0,
                         step=row, data=np.frombuffer(pixels.tobytes(), np.uint8))

    def info(self, i):
        roi = self.make("sensor_msgs/msg/RegionOfInterest", x_offset=0, y_offset=0, height=0, width=0, do_rectify=False)
        k = np.array([FOCAL_PX, 0, CENTER_PX[0], 0, FOCAL_PX, CENTER_PX[1], 0, 0, 1.0])
        matrices = {"d": np.zeros(5), "k": k, "r": np.eye(3).ravel(), "p": np.insert(k.reshape(3, 3), 3, 0, axis=1).ravel()}
        if self.ros == 1:
            matrices = {name.upper(): values for name, values in matrices.items()}
        return self.make(INFO_TYPE, header=self.header(i), height=HEIGHT, width=WIDTH, distortion_model="plumb_bob",
                         binning_x=0, binning_y=0, roi=roi, **matrices)

    def serialize(self, message):
        of = self.store.serialize_ros1 if self.ros == 1 else self.store.serialize_cdr
        return bytes(of(message, message.__msgtype__))

    def all(self):
        """Tuples of topic, type, stamp and bytes, in order of time."""
        found = []
        for i in range(FRAMES):
            messages = {INFO: self.info(i), COLOR: self.image(i, color(i), "rgb8"), DEPTH: self.image(i, depth_mm(i), "16UC1")}
            found += [(topic, m.__msgtype__, stamp_ns(i), self.serialize(m)) for topic, m in messages.items()]
        return found


def write_with_rosbags(writer, messages):
    with writer:
        connections = {}
        for topic, type_name, stamp, data in messages.all():
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, type_name, typestore=messages.store)
            writer.write(connections[topic], stamp, data)


def write_ros1(path, compression):
    writer = rosbag1.Writer(path)
    if compression:
        writer.set_compression(compression)
    write_with_rosbags(writer, Messages(1))


def write_ros2(path, plugin, compression):
    writer = rosbag2.Writer(path, version=9, storage_plugin=plugin)
    if compression:
        writer.set_compression(compression, rosbag2.CompressionFormat.ZSTD)
    write_with_rosbags(writer, Messages(2))


def write_mcap(path, ros, **options):
    """By the library of the format's authors."""
    messages = Messages(ros)
    profile, encoding, schema = ("ros1", "ros1", "ros1msg") if ros == 1 else ("ros2", "cdr", "ros2msg")
    with open(path, "wb") as file:
        writer = mcap.writer.Writer(file, **options)
        writer.start(profile=profile)
        channels = {}
        for i, (topic, type_name, stamp, data) in enumerate(messages.all()):
            if topic not in channels:
                definition, _ = messages.store.generate_msgdef(type_name, ros_version=ros)
                name = type_name.replace("/msg/", "/") if ros == 1 else type_name
                channels[topic] = writer.register_channel(
                    topic=topic, message_encoding=encoding,
                    schema_id=writer.register_schema(name=name, encoding=schema, data=definition.encode()))
            writer.add_message(channel_id=channels[topic], log_time=stamp, publish_time=stamp, sequence=i, data=data)
        writer.finish()


def rows_of(file):
    return [line.split() for line in file.read_text().splitlines() if line and not line.startswith("#")]


class Reading(unittest.TestCase):
    def check(self, name, write, path):
        with self.subTest(name), tempfile.TemporaryDirectory() as folder:
            folder = Path(folder)
            write(folder / path)
            kinloop("record", folder / path, "-o", folder / "frames")
            self.check_frames(folder / "frames")

    def check_frames(self, folder):
        for list_name, expected in (("rgb.txt", color), ("depth.txt", lambda i: 5 * depth_mm(i))):
            rows = rows_of(folder / list_name)
            self.assertEqual(len(rows), FRAMES, list_name)
            for i, (stamp_s, image) in enumerate(rows):
                self.assertAlmostEqual(float(stamp_s) - BEGIN_NS / 1e9, i * PERIOD_NS / 1e9, delta=2e-6)
                np.testing.assert_array_equal(np.asarray(Image.open(folder / image)), expected(i), err_msg=image)

    def test_ros1_bags(self):
        for compression in (None, *rosbag1.Writer.CompressionFormat):
            self.check(f"rosbag1 {compression}", lambda path, c=compression: write_ros1(path, c), "a.bag")

    def test_ros2_bags(self):
        modes, plugins = rosbag2.CompressionMode, rosbag2.StoragePlugin
        for plugin, mode in ((plugins.SQLITE3, None), (plugins.SQLITE3, modes.MESSAGE), (plugins.MCAP, None),
                             (plugins.MCAP, modes.STORAGE)):
            self.check(f"rosbag2 {plugin} {mode}", lambda path, p=plugin, m=mode: write_ros2(path, p, m), "bag")

    def test_mcap_files(self):
        for compression in mcap.writer.CompressionType:
            for ros in (1, 2):
                self.check(f"mcap {compression} ROS {ros}",
                           lambda path, c=compression, r=ros: write_mcap(path, r, compression=c, chunk_size=20_000), "a.mcap")
        self.check("mcap without chunks", lambda path: write_mcap(path, 2, use_chunking=False), "a.mcap")


def decode_rvl(data):
    """Depth of /kinloop/depth/rvl: width, height, then runs of zeros and differences in groups of three bits."""
    width, height = struct.unpack_from("<II", data)
    words = np.frombuffer(data, np.uint32, offset=8)
    nibbles = [int(word) >> shift & 15 for word in words for shift in range(28, -1, -4)]
    at = 0

    def number():
        nonlocal at
        value, shift = 0, 0
        while True:
            nibble = nibbles[at]
            at += 1
            value |= (nibble & 7) << shift
            shift += 3
            if not nibble & 8:
                return value

    pixels, previous = [], 0
    while len(pixels) < width * height:
        pixels += [0] * number()
        for _ in range(number()):
            code = number()
            previous += (code >> 1) ^ -(code & 1)
            pixels.append(previous)
    return np.array(pixels, np.uint16).reshape(height, width)


class Writing(unittest.TestCase):
    def test_recordings_of_kinloop(self):
        """What `kinloop record` writes, through the type definitions that are in the file."""
        with tempfile.TemporaryDirectory() as folder:
            folder = Path(folder)
            write_ros1(folder / "a.bag", None)
            kinloop("record", folder / "a.bag", "-o", folder / "ours.mcap")
            with AnyReader([folder / "ours.mcap"]) as reader:
                found = {}
                for connection, _, data in reader.messages():
                    found.setdefault(connection.topic, []).append(reader.deserialize(data, connection.msgtype))
            info = found["/kinloop/color/camera_info"][0]
            self.assertEqual((info.width, info.height, info.k[0], info.k[2]), (WIDTH, HEIGHT, FOCAL_PX, CENTER_PX[0]))
            images, depths = found["/kinloop/color/compressed"], found["/kinloop/depth/rvl"]
            self.assertEqual((len(images), len(depths)), (FRAMES, FRAMES))
            for i, (image, depth) in enumerate(zip(images, depths)):
                self.assertEqual(image.header.stamp.sec * 10**9 + image.header.stamp.nanosec, stamp_ns(i))
                np.testing.assert_array_equal(np.asarray(Image.open(io.BytesIO(image.data.tobytes()))), color(i))
                np.testing.assert_array_equal(decode_rvl(depth.data.tobytes()), 5 * depth_mm(i))
            self.check_index(folder / "ours.mcap")

    def check_index(self, path):
        """The summary of an MCAP file counts what its checked chunks hold."""
        with open(path, "rb") as file:
            reader = mcap.reader.make_reader(file, validate_crcs=True)
            statistics = reader.get_summary().statistics
            self.assertEqual(sum(1 for _ in reader.iter_messages()), statistics.message_count)
            self.assertGreater(statistics.message_count, 0)

    def test_exported_maps(self):
        """The JSON messages of `kinloop export --mcap` have the fields that their schemas ask for."""
        with tempfile.TemporaryDirectory() as folder:
            folder = Path(folder)
            kinloop("simulate", "room", "--size", "160x120", "--frames", "12", "-o", folder / "room", "-q")
            kinloop("run", folder / "room", "-o", folder / "out", "-q")
            kinloop("export", folder / "out", "--mcap", folder / "map.mcap", "-q")
            self.check_index(folder / "map.mcap")
            topics = set()
            with open(folder / "map.mcap", "rb") as file:
                for schema, channel, message in mcap.reader.make_reader(file).iter_messages():
                    topics.add(channel.topic)
                    self.assertEqual((channel.message_encoding, schema.encoding), ("json", "jsonschema"))
                    fields, properties = json.loads(message.data), json.loads(schema.data)["properties"]
                    self.assertLessEqual(fields.keys(), properties.keys(), schema.name)
            self.assertGreaterEqual(len(topics), 3)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])

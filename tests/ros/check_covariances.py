#!/usr/bin/env python3
"""Compares what the node published with the poses and covariances of `kinloop run --poses-to` on the same frames.

  check_covariances.py BAG POSES
"""
import json
import sys

import numpy
import rosbag


def rotation(x, y, z, w):
    return numpy.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])


def expected_covariance(line):
    """In the axes of the map, row by row, as geometry_msgs/PoseWithCovariance has it."""
    camera = numpy.zeros((6, 6))
    camera[numpy.triu_indices(6)] = line["covariance"]
    camera += numpy.triu(camera, 1).T
    to_map = numpy.kron(numpy.eye(2), rotation(*line["T_map_camera"]["quaternion"]))
    return (to_map @ camera @ to_map.T).ravel()


bag, poses = sys.argv[1:]
lines = {line["stamp_ns"]: line for line in map(json.loads, open(poses))}
published = {"/kinloop/pose": 0, "/kinloop/pose_with_covariance": 0}
for topic, message, _ in rosbag.Bag(bag).read_messages():
    published[topic] += 1
    line = lines[message.header.stamp.to_nsec()]
    assert message.header.frame_id == "map"
    if topic == "/kinloop/pose":
        continue
    position = message.pose.pose.position
    numpy.testing.assert_allclose([position.x, position.y, position.z], line["T_map_camera"]["translation"])
    numpy.testing.assert_allclose(message.pose.covariance, expected_covariance(line), rtol=1e-6, atol=1e-12)
known = sum(line["covariance"] is not None and line["status"] != "doubtful" for line in lines.values())
assert published["/kinloop/pose"] == len(lines), published
assert 0 < published["/kinloop/pose_with_covariance"] == known, published
print(f"covariances in the axes of the map: the same for {known} of {len(lines)} poses")

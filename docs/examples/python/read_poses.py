#!/usr/bin/env python3
"""Prints the poses that kinloop sends while it runs; docs/protocol.md describes the lines.

  kinloop run kinect2 -o out --poses-to - | read_poses.py -
  read_poses.py /tmp/poses.sock              with: kinloop run kinect2 -o out --poses-to unix:/tmp/poses.sock
"""
import json
import socket
import sys
import time


def lines_of(source):
    if source == "-":
        return sys.stdin
    connection = socket.socket(socket.AF_UNIX)
    while connection.connect_ex(source) != 0:  # kinloop creates the socket before its first frame
        time.sleep(0.01)
    return connection.makefile()


if len(sys.argv) != 2:
    sys.exit(__doc__)
for line in lines_of(sys.argv[1]):
    frame = json.loads(line)
    if frame["status"] in ("lost", "doubtful"):
        print(frame["stamp_ns"], frame["status"])
        continue
    x, y, z = frame["T_map_camera"]["translation"]
    sigma = "unknown" if frame["sigma_m"] is None else f"{frame['sigma_m']:.4f} m"
    print(f"{frame['stamp_ns']} {frame['status']} at {x:.3f} {y:.3f} {z:.3f} m, sigma {sigma}", flush=True)

#!/usr/bin/env python3
"""A loop over your own camera: NumPy arrays in, poses out; writes trajectory.txt, in TUM format.

  live_loop.py [RECORDING]               a recording stands in for the camera (default: sim:room)

Replace `images` with the driver of your camera. Colour is uint8 (H, W, 3), red first; depth is uint16 with a known number
of units per metre, or float32 in metres.
"""
import sys
import time

import numpy as np

import kinloop

source = kinloop.open(sys.argv[1] if len(sys.argv) > 1 else "sim:room")


def images():
    for frame in source:
        yield frame.stamp_s, frame.rgb, np.round(1000 * frame.depth_m).astype(np.uint16)


camera = source.camera  # or kinloop.Camera(width=640, height=480, fx=525, ...)
slam = kinloop.Slam(camera, executor={"mode": "live"})  # corrections are applied when they are ready
times_s = []
for stamp_s, rgb, depth in images():
    start = time.perf_counter()
    T_world_camera = slam.process(stamp_s, rgb, depth, depth_scale=1000)
    times_s.append(time.perf_counter() - start)
    if T_world_camera is None:
        print(f"{stamp_s:.3f} lost: show the camera what it has seen before")

result = slam.finish()
result.trajectory.save("trajectory.txt")
print(f"{result}, {1e3 * np.median(times_s):.1f} ms per frame")

#!/usr/bin/env python3
"""Sends a folder in TUM layout to kinloop, as a camera would; docs/protocol.md describes the format.

  stream_frames.py FOLDER [--live] | kinloop run - -o out

FOLDER holds camera.yaml too, and maybe masks/. --live: frames that come too fast are dropped, as with a camera.
"""
import json
import pathlib
import struct
import sys


def read_list(path):
    rows = (line.split() for line in path.read_text().splitlines() if line and line[0] != "#")
    return sorted((round(float(stamp) * 1e6) * 1000, name) for stamp, name in rows)


def send(header, *images):
    text = json.dumps(header).encode()
    sys.stdout.buffer.write(struct.pack("<I", len(text)) + text + b"".join(images))
    sys.stdout.buffer.flush()


if len(sys.argv) < 2:
    sys.exit(__doc__)
folder = pathlib.Path(sys.argv[1])
send({"kinloop": 1, "live": "--live" in sys.argv, "camera": (folder / "camera.yaml").read_text()})
depths = read_list(folder / "depth.txt")
for stamp_ns, name in read_list(folder / "rgb.txt"):
    depth_ns, depth_name = min(depths, key=lambda depth: abs(depth[0] - stamp_ns))
    if abs(depth_ns - stamp_ns) > 20_000_000:
        continue
    color, depth = (folder / name).read_bytes(), (folder / depth_name).read_bytes()
    kind = "png" if color.startswith(b"\x89PNG") else "jpeg"
    header = {"stamp_ns": stamp_ns, "depth_stamp_ns": depth_ns, "color": {"encoding": kind, "bytes": len(color)},
              "depth": {"encoding": "png", "bytes": len(depth)}}
    mask = folder / "masks" / pathlib.Path(name).with_suffix(".png").name
    images = [color, depth] + ([mask.read_bytes()] if mask.exists() else [])
    if mask.exists():
        header["mask"] = {"encoding": "png", "bytes": len(images[-1])}
    send(header, *images)

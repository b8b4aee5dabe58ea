#!/usr/bin/env python3
"""Maps a recording: trajectory, coloured cloud and map file.

  map_a_folder.py RECORDING [OUT]        RECORDING: whatever kinloop run takes, for example sim:room
"""
import sys

import kinloop

if len(sys.argv) < 2:
    sys.exit(__doc__)
recording = sys.argv[1]
out = sys.argv[2] if len(sys.argv) > 2 else "out"

source = kinloop.open(recording)
slam = kinloop.Slam(source.camera)
for frame in source:
    pose = slam.process(frame)
    where = "lost" if pose is None else "{:6.2f} {:6.2f} {:6.2f} m".format(*pose[:3, 3])
    print(f"\rframe {frame.index}: {where}   {slam.keyframes} keyframes", end="", file=sys.stderr)

result = slam.finish()
result.save(out)
print(f"\n{result}\n{result.cloud}\nwritten: {out}")

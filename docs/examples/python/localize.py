#!/usr/bin/env python3
"""Locates a camera in a map of an earlier run, without changing the map; writes located.txt, in TUM format.

  localize.py MAP RECORDING              MAP: a map file, or the folder of a run
"""
import sys

import kinloop

if len(sys.argv) != 3:
    sys.exit(__doc__)
map_file, recording = sys.argv[1:]

source = kinloop.open(recording)
slam = kinloop.Slam(source.camera, load_map=map_file, localize=True)
located = [slam.process(frame) is not None for frame in source]
slam.finish().trajectory.save("located.txt")
print(f"{sum(located)} of {len(located)} frames located, poses in the world of {map_file} in located.txt")

#!/usr/bin/env python3
"""Localises a recording in the map of an earlier run, without changing the map.

  localize.py MAP RECORDING              MAP: a map file, or the folder of a run
"""
import sys

import kinloop

map_file, recording = sys.argv[1:]
source = kinloop.open(recording)
slam = kinloop.Slam(source.camera, load_map=map_file, localize=True)
located = [pose is not None for pose in map(slam.process, source)]
slam.finish().trajectory.save("located.txt")
print(f"{sum(located)} of {len(located)} frames located, poses in the world of {map_file} in located.txt")

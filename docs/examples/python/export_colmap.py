#!/usr/bin/env python3
"""Writes a map as a COLMAP model, so that Gaussian splatting can start without running COLMAP for hours.

  export_colmap.py MAP FOLDER            MAP: a map file, or the folder of a run

Train, for example:  gsplat: simple_trainer.py default --data_dir FOLDER    nerfstudio: ns-train splatfacto colmap --data FOLDER
"""
import sys

import kinloop

if len(sys.argv) != 3:
    sys.exit(__doc__)
map_file, folder = sys.argv[1:]

loaded = kinloop.Map.load(map_file)
loaded.export_colmap(folder)
print(f"{loaded}, {len(loaded.landmarks)} points: {folder}")

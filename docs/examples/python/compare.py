#!/usr/bin/env python3
"""Compares trajectories of one recording with ground truth: kinloop's and those of other programs.

  compare.py TRUTH.txt ESTIMATE.txt...   files in TUM format
"""
import pathlib
import sys

import kinloop

if len(sys.argv) < 3:
    sys.exit(__doc__)
truth, *estimates = sys.argv[1:]
print(f"{'':24} {'ATE m':>8} {'max m':>8} {'RPE m/s':>8} {'deg/s':>8} {'covered':>8}")
for path in estimates:
    try:
        e = kinloop.evaluate(path, truth)
    except kinloop.InputError as error:
        print(f"{pathlib.Path(path).stem:24} {error}")
        continue
    drift = (e.rpe_second.translation_m.rmse, e.rpe_second.rotation_deg.rmse) if e.rpe_second else (float("nan"),) * 2
    print(f"{pathlib.Path(path).stem:24} {e.ate_m.rmse:8.4f} {e.ate_m.max:8.4f} {drift[0]:8.4f} {drift[1]:8.3f} "
          f"{100 * e.coverage:6.1f} %")

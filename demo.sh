#!/usr/bin/env bash
# Maps a room: installs what is missing, builds kinloop and runs it on the built-in simulated Kinect, or on a sequence.
# Usage: ./demo.sh [SEQUENCE]     e.g. ./demo.sh ~/data/rgbd_dataset_freiburg1_room; the result lies in out/demo
set -euo pipefail

if [[ $# -gt 1 || "${1:-}" == -* ]]; then
  echo "usage: $0 [SEQUENCE]" >&2
  exit 2
fi
sequence="${1:-sim:room}"
if [[ -e "$sequence" ]]; then sequence="$(realpath "$sequence")"; fi
cd "$(dirname "${BASH_SOURCE[0]}")"
out="out/demo"

echo "== Packages"
scripts/install_dependencies.sh

echo "== Build (the first time takes a few minutes)"
cmake --preset release -DKINLOOP_TESTS=OFF -DKINLOOP_BENCH=OFF
cmake --build --preset release --target kinloop

echo "== Mapping $sequence"
build/release/apps/kinloop run "$sequence" -o "$out"

if [[ -f "$sequence/groundtruth.txt" ]]; then
  echo "== Error against the ground truth"
  build/release/apps/kinloop eval "$out/trajectory.txt" "$sequence/groundtruth.txt"
fi

echo
echo "Trajectory  $PWD/$out/trajectory.txt"
echo "Map         $PWD/$out/map.ply (MeshLab and CloudCompare open it)"
echo "Report      $PWD/$out/report.html"

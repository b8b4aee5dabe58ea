#!/usr/bin/env bash
# Maps a room: installs missing packages, builds kinloop and runs it on the built-in simulated Kinect, or on a
# sequence.
# Usage: ./demo.sh [--minimal] [SEQUENCE]     --minimal leaves all optional parts out
# e.g. ./demo.sh ~/data/rgbd_dataset_freiburg1_room; the results are in out/demo
set -euo pipefail

minimal=()
if [[ "${1:-}" == --minimal ]]; then
  minimal=(--minimal)
  shift
fi
if [[ $# -gt 1 || "${1:-}" == -* ]]; then
  echo "usage: $0 [--minimal] [SEQUENCE]" >&2
  exit 2
fi
sequence="${1:-sim:room}"
if [[ -e "$sequence" ]]; then sequence="$(realpath "$sequence")"; fi
cd "$(dirname "${BASH_SOURCE[0]}")"
out="out/demo"
kinloop="build/release/apps/kinloop"
jobs="$(scripts/build_jobs.sh)"

build_cpu_minutes=10  # measured with gcc 12, without tests
if [[ -x "$kinloop" ]]; then
  build_time="only what has changed"
else
  build_time="about $((build_cpu_minutes / jobs)) minutes the first time ($jobs compilers at once, as cores and memory allow)"
fi
cat <<TEXT
This maps $sequence in three steps:
  1. packages   installs what is missing with apt; at most 200 packages, 1 to 5 minutes on a fresh machine
  2. build      compiles kinloop: $build_time
  3. map        writes trajectory, 3D map and report to $PWD/$out

TEXT

echo "== 1. Packages"
scripts/install_dependencies.sh "${minimal[@]:---program}"

echo
echo "== 2. Build"
cmake --preset release -DKINLOOP_TESTS=OFF -DKINLOOP_BENCH=OFF -DKINLOOP_EXAMPLES=OFF \
  -DKINLOOP_MINIMAL="$([[ ${#minimal[@]} -gt 0 ]] && echo ON || echo OFF)" --log-level=WARNING
NINJA_STATUS="[%p, %f of %t, %e s] " cmake --build --preset release --target kinloop_program --parallel "$jobs"

echo
echo "== 3. Map $sequence"
"$kinloop" run "$sequence" -o "$out"

if [[ -f "$sequence/groundtruth.txt" ]]; then
  echo
  echo "== Error against the ground truth"
  "$kinloop" eval "$out/trajectory.txt" "$sequence/groundtruth.txt"
fi

echo
echo "== This build"
scripts/print_parts.sh
cat <<TEXT

Trajectory  $PWD/$out/trajectory.txt
3D map      $PWD/$out/map.ply (opens in MeshLab, CloudCompare, or: $kinloop view $out)
Report      $PWD/$out/report.html
TEXT

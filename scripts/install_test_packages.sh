#!/usr/bin/env bash
# Installs what some tests compare kinloop with and no distribution packages, from the Python package index, into the
# virtual environment build/test_packages. Nothing else uses it. Without it, or without a network, these tests are
# skipped and say so.
# Usage: scripts/install_test_packages.sh
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

packages=(
  evo==1.38.1                             # kinloop eval: tests/scripts/evo_test.py
  "g2opy==2.3.0; python_version>='3.11'"  # kinloop optimize: tests/scripts/g2o_test.py
  rosbags==0.11.9 mcap==1.6.0             # bags and .mcap files: tests/scripts/bags_test.py
  pycolmap==4.2.1                         # kinloop export --colmap: tests/scripts/colmap_test.py
  "open3d-cpu==0.20.0; platform_machine=='x86_64'" # clouds, meshes, posed images: tests/scripts/open3d_test.py
  rerun-sdk==0.41.0                       # kinloop export --rrd: tests/scripts/rerun_test.py
  "usd-core==26.11; python_version>='3.11' and platform_machine=='x86_64'" # meshes as .usda, .usdz: tests/scripts/usd_test.py
  dask==2026.8.0 distributed==2026.8.0    # workers of kinloop batch: tests/batch/dask_test.py
  "pyarrow==26.0.1; python_version>='3.11'" # its Parquet: the same
  clang-tidy==23.1.4                      # .ci/tidy.py
  pyrealsense2==2.59.1.11053              # .db3 files of RealSense cameras: tests/scripts/realsense_test.py
  "pyk4a-bundle==1.5.0; python_version=='3.11' and platform_machine=='x86_64'" # .mkv of an Azure Kinect: tests/scripts/azure_test.py
)
realsense_bag=pyrealsense2==2.57.7.10387  # the last one that writes .bag files
environment="build/test_packages"
stamp="$environment/installed"

if [[ "$(cat "$stamp" 2>/dev/null)" == "${packages[*]} $realsense_bag" ]]; then exit 0; fi
rm -rf "$environment"
mkdir -p build
echo "Installing for tests: ${packages[*]}"
if python3 -m venv "$environment" 2>/dev/null && "$environment/bin/pip" install -q "${packages[@]}" 2>"$environment/log" &&
  "$environment/bin/pip" install -q --no-deps --target "$environment/realsense_bag" "$realsense_bag" 2>>"$environment/log"; then
  echo "${packages[*]} $realsense_bag" >"$stamp"
else
  echo "The packages for tests could not be installed (no network, or no python3-venv); these tests will be skipped." >&2
  exit 1
fi

#!/usr/bin/env bash
# Installs what some tests need and no distribution packages, from the Python package index, into virtual environments:
# build/test_packages has what kinloop is compared with, build/numpy_1 and build/numpy_2 the two NumPys that the Python
# package is tested with. Nothing else uses them. Without them, or without a network, these tests are skipped and say so.
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
# The Python package's module is built for the distribution's Python, if there is one.
module_python=/usr/bin/python3
if [[ ! -x "$module_python" ]]; then module_python=python3; fi

# install_environment FOLDER PYTHON PACKAGE...: a virtual environment with these packages, unless it is there.
install_environment() {
  local folder="$1" python="$2"
  shift 2
  if [[ "$(cat "$folder/installed" 2>/dev/null)" == "$*" ]]; then return 0; fi
  echo "Installing for tests into $folder: $*"
  rm -rf "$folder"
  "$python" -m venv "$folder" 2>/dev/null && "$folder/bin/pip" install -q "$@" 2>"$folder/log" && echo "$*" >"$folder/installed"
}

install_realsense_bag() {
  local folder=build/test_packages/realsense_bag
  if [[ "$(cat "$folder/installed" 2>/dev/null)" == "$realsense_bag" ]]; then return 0; fi
  rm -rf "$folder"
  build/test_packages/bin/pip install -q --no-deps --target "$folder" "$realsense_bag" 2>>build/test_packages/log &&
    echo "$realsense_bag" >"$folder/installed"
}

mkdir -p build
all=true
{ install_environment build/test_packages python3 "${packages[@]}" && install_realsense_bag; } || all=false
install_environment build/numpy_1 "$module_python" numpy==1.26.4 pytest==9.2.0 || all=false
install_environment build/numpy_2 "$module_python" "numpy==2.4.6; python_version>='3.11'" \
  "numpy==2.2.6; python_version<'3.11'" pytest==9.2.0 || all=false
if ! $all; then
  echo "Not all packages for tests could be installed (no network, or no python3-venv); tests that need them are skipped." >&2
  exit 1
fi

#!/usr/bin/env bash
# Installs what kinloop is built from: packages of Debian 12 or Ubuntu 22.04 and newer, only those that are missing.
# Usage: scripts/install_dependencies.sh [--tests | --checks]
#   --tests    also a browser for the tests of the pages
#   --checks   and the tools of the format and tidy checks
set -euo pipefail

packages=(
  build-essential cmake ninja-build ccache git pkg-config
  libopencv-dev libeigen3-dev libceres-dev libsuitesparse-dev libhwy-dev
  libturbojpeg0-dev libdeflate-dev libsqlite3-dev
  libyaml-cpp-dev libcli11-dev libspdlog-dev libfmt-dev nlohmann-json3-dev
  libgtest-dev libgmock-dev libbenchmark-dev libboost-dev
)
# Parts that are found when present: SURF, meshes, occupancy maps, ChArUco boards, Kinect 1, downloads, training on many
# machines, ROS bags and topics. (libfreenect2, for the Kinect 2, is in neither distribution: docs/cameras.md.) What a
# distribution does not have is left out.
optional=(
  libdlib-dev libopenvdb-dev liboctomap-dev libopencv-contrib-dev
  libfreenect-dev libcurl4-openssl-dev libarchive-dev
  libopenmpi-dev openmpi-bin
  librosbag-storage-dev libsensor-msgs-dev
  libroscpp-dev libtf2-msgs-dev libnav-msgs-dev libgeometry-msgs-dev
  python3-roslaunch python3-rosbag
)
# The viewer and report pages; npm may also have come with a Node.js from elsewhere.
command -v npm >/dev/null || packages+=(nodejs npm)
case "${1:-}" in
  "") ;;
  --tests) optional+=(chromium) ;;  # Ubuntu has it as a snap alone: the tests that need it skip there
  --checks)
    optional+=(chromium)
    packages+=(clang-format clang-tidy)
    ;;
  *)
    echo "usage: $0 [--tests | --checks]" >&2
    exit 2
    ;;
esac

if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
  echo "This script knows Debian and Ubuntu (apt). Elsewhere, install the counterparts of: ${packages[*]}" >&2
  exit 3
fi

is_installed() {
  [[ "$(dpkg-query -W -f '${db:Status-Status}' "$1" 2>/dev/null)" == "installed" ]]
}

as_root() {
  if [[ $EUID -eq 0 ]]; then
    "$@"
  elif command -v sudo >/dev/null; then
    sudo "$@"
  else
    echo "Not root and no sudo. As root, run: $*" >&2
    exit 3
  fi
}

missing=()
for package in "${packages[@]}"; do
  is_installed "$package" || missing+=("$package")
done
wanted=()
for package in "${optional[@]}"; do
  is_installed "$package" || wanted+=("$package")
done
# A new machine may know no package at all; one that knows cmake has had its lists before.
if [[ ${#missing[@]} -gt 0 ]] || ! apt-cache show cmake >/dev/null 2>&1; then as_root apt-get update -q; fi
for package in "${wanted[@]}"; do
  if [[ "$(LC_ALL=C apt-cache policy "$package" 2>/dev/null)" =~ Candidate:\ [0-9] ]]; then missing+=("$package"); fi
done
if [[ ${#missing[@]} -eq 0 ]]; then
  echo "All packages are installed."
  exit 0
fi

echo "Installing: ${missing[*]}"
as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends "${missing[@]}" </dev/null

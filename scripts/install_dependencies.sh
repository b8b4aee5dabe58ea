#!/usr/bin/env bash
# Installs kinloop's build dependencies: packages of Debian 12 or Ubuntu 22.04 and newer, only those that are
# missing.
# Usage: scripts/install_dependencies.sh [--minimal] [--tests | --checks | --packages]
#   --minimal  required packages only
#   --tests    also a browser for the tests of the pages, and what those of the scripts need
#   --checks   and the tools of the format, tidy and documentation checks
#   --packages what scripts/build_packages.sh and scripts/build_portable.sh need
set -euo pipefail

required=(
  build-essential cmake ninja-build ccache git pkg-config
  libopencv-dev libeigen3-dev libceres-dev libsuitesparse-dev libhwy-dev
  libturbojpeg0-dev libdeflate-dev libpng-dev libtiff-dev libopenexr-dev libsqlite3-dev liblz4-dev libzstd-dev libbz2-dev
  libyaml-cpp-dev libcli11-dev libspdlog-dev libfmt-dev nlohmann-json3-dev
  libgtest-dev libgmock-dev libbenchmark-dev libboost-dev
)
# Optional parts, named as in `kinloop --version`, with their packages. A part whose packages the distribution
# does not have is left out.
optional=(
  "SURF: libdlib-dev"
  "meshes: libopenvdb-dev"
  "occupancy maps: liboctomap-dev"
  "simplified meshes: libcgal-dev"
  "ChArUco boards: libopencv-contrib-dev"
  "Kinect 1: libfreenect-dev"
  "OpenNI2: libopenni2-dev"
  "downloads: libcurl4-openssl-dev libarchive-dev"
  "distributed training: libopenmpi-dev openmpi-bin"
  "sources of g2o: python3-venv"
  "kinloop batch: python3-yaml"
  "Python: python3-dev python3-numpy python3-pytest python3-venv"
  "video: libavformat-dev libavcodec-dev libswscale-dev"
  "ROS node: librosbag-storage-dev libsensor-msgs-dev libroscpp-dev libtf2-msgs-dev libnav-msgs-dev libgeometry-msgs-dev python3-roslaunch python3-rosbag"
)
# npm may also come with a Node.js from elsewhere.
if command -v npm >/dev/null; then
  optional+=("viewer and report pages:")
else
  optional+=("viewer and report pages: nodejs npm")
fi
# Ubuntu has chromium only as a snap: the tests that need it are skipped there.
minimal=false
for argument in "$@"; do
  case "$argument" in
    --minimal) minimal=true ;;
    --tests) optional+=("tests of the pages: chromium" "tests of the scripts: python3-numpy python3-pil") ;;
    --checks)
      optional+=("tests of the pages: chromium" "tests of the scripts: python3-numpy python3-pil")
      optional+=("fuzzing: clang libclang-rt-dev")
      required+=(clang-format clang-tidy doxygen python3 mkdocs mkdocs-material python3-pymdownx)
      ;;
    --packages) required+=(file lintian python3 zstd) ;;
    *)
      echo "usage: $0 [--minimal] [--tests | --checks | --packages]" >&2
      exit 2
      ;;
  esac
done
if $minimal; then optional=(); fi

if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
  echo "This script needs apt (Debian, Ubuntu). On other systems, install the counterparts of: ${required[*]}" >&2
  exit 3
fi

is_installed() {
  [[ "$(dpkg-query -W -f '${db:Status-Status}' "$1" 2>/dev/null)" == "installed" ]]
}

is_available() {
  # No pipe into grep -q: it closes the pipe early, apt-cache dies of SIGPIPE, and pipefail turns that into a
  # "no".
  [[ "$(LC_ALL=C apt-cache policy "$1" 2>/dev/null)" =~ Candidate:\ [0-9] ]]
}

missing_of() {  # missing_of PACKAGE...
  local package
  for package in "$@"; do
    is_installed "$package" || echo "$package"
  done
}

may_install() {
  [[ $EUID -eq 0 ]] || command -v sudo >/dev/null
}

as_root() {
  if [[ $EUID -eq 0 ]]; then "$@"; else sudo "$@"; fi
}

install() {  # install PACKAGE...
  echo "Installing: $*"
  as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends "$@" </dev/null
}

# "installed", or why a part is not.
state_of() {  # state_of PACKAGE...
  local package
  for package in "$@"; do
    is_installed "$package" && continue
    if ! is_available "$package"; then
      echo "off: $package is not in this distribution"
    elif ! may_install; then
      echo "off: $package is missing; as root: apt-get install $*"
    else
      echo "off: $package could not be installed"
    fi
    return
  done
  echo "installed"
}

print_table() {
  local part
  echo
  if $minimal; then
    echo "Optional parts: left out, as --minimal asks"
    return
  fi
  echo "Optional parts"
  for part in "${optional[@]}"; do
    # shellcheck disable=SC2046,SC2086  # a list of packages
    printf '  %-26s %s\n' "${part%%:*}" "$(state_of ${part#*:})"
  done
  printf '  %-26s %s\n' "Kinect 2" "built where libfreenect2 is; no distribution packages it: see docs/cameras.md" \
    "g2o solver" "$g2o_state"
}

mapfile -t missing < <(missing_of "${required[@]}")
wanted=()
for part in "${optional[@]}"; do
  # shellcheck disable=SC2086  # a list of packages
  mapfile -t -O "${#wanted[@]}" wanted < <(missing_of ${part#*:})
done

if [[ ${#missing[@]} -gt 0 ]] && ! may_install; then
  echo "Not root and no sudo. As root, run: apt-get install ${missing[*]}" >&2
  exit 3
fi
# A fresh machine may have no package lists; one that knows cmake has them.
if may_install && { [[ ${#missing[@]} -gt 0 ]] || ! is_available cmake; }; then as_root apt-get update -q; fi

available=()
for package in "${wanted[@]}"; do
  if is_available "$package"; then available+=("$package"); fi
done

if may_install && [[ $((${#missing[@]} + ${#available[@]})) -gt 0 ]]; then
  if ! install "${missing[@]}" "${available[@]}"; then
    # A failing optional package must not block the others.
    if [[ ${#missing[@]} -gt 0 ]]; then install "${missing[@]}"; fi
    for package in "${available[@]}"; do install "$package" || true; done
  fi
fi
# No distribution packages g2o, and none a pybind11 that knows NumPy 2; the Python package index has both.
g2o_state="left out"
if ! $minimal; then
  g2o_state="installed (sources in build/g2o)"
  "$(dirname "${BASH_SOURCE[0]}")/install_g2o.sh" || g2o_state="off: its sources could not be fetched (see above); nothing depends on it: docs/method.md"
  "$(dirname "${BASH_SOURCE[0]}")/install_pybind11.sh" || true  # the Python package is off; `kinloop --version` says so
fi
print_table

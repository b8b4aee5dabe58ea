#!/usr/bin/env bash
# Installs kinloop's build dependencies: packages of Debian 12 or Ubuntu 22.04 and newer, only those that are
# missing.
# Usage: scripts/install_dependencies.sh [--minimal | --program] [--with PART]... [--tests | --checks | --packages]
#   --minimal  required packages only
#   --program  what it takes to map a room and look at it: the required packages, and the parts that need few others
#   --with PART  and this part, named as in `kinloop --version`
#   --tests    also a browser for the tests of the pages, and what those of the scripts need
#   --checks   and the tools of the format, tidy and documentation checks
#   --packages what scripts/build_packages.sh, build_portable.sh and build_source_archive.sh need
set -euo pipefail
scripts="$(dirname "${BASH_SOURCE[0]}")"

required=(
  g++ cmake ninja-build
  libeigen3-dev libceres-dev libsuitesparse-dev libhwy-dev
  libturbojpeg0-dev libdeflate-dev libpng-dev libtiff-dev libopenexr-dev libsqlite3-dev liblz4-dev libzstd-dev libbz2-dev
  libyaml-cpp-dev libcli11-dev libspdlog-dev libfmt-dev nlohmann-json3-dev libboost-dev
)
# To change kinloop: for tests, benchmarks and packages, and to build again faster.
development=(libopencv-dev git ccache libgtest-dev libgmock-dev libbenchmark-dev)
# Optional parts, named as in `kinloop --version`, with their packages. A part whose packages the distribution
# does not have is left out.
optional=(
  "viewer and report pages: nodejs ca-certificates"
  "Kinect 1: libfreenect-dev"
  "OpenNI2: libopenni2-dev"
  "meshes: libopenvdb-dev"
  "occupancy maps: liboctomap-dev"
  "archives: libarchive-dev"
  "WebP images: libwebp-dev"
  "downloads: libcurl4-openssl-dev libarchive-dev"
  "SURF: libdlib-dev"
  "simplified meshes: libcgal-dev"
  "ChArUco boards: libopencv-dev libopencv-contrib-dev"
  "distributed training: libopenmpi-dev openmpi-bin"
  "g2o solver: python3-venv"
  "kinloop batch: python3-yaml"
  "Python: python3-dev python3-numpy python3-pytest python3-venv"
  "video: libavformat-dev libavcodec-dev libswscale-dev"
  "ROS node: pkg-config librosbag-storage-dev libsensor-msgs-dev libroscpp-dev libtf2-msgs-dev libnav-msgs-dev libgeometry-msgs-dev python3-roslaunch python3-rosbag"
)
program_parts=8  # the first ones; together with the required packages less than 200 on an empty Debian 12

fail_usage() {
  echo "$1" >&2
  sed -n 's/^# Usage: /usage: /p' "${BASH_SOURCE[0]}" >&2
  exit 2
}

names_of() { printf '%s\n' "${@%%:*}"; }  # names_of ROW...

selection=all
develops=false
added=()
more=()
while [[ $# -gt 0 ]]; do
  case "$1" in
    --minimal | --program) selection="${1#--}" ;;
    --with)
      names_of "${optional[@]}" | grep -qxF -- "${2:-}" ||
        fail_usage "--with: no part '${2:-}'; parts: $(names_of "${optional[@]}" | paste -s -d, | sed 's/,/, /g')"
      added+=("$2")
      shift
      ;;
    # Ubuntu has chromium only as a snap: the tests that need it are skipped there.
    --tests)
      develops=true
      more+=("tests of the pages: chromium" "tests of the scripts: python3-numpy python3-pil")
      ;;
    --checks)
      develops=true
      more+=("tests of the pages: chromium" "tests of the scripts: python3-numpy python3-pil" "fuzzing: clang libclang-rt-dev")
      required+=(clang-format clang-tidy doxygen python3 mkdocs mkdocs-material python3-pymdownx)
      ;;
    --packages)
      develops=true
      required+=(dpkg-dev file lintian python3 zstd)
      ;;
    *) fail_usage "$1?" ;;
  esac
  shift
done

is_wanted() {  # is_wanted PART
  printf '%s\n' "${wanted_parts[@]}" | grep -qxF -- "$1"
}
case "$selection" in
  all) mapfile -t wanted_parts < <(names_of "${optional[@]}") ;;
  program) mapfile -t wanted_parts < <(names_of "${optional[@]::program_parts}") ;;
  minimal) wanted_parts=() ;;
esac
wanted_parts+=("${added[@]}")
if [[ ${#more[@]} -gt 0 ]]; then mapfile -t -O "${#wanted_parts[@]}" wanted_parts < <(names_of "${more[@]}"); fi
optional+=("${more[@]}")
if [[ "$selection" == all ]] || $develops; then required+=("${development[@]}"); fi
# npm may also come with a Node.js from elsewhere.
if command -v npm >/dev/null; then optional[0]="viewer and report pages:"; fi

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
  local part name state
  echo
  echo "Optional parts"
  for part in "${optional[@]}"; do
    name="${part%%:*}"
    if ! is_wanted "$name"; then
      printf '  %-26s %s\n' "$name" "left out; add it: scripts/install_dependencies.sh --program --with '$name'"
    else
      # shellcheck disable=SC2086  # a list of packages
      state="$(state_of ${part#*:})"
      if [[ "$state" == installed ]]; then state="${fetched[$name]:-installed}"; fi
      printf '  %-26s %s\n' "$name" "$state"
    fi
  done
  printf '  %-26s %s\n' "Kinect 2" "built where libfreenect2 is; no distribution packages it: see docs/cameras.md"
}

# What the distribution does not have, or only with hundreds of packages.
declare -A fetched=()
fetch() {  # fetch PART SCRIPT
  if ! is_wanted "$1"; then return 0; fi
  fetched["$1"]="installed"
  "$scripts/$2" || fetched["$1"]="off: could not be fetched (see above)"
}

if ! is_available cmake && may_install; then as_root apt-get update -q; fi  # a fresh machine may have no package lists
if [[ ! " ${required[*]} " =~ " libopencv-dev " ]] && ! is_installed libopencv-dev; then
  mapfile -t -O "${#required[@]}" required < <("$scripts/unpack_opencv.sh" --dependencies)
fi
mapfile -t missing < <(missing_of "${required[@]}")
wanted=()
for part in "${optional[@]}"; do
  if ! is_wanted "${part%%:*}"; then continue; fi
  # shellcheck disable=SC2086  # a list of packages
  mapfile -t -O "${#wanted[@]}" wanted < <(missing_of ${part#*:})
done

if [[ ${#missing[@]} -gt 0 ]] && ! may_install; then
  echo "Not root and no sudo. As root, run: apt-get install ${missing[*]}" >&2
  exit 3
fi
if may_install && [[ ${#missing[@]} -gt 0 ]]; then as_root apt-get update -q; fi

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
"$scripts/unpack_opencv.sh"
fetch "viewer and report pages" install_npm.sh
fetch "g2o solver" install_g2o.sh
fetch "Python" install_pybind11.sh
print_table

#!/usr/bin/env bash
# Installs what kinloop is built from: packages of Debian 12 or Ubuntu 22.04 and newer, only those that are missing.
# Usage: scripts/install_dependencies.sh [--checks]     --checks: also the tools of the format and tidy checks
set -euo pipefail

packages=(
  build-essential cmake ninja-build ccache git pkg-config
  libopencv-dev libeigen3-dev libceres-dev libsuitesparse-dev libhwy-dev
  libturbojpeg0-dev libdeflate-dev
  libyaml-cpp-dev libcli11-dev libspdlog-dev libfmt-dev nlohmann-json3-dev
  libsqlite3-dev
  libgtest-dev libgmock-dev libbenchmark-dev libdlib-dev
  libopenvdb-dev liboctomap-dev
)
if [[ "${1:-}" == "--checks" ]]; then
  packages+=(clang-format clang-tidy)
elif [[ $# -gt 0 ]]; then
  echo "usage: $0 [--checks]" >&2
  exit 2
fi

if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
  echo "This script knows Debian and Ubuntu (apt). Elsewhere, install the counterparts of: ${packages[*]}" >&2
  exit 3
fi

is_installed() {
  [[ "$(dpkg-query -W -f '${db:Status-Status}' "$1" 2>/dev/null)" == "installed" ]]
}

missing=()
for package in "${packages[@]}"; do
  is_installed "$package" || missing+=("$package")
done
if [[ ${#missing[@]} -eq 0 ]]; then
  echo "All packages are installed."
  exit 0
fi

as_root=()
if [[ $EUID -ne 0 ]]; then
  if ! command -v sudo >/dev/null; then
    echo "Not root and no sudo. As root, run: apt-get install ${missing[*]}" >&2
    exit 3
  fi
  as_root=(sudo)
fi

echo "Installing: ${missing[*]}"
"${as_root[@]}" apt-get update -q
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends "${missing[@]}" \
  </dev/null

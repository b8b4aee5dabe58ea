#!/usr/bin/env bash
# Fetches pybind11, with which the Python package is built, from the Python package index into build/pybind11: those of
# Debian 12 and Ubuntu 24.04 are from before NumPy 2. Says why, if it could not. Nothing else depends on it.
# Usage: scripts/install_pybind11.sh
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/install_folder.sh

package="pybind11==3.1.0"  # headers; BSD licence
sha256="b8488090f8acffbcb6b5d6a85571a6827a0a2981ffb75e5a0b27b87c4a6b7dd0"  # of its wheel

fetch() {
  echo "$package --hash=sha256:$sha256" >"$1/requirements" &&
    python3 -m venv "$1/venv" &&
    "$1/venv/bin/pip" install --quiet --disable-pip-version-check --no-deps --only-binary :all: --require-hashes \
      --requirement "$1/requirements" --target "$1/files"
}

install_folder build/pybind11 "$sha256" pybind11 \
  "pybind11 could not be fetched from the Python package index; the Python package is left out."

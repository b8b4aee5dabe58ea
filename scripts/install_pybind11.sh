#!/usr/bin/env bash
# Fetches pybind11, with which the Python package is built, from the Python package index into build/pybind11: those of
# Debian 12 and Ubuntu 24.04 are from before NumPy 2. Says why, if it could not. Nothing else depends on it.
# Usage: scripts/install_pybind11.sh
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

package="pybind11==3.1.0"  # headers; BSD licence
sha256="b8488090f8acffbcb6b5d6a85571a6827a0a2981ffb75e5a0b27b87c4a6b7dd0"  # of its wheel
folder="build/pybind11"
stamp="$folder/fetched"

if [[ "$(cat "$stamp" 2>/dev/null)" == "$sha256" ]]; then exit 0; fi
mkdir -p build
temporary="$(mktemp -d build/pybind11.XXXXXX)"
trap 'rm -rf "$temporary"' EXIT
echo "$package --hash=sha256:$sha256" >"$temporary/requirements"

fetch() {
  python3 -m venv "$temporary/venv" &&
    "$temporary/venv/bin/pip" install --quiet --disable-pip-version-check --no-deps --only-binary :all: --require-hashes \
      --requirement "$temporary/requirements" --target "$temporary/files"
}

if ! fetch >"$temporary/log" 2>&1; then
  echo "pybind11 could not be fetched from the Python package index; the Python package is left out." >&2
  tail -n 1 "$temporary/log" >&2
  exit 1
fi
rm -rf "$folder"
mv "$temporary/files" "$folder"
echo "$sha256" >"$stamp"
echo "Fetched pybind11: $folder"

#!/usr/bin/env bash
# Fetches the sources of g2o, which no distribution packages, from the Python package index into build/g2o; kinloop is
# then built with `--solver g2o`. Says why, if it could not. Nothing else depends on it.
# Usage: scripts/install_g2o.sh
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/install_folder.sh

package="g2opy==2.3.0"  # g2o 2.3 with its Python package; BSD licence
sha256="cba80e7e42b1cd410c125abe959409fbe03368261810049766b2b341f626e111"  # of its sources

fetch() {  # whatever Python there is, since only the C++ sources are used
  python3 -m venv "$1/venv" &&
    "$1/venv/bin/pip" download --quiet --disable-pip-version-check --ignore-requires-python --no-deps \
      --no-binary g2opy --dest "$1" "$package" &&
    sha256sum --quiet --check - <<<"$sha256  $(echo "$1"/*.tar.gz)" &&
    mkdir "$1/files" &&
    tar -xf "$1"/*.tar.gz -C "$1/files" --strip-components 1
}

install_folder build/g2o "$sha256" "the sources of g2o" \
  "g2o could not be fetched from the Python package index; --solver g2o is left out."

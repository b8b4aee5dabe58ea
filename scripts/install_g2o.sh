#!/usr/bin/env bash
# Fetches the sources of g2o, which no distribution packages, from the Python package index into build/g2o; kinloop is
# then built with `--solver g2o`. Says why, if it could not. Nothing else depends on it.
# Usage: scripts/install_g2o.sh
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

package="g2opy==2.3.0"  # g2o 2.3 with its Python package; BSD licence
sha256="cba80e7e42b1cd410c125abe959409fbe03368261810049766b2b341f626e111"  # of its sources
folder="build/g2o"
stamp="$folder/fetched"

if [[ "$(cat "$stamp" 2>/dev/null)" == "$sha256" ]]; then exit 0; fi
mkdir -p build
temporary="$(mktemp -d build/g2o.XXXXXX)"
trap 'rm -rf "$temporary"' EXIT

fetch() {  # whatever Python there is, since only the C++ sources are used
  python3 -m venv "$temporary/venv" &&
    "$temporary/venv/bin/pip" download --quiet --disable-pip-version-check --ignore-requires-python --no-deps \
      --no-binary g2opy --dest "$temporary" "$package" &&
    sha256sum --quiet --check - <<<"$sha256  $(echo "$temporary"/*.tar.gz)" &&
    mkdir "$temporary/sources" &&
    tar -xf "$temporary"/*.tar.gz -C "$temporary/sources" --strip-components 1
}

if ! fetch >"$temporary/log" 2>&1; then
  echo "g2o could not be fetched from the Python package index; --solver g2o is left out." >&2
  tail -n 1 "$temporary/log" >&2
  exit 1
fi
rm -rf "$folder"
mv "$temporary/sources" "$folder"
echo "$sha256" >"$stamp"
echo "Fetched the sources of g2o: $folder"

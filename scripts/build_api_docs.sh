#!/usr/bin/env bash
# Writes the reference of the library's public headers to build/api/html (needs doxygen). A warning is a failure.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

rm -rf build/api
mkdir -p build/api
doxygen docs/Doxyfile
echo "API reference: $PWD/build/api/html/index.html"

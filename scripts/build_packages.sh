#!/usr/bin/env bash
# Builds the Debian packages of this machine's distribution into build/packages.
# Usage: scripts/build_packages.sh
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

cmake --preset package
cmake --build --preset package --parallel "$(scripts/build_jobs.sh)"
rm -rf build/packages
cpack --config build/package/CPackConfig.cmake -B build/packages
rm -rf build/packages/_CPack_Packages
ls -l build/packages

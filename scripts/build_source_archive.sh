#!/usr/bin/env bash
# Builds build/kinloop-VERSION.tar.gz: the sources of the last commit with the built pages of the viewer and the report, so
# that building kinloop needs neither Node.js nor npm.
# Usage: scripts/build_source_archive.sh
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

cmake --preset package
cmake --build --preset package --target kinloop_pages
grep -q '^KINLOOP_PAGES_FOUND:INTERNAL=1' build/package/CMakeCache.txt || {
  echo "The pages could not be built; scripts/install_dependencies.sh --packages installs what they need." >&2
  exit 3
}

version="$(sed -n 's/^project(kinloop VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)"
name="kinloop-$version"
git archive --format=tar.gz -o "build/$name.tar.gz" \
  --prefix="$name/viewer/pages/built/" --add-file=build/package/pages/viewer.html --add-file=build/package/pages/report.html \
  --prefix="$name/" HEAD
echo "build/$name.tar.gz: $(du -k "build/$name.tar.gz" | cut -f 1) kB"

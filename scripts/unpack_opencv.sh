#!/usr/bin/env bash
# Unpacks the distribution's OpenCV, as far as kinloop uses it, into build/opencv, unless libopencv-dev is installed: that
# package requires 300 others (Qt, FFmpeg, GDAL, Mesa with LLVM), of which kinloop uses nothing.
# Usage: scripts/unpack_opencv.sh [--dependencies]     --dependencies: print the packages that these libraries need instead
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

modules=(core imgproc flann features2d calib3d video)
folder="build/opencv"

# depends PACKAGE...: what they depend on, all alternatives.
depends() { LC_ALL=C apt-cache depends "$@" | sed -n 's/^[ |]*Depends: \([^<]*\)$/\1/p' | sort -u; }

mapfile -t headers < <(printf 'libopencv-%s-dev\n' "${modules[@]}")
# Of those of the modules, and dnn, which video loads.
mapfile -t libraries < <(depends "${headers[@]}" | grep -E '^libopencv-(core|imgproc|flann|features2d|calib3d|video)[0-9]')
mapfile -t -O "${#libraries[@]}" libraries < <(depends "${libraries[@]}" | grep '^libopencv-dnn')
libraries+=(libglx0)  # core loads it; its package requires drivers of graphics cards

if [[ "${1:-}" == --dependencies ]]; then
  depends "${libraries[@]}" | grep -vE '^lib(opencv-.*|glx0|glx-mesa0)$'
  exit 0
fi

if [[ "$(dpkg-query -W -f '${db:Status-Status}' libopencv-dev 2>/dev/null)" == installed ]]; then exit 0; fi
version="$(LC_ALL=C apt-cache policy libopencv-core-dev | sed -n 's/^  Candidate: //p')"
if [[ "$(cat "$folder/version" 2>/dev/null)" == "$version" ]]; then exit 0; fi
rm -rf "$folder"
mkdir -p "$folder/packages" "$folder/lib"
(cd "$folder/packages" && apt-get -qq -o APT::Sandbox::User=root download "${headers[@]}" "${libraries[@]}")
for package in "$folder"/packages/*.deb; do dpkg-deb --extract "$package" "$folder/packages"; done
mv "$folder/packages/usr/include" "$folder"
mv "$folder"/packages/usr/lib/*/lib*.so* "$folder/lib"
rm -r "$folder/packages"
echo "$version" >"$folder/version"
echo "Unpacked OpenCV: $folder"

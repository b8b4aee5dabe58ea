#!/usr/bin/env bash
# Unpacks the arm64 packages of the running Debian or Ubuntu release into a folder, for cross-compilation with the
# preset `aarch64`. The packages of this machine stay as they are; root is not needed.
# Usage: scripts/aarch64_sysroot.sh [FOLDER]     (default build/aarch64_sysroot)
set -euo pipefail

packages=(
  libc6-dev libstdc++-12-dev
  libopencv-dev libeigen3-dev libceres-dev libsuitesparse-dev libblas-dev liblapack-dev libhwy-dev
  libturbojpeg0-dev libdeflate-dev liblz4-dev libzstd-dev libbz2-dev libtiff-dev libopenexr-dev libsqlite3-dev
  libyaml-cpp-dev libcli11-dev libspdlog-dev libfmt-dev nlohmann-json3-dev
  libgtest-dev libgmock-dev libbenchmark-dev libboost-dev
)
root=${1:-$(dirname "$0")/../build/aarch64_sysroot}
mkdir -p "$root" "$root.apt"/{lists,cache/archives}/partial
root=$(realpath "$root")

# apt with package lists, cache and installed packages of its own.
touch "$root.apt/status"
options=(
  -o APT::Architecture=arm64 -o APT::Architectures=arm64 -o APT::Install-Recommends=false -o APT::Sandbox::User=root
  -o Dir::State::lists="$root.apt/lists" -o Dir::State::status="$root.apt/status" -o Dir::Cache="$root.apt/cache"
  -o Debug::NoLocking=true
)
apt-get "${options[@]}" -q update
apt-get "${options[@]}" -qy --download-only install "${packages[@]}"

for package in "$root.apt"/cache/archives/*.deb; do dpkg-deb --extract "$package" "$root"; done

# Absolute links would lead out of the folder.
find "$root" -type l -lname '/*' -print0 | while IFS= read -r -d '' link; do
  target=$root$(readlink "$link")
  ln -sfn "$(realpath -ms --relative-to="$(dirname "$link")" "$target")" "$link"
done
# What update-alternatives does on installation; of several, Debian prefers ATLAS.
libraries=$root/usr/lib/aarch64-linux-gnu
for folder in blas lapack atlas; do
  for file in "$libraries/$folder"/lib{blas,lapack}.so*; do
    if [[ -e $file ]]; then ln -sfn "$folder/$(basename "$file")" "$libraries/"; fi
  done
done
# Some CMake files of packages name libraries by their absolute path.
grep -rlZ --include='*.cmake' ';/usr/lib/aarch64-linux-gnu/lib' "$libraries/cmake" |
  xargs -0r sed -i "s#;/usr/lib/aarch64-linux-gnu/lib#;$libraries/lib#g"
echo "$root: $(du -sh "$root" | cut -f1)"

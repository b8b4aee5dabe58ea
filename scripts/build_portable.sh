#!/usr/bin/env bash
# Builds build/kinloop-VERSION-linux-ARCH.tar.zst: the program with its libraries, to unpack and run on any distribution
# whose C library is not older than that of this machine.
# Usage: scripts/build_portable.sh
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

# The old kind of rpath also serves the libraries of libraries.
# shellcheck disable=SC2016  # $ORIGIN is for the loader
cmake --preset package -B build/portable -DCMAKE_INSTALL_RPATH='$ORIGIN/../lib' \
  -DCMAKE_EXE_LINKER_FLAGS="-Wl,--as-needed -Wl,--disable-new-dtags"
cmake --build build/portable --parallel "$(scripts/build_jobs.sh)"

version="$(sed -n 's/^project(kinloop VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)"
name="kinloop-$version-linux-$(uname -m)"
root="build/$name"
rm -rf "$root"
cmake --install build/portable --component program --prefix "$PWD/$root" --strip >/dev/null
mv "$root/share/zsh/vendor-completions" "$root/share/zsh/site-functions"
cp LICENSE "$root"

# Everything but the C library and the loader, which must be those of the machine.
mkdir -p "$root/lib"
scripts/copy_licenses.sh build/portable/apps/kinloop "$root/share/doc/libraries" | xargs -d '\n' cp -L -t "$root/lib"
strip --strip-unneeded "$root"/lib/*.so* 2>/dev/null || true

needed="$(objdump -T "$root/bin/kinloop" "$root"/lib/* | grep -o 'GLIBC_[0-9.]*' | sort -uV | tail -n 1)"
# The same bytes from the same files.
tar --sort=name --owner=0 --group=0 --numeric-owner --mtime="@$(git log -1 --format=%ct)" -C build -cf - "$name" |
  zstd -q -19 -T0 -f -o "build/$name.tar.zst"
echo "build/$name.tar.zst: $(du -m "build/$name.tar.zst" | cut -f 1) MB, unpacked $(du -sm "$root" | cut -f 1) MB," \
  "$(find "$root/lib" -type f | wc -l) libraries, needs $needed"

#!/usr/bin/env bash
# Fetches npm, with which the viewer and report pages are built, from its registry into build/npm, unless there is one: it is
# one archive, while Debian's package requires 390 others. Says why, if it could not; the pages are then plain ones.
# Usage: scripts/install_npm.sh
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/install_folder.sh

version=8.19.4  # for every Node.js from that of Ubuntu 22.04 (12.22) on; Artistic License 2.0
sha512="dc700d97c8bd0ca9d403cf4fe0a12054d376f048d27830a6bc4a9bcce02ec42143cdd059ce3525f7dce09c6a4e52e9af5b996f268d8729c8ebb1cfad7f2bf51f"

fetch() {  # by apt's own downloader, which is on every Debian; curl is not
  /usr/lib/apt/apt-helper download-file "https://registry.npmjs.org/npm/-/npm-$version.tgz" "$1/npm.tgz" \
    "SHA512:$sha512" >"$1/apt" 2>&1 || { grep -m 1 '^E:' "$1/apt"; return 1; }
  mkdir "$1/files" && tar -xf "$1/npm.tgz" -C "$1/files" --strip-components 1
}

if command -v npm >/dev/null; then exit 0; fi
install_folder build/npm "$version" npm \
  "npm could not be fetched from its registry; the viewer and report pages are left out."

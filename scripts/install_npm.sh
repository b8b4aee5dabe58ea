#!/usr/bin/env bash
# Fetches npm, with which the viewer and report pages are built, from its registry into build/npm, unless there is one: it is
# one archive, while Debian's package requires 390 others. Says why, if it could not; the pages are then plain ones.
# Usage: scripts/install_npm.sh
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

version=8.19.4  # for every Node.js from that of Ubuntu 22.04 (12.22) on; Artistic License 2.0
sha512="dc700d97c8bd0ca9d403cf4fe0a12054d376f048d27830a6bc4a9bcce02ec42143cdd059ce3525f7dce09c6a4e52e9af5b996f268d8729c8ebb1cfad7f2bf51f"
folder="build/npm"

if command -v npm >/dev/null || [[ "$(cat "$folder/fetched" 2>/dev/null)" == "$version" ]]; then exit 0; fi
mkdir -p build
temporary="$(mktemp -d build/npm.XXXXXX)"
trap 'rm -rf "$temporary"' EXIT

# apt's own downloader is on every Debian, curl is not.
if ! /usr/lib/apt/apt-helper download-file "https://registry.npmjs.org/npm/-/npm-$version.tgz" "$temporary/npm.tgz" \
  "SHA512:$sha512" >"$temporary/log" 2>&1; then
  echo "npm could not be fetched from its registry; the viewer and report pages are left out." >&2
  grep -m 1 '^E:' "$temporary/log" >&2 || true
  exit 1
fi
rm -rf "$folder"
mkdir "$folder"
tar -xf "$temporary/npm.tgz" -C "$folder" --strip-components 1
echo "$version" >"$folder/fetched"
echo "Fetched npm: $folder"

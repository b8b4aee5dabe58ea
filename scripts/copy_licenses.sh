#!/usr/bin/env bash
# Copies the licences of the libraries that a program or module loads, those of the C library excepted, from their
# packages. Prints the paths of the libraries.
# Usage: scripts/copy_licenses.sh FILE FOLDER
set -euo pipefail
file="$1" folder="$2"

mkdir -p "$folder"
of_the_machine='^(ld-linux.*|lib(c|m|dl|rt|pthread|resolv|util|nsl|anl|BrokenLocale))\.so'
ldd "$file" | sed -n 's/.* => \(\/[^ ]*\) .*/\1/p' | sort -u | while read -r library; do
  if [[ "$(basename "$library")" =~ $of_the_machine ]]; then continue; fi
  package="$(dpkg-query -S "$(realpath "$library")" "$library" 2>/dev/null | head -n 1 | cut -d : -f 1)" || true
  if [[ -f "/usr/share/doc/$package/copyright" ]]; then
    cp -L "/usr/share/doc/$package/copyright" "$folder/$package.copyright"
  fi
  echo "$library"
done
g2o="$(dirname "${BASH_SOURCE[0]}")/../build/g2o/LICENSE"
if [[ -f "$g2o" ]]; then cp "$g2o" "$folder/g2o.copyright"; fi

#!/usr/bin/env bash
# Prints the optional parts of the release build as a table.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

build/release/apps/kinloop --version | while IFS= read -r line; do
  if [[ "$line" == *": "* ]]; then printf '  %-26s %s\n' "${line%%: *}" "${line#*: }"; else echo "$line"; fi
done

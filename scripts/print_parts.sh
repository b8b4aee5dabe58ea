#!/usr/bin/env bash
# Prints the optional parts of the release build as a table.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

build/release/apps/kinloop --version | awk -F ': ' 'NF == 1 { print } NF > 1 { printf "  %-26s %s\n", $1, $2 }'

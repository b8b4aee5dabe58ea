#!/usr/bin/env bash
# Fails if the release build lacks a part available on Debian 12 (required_parts.txt).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

built="$(build/release/apps/kinloop --version)"
failed=0
while read -r part; do
  grep -qxF "$part: yes" <<<"$built" && continue
  echo "missing from this build: $part"
  failed=1
done <.ci/required_parts.txt
exit "$failed"

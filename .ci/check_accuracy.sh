#!/usr/bin/env bash
# Maps the twenty short sequences of bench/suites/regression.yaml (40 CPU s) and compares them with
# bench/suites/regression.csv; fails if the program is worse than what was committed there. After a change that is meant to alter results:
#   .ci/check_accuracy.sh --update
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

results=build/regression
build/release/apps/kinloop batch bench/suites/regression.yaml -o "$results" -q
if [[ "${1:-}" == --update ]]; then
  cp "$results/runs.csv" bench/suites/regression.csv
else
  build/release/apps/kinloop batch compare bench/suites/regression.csv "$results"
fi

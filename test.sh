#!/usr/bin/env bash
# Builds kinloop and runs all of its tests. The last line is "N passed, N failed", with ", N skipped" if some
# could not run (those on real recordings are skipped without ../shared/data). Exit code 0 if none failed.
# Usage: ./test.sh [--minimal]     --minimal leaves the optional parts out
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"

if [[ $# -gt 1 || ( $# -eq 1 && "$1" != --minimal ) ]]; then
  echo "usage: $0 [--minimal]" >&2
  exit 2
fi
jobs="$(scripts/build_jobs.sh)"
junit="build/release/tests.xml"

fail_before_tests() {
  echo "$1" >&2
  echo "0 passed, 1 failed"
  exit 1
}

scripts/install_dependencies.sh --tests "$@" || fail_before_tests "The packages could not be installed."
scripts/install_test_packages.sh || true  # what needs them is skipped
cmake --preset release -DKINLOOP_TESTS=ON -DKINLOOP_BENCH=ON -DKINLOOP_EXAMPLES=ON \
  -DKINLOOP_PYTHON=ON -DKINLOOP_MINIMAL="$([[ $# -gt 0 ]] && echo ON || echo OFF)" || fail_before_tests "Configuring failed."
NINJA_STATUS="[%p, %f of %t, %e s] " cmake --build --preset release --parallel "$jobs" ||
  fail_before_tests "The build failed."

rm -f "$junit"
ctest --test-dir build/release --parallel "$(nproc)" --output-on-failure --no-tests=error \
  --output-junit "$PWD/$junit" </dev/null || true
[[ -s "$junit" ]] || fail_before_tests "The tests could not be run."

echo
echo "This build:"
scripts/print_parts.sh || fail_before_tests "The program does not start."

# The first line of the file: <testsuite ... tests="120" failures="1" disabled="0" skipped="2" ...>
count() {
  sed -n "s/^[[:space:]]*$1=\"\([0-9]*\)\".*/\1/p" "$junit" | head -n 1
}
failed="$(count failures)"
skipped="$(($(count skipped) + $(count disabled)))"
passed="$(($(count tests) - failed - skipped))"

# The output of each failed test again: the log is long, and what comes last is seen first.
if [[ $failed -gt 0 ]]; then
  printf '\nThe tests that failed:\n'
  awk '/<testcase /{ is_failed = /status="fail"/ } /<\/testsuite>/{ exit } is_failed' "$junit" |
    sed 's/&lt;/</g; s/&gt;/>/g; s/&quot;/"/g; s/&apos;/'"'"'/g; s/&amp;/\&/g' | tail -n 40
  echo
fi

summary="$passed passed, $failed failed"
if [[ $skipped -gt 0 ]]; then summary+=", $skipped skipped"; fi
echo "$summary"
[[ $failed -eq 0 ]]

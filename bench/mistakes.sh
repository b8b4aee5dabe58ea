#!/bin/sh
# Prints kinloop's response to the mistakes of tests/apps/mistakes.cpp, and its duration in seconds, as a
# Markdown table.
#   bench/mistakes.sh [BUILD_FOLDER]
set -eu
build=${1:-$(dirname "$0")/../build/release}
table=$(mktemp)
trap 'rm -f "$table"' EXIT
KINLOOP_MISTAKES_TABLE=$table "$build/tests/test_apps" --gtest_brief=1 --gtest_filter='Mistakes.*' >&2
echo '| kinloop ... | exit code | seconds | first line of the message |'
echo '|---|---|---|---|'
cat "$table"

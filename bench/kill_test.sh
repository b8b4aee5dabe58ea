#!/usr/bin/env bash
# kill -9 at random moments of a run that saves its map continuously: whenever a map file exists, it must be
# intact.
# Usage: bench/kill_test.sh KINLOOP [TIMES] [SEQUENCE]
set -euo pipefail
kinloop="$1"
times="${2:-50}"
sequence="${3:-sim:room}"
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
RANDOM=1

for ((i = 1; i <= times; ++i)); do
  rm -rf "$folder/out"
  "$kinloop" run "$sequence" -o "$folder/out" --autosave 0.001 -q --set sim.width=160 --set sim.height=120 \
    2>/dev/null &
  run=$!
  until [[ -e "$folder/out/map.kinmap" ]]; do sleep 0.05; done
  sleep "0.$(printf '%03d' $((RANDOM % 1000)))"
  kill -9 "$run" 2>/dev/null || true
  wait "$run" 2>/dev/null || true
  if ! "$kinloop" map info "$folder/out" | grep -q "^damage *none"; then
    echo "damaged after kill $i" >&2
    exit 1
  fi
  "$kinloop" export "$folder/out" --trajectory "$folder/trajectory.txt" -q
  echo "kill $i: the last autosave is whole"
done

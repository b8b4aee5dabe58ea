#!/usr/bin/env bash
# kill -9 at random moments of a run that saves its map all the time: whenever there is a map file, it must be
# whole. Usage: bench/kill_test.sh KINLOOP [TIMES] [SEQUENCE]
set -euo pipefail
kinloop="$1"
times="${2:-50}"
sequence="${3:-sim:room}"
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
RANDOM=1

whole=0
none=0
for ((i = 0; i < times; ++i)); do
  "$kinloop" run "$sequence" -o "$folder/out" --autosave 0.001 -q --set sim.width=320 --set sim.height=240 \
    2>/dev/null &
  run=$!
  sleep "$((RANDOM % 6)).$((RANDOM % 1000))"
  kill -9 "$run" 2>/dev/null || true
  wait "$run" 2>/dev/null || true
  if [[ ! -e "$folder/out/map.kinmap" ]]; then
    none=$((none + 1))
    continue
  fi
  if ! "$kinloop" map info "$folder/out" | grep -q "^damage *none"; then
    echo "damaged after kill $i" >&2
    exit 1
  fi
  "$kinloop" export "$folder/out" --trajectory "$folder/trajectory.txt" -q
  whole=$((whole + 1))
done
echo "$times kills: $whole times the last autosave was whole, $none times there was none yet"

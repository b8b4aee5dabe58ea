#!/usr/bin/env bash
# Regenerates the pictures of README and docs (docs/images) from the release build.
# Usage: scripts/make_pictures.sh            the simulated room: map, viewer, reports; after ./test.sh, a few minutes
#        scripts/make_pictures.sh --curves   the curves of docs/lab/place.md, from ../shared/data; 20 CPU minutes
#        scripts/make_pictures.sh --movie    the moving picture of the README; needs img2webp (package webp); 10 minutes
#        scripts/make_pictures.sh --paper FOLDER    the pictures of docs/lab/paper.md, from `kinloop reproduce -o FOLDER`
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

export KINLOOP_PROGRAM="$PWD/build/release/apps/kinloop"
images="$PWD/docs/images" journals="$PWD/docs/lab/images"

draw_curves() {  # as in docs/lab/place.md: every 6th pose of a handheld path through two rooms
  local data="$PWD/../shared/data" bench="$PWD/build/release/bench/bench_place"
  work="$(mktemp -d)"
  trap 'rm -rf "$work"' EXIT
  awk 'NR % 6 == 1' "$data/trajectories/fr1_room_like.txt" >"$work/path.txt"
  for room in 1 2; do "$KINLOOP_PROGRAM" simulate room --seed "$room" --path "$work/path.txt" -o "$work/$room"; done
  cd "$work"
  "$bench" compare 32 3 0 5 "$data/redkitchen"
  mv place_curves.svg "$journals/place_curves.svg"
  "$bench" compare 32 3 0 3 1 2
  mv place_curves.svg "$journals/place_curves_rooms.svg"
}

make_movie() {
  work="$(mktemp -d)"
  trap 'rm -rf "$work"' EXIT
  KINLOOP_PAGES_SOURCE="$PWD/viewer/pages" node scripts/make_movie.mjs "$work"
  local pictures=("$work"/*.png)
  img2webp -loop 0 -lossy -q 50 -m 6 -d 120 "${pictures[@]}" -d 3000 "${pictures[-1]}" -o "$images/growing_map.webp"
}

case "${1:-}" in
  "") KINLOOP_PAGES_SOURCE="$PWD/viewer/pages" KINLOOP_SCREENSHOTS="$images" node scripts/make_pictures.mjs ;;
  --curves) draw_curves ;;
  --movie) make_movie ;;
  --paper) KINLOOP_PAGES_SOURCE="$PWD/viewer/pages" KINLOOP_SCREENSHOTS="$journals" node scripts/make_paper_pictures.mjs "$2" ;;
  *)
    echo "usage: $0 [--curves | --movie | --paper FOLDER]" >&2
    exit 2
    ;;
esac

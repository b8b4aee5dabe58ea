#!/usr/bin/env bash
# Sourced by scripts that fetch what distributions do not package, or only with hundreds of other packages.

# install_folder FOLDER STAMP WHAT FAILURE: makes FOLDER of what the function `fetch TEMPORARY` puts into TEMPORARY/files, unless
# it was made with this STAMP before. Ends the script with the line FAILURE and the last one of `fetch` if that fails.
install_folder() {
  local folder="$1" stamp="$2" what="$3" failure="$4"
  if [[ "$(cat "$folder/fetched" 2>/dev/null)" == "$stamp" ]]; then return 0; fi
  mkdir -p build
  temporary="$(mktemp -d "$folder.XXXXXX")"
  trap 'rm -rf "$temporary"' EXIT
  if ! fetch "$temporary" >"$temporary/log" 2>&1; then
    echo "$failure" >&2
    tail -n 1 "$temporary/log" >&2
    exit 1
  fi
  rm -rf "$folder"
  mv "$temporary/files" "$folder"
  echo "$stamp" >"$folder/fetched"
  echo "Fetched $what: $folder"
}

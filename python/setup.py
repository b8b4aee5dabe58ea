"""Builds the Python package kinloop: CMake compiles the module, setuptools makes the wheel.

Variables of the environment: KINLOOP_CMAKE_ARGS, further arguments of CMake; KINLOOP_BUILD_FOLDER, the folder to build in
(default: build/wheel, so that a second build takes seconds).
"""

import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import sysconfig

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = pathlib.Path(__file__).resolve().parent.parent
VERSION = re.search(r"project\(kinloop VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text()).group(1)
OPTIONS = {
    "CMAKE_BUILD_TYPE": "Release",
    "CMAKE_UNITY_BUILD": "ON",
    "CMAKE_UNITY_BUILD_BATCH_SIZE": "12",
    "KINLOOP_PYTHON": "ON",
    "KINLOOP_PROGRAM": "OFF",
    "KINLOOP_TESTS": "OFF",
    "KINLOOP_BENCH": "OFF",
    "KINLOOP_EXAMPLES": "OFF",
    "KINLOOP_WERROR": "OFF",
    "Python3_EXECUTABLE": sys.executable,
}


def pybind11_arguments():
    """CMake's arguments for the pybind11 of this environment (python/pyproject.toml asks for it). None without one: CMake
    then looks in build/pybind11, where scripts/install_pybind11.sh puts it."""
    try:
        import pybind11
    except ImportError:
        return []
    return [f"-Dpybind11_DIR={pybind11.get_cmake_dir()}"]


class CMakeBuild(build_ext):
    """Builds the only extension with CMake and copies it to where setuptools expects it."""

    def build_extension(self, extension):
        build = pathlib.Path(os.environ.get("KINLOOP_BUILD_FOLDER", ROOT / "build" / "wheel"))
        # What CMake remembers of another Python it would not look for again.
        arguments = ["-U*Python3_*", "-UPYTHON_MODULE_*", *(f"-D{name}={value}" for name, value in OPTIONS.items())]
        arguments += pybind11_arguments() + shlex.split(os.environ.get("KINLOOP_CMAKE_ARGS", ""))
        generator = ["-G", "Ninja"] if shutil.which("ninja") else []
        subprocess.run(["cmake", "-S", ROOT, "-B", build, *generator, *arguments], check=True)
        if "KINLOOP_PYTHON_FOUND:INTERNAL=1" not in (build / "CMakeCache.txt").read_text():
            sys.exit("pybind11 2.13 or newer, or the headers of this Python, were not found: scripts/install_pybind11.sh "
                     "fetches the former, apt-get install python3-dev the latter for the distribution's Python")
        jobs = subprocess.run([ROOT / "scripts" / "build_jobs.sh"], check=True, capture_output=True, text=True).stdout
        subprocess.run(["cmake", "--build", build, "--target", "_kinloop", "--parallel", jobs.strip()], check=True)
        target = pathlib.Path(self.get_ext_fullpath(extension.name))
        target.parent.mkdir(parents=True, exist_ok=True)
        module = f"_kinloop{sysconfig.get_config_var('EXT_SUFFIX')}"  # the folder may have those of other Pythons
        shutil.copyfile(build / "python" / "kinloop" / module, target)


setup(
    name="kinloop",
    version=VERSION,
    description="RGB-D visual SLAM on an ordinary CPU",
    long_description=(ROOT / "docs" / "python.md").read_text(),
    long_description_content_type="text/markdown",
    license_files=["LICENSE"],
    python_requires=">=3.9",
    install_requires=["numpy"],
    extras_require={
        "open3d": ["open3d"],
        "pandas": ["pandas"],
        "batch": ["pyyaml", "dask", "distributed", "dask-jobqueue", "fsspec", "pandas", "pyarrow"],
    },
    packages=["kinloop", "kinloop.batch"],
    package_dir={"kinloop": "kinloop"},
    package_data={"kinloop": ["py.typed", "_kinloop.pyi"], "kinloop.batch": ["*.html"]},
    ext_modules=[Extension("kinloop._kinloop", sources=[])],
    cmdclass={"build_ext": CMakeBuild},
    zip_safe=False,
)

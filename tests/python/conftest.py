"""Shared by the tests of the Python package, which ctest runs with PYTHONPATH and KINLOOP_PROGRAM set."""

import os
import pathlib
import subprocess

import numpy
import pytest

import kinloop

SOURCE = pathlib.Path(__file__).resolve().parents[2]
SHARED_DATA = SOURCE.parent / "shared" / "data"


def pytest_addoption(parser):
    parser.addoption("--numpy", help="the major version that NumPy must have; all tests are skipped with another one")


def pytest_collection_modifyitems(config, items):
    wanted = config.getoption("--numpy")
    if wanted not in (None, numpy.__version__.split(".")[0]):
        for item in items:
            item.add_marker(pytest.mark.skip(reason=f"NumPy {wanted} is asked for, NumPy {numpy.__version__} is installed"))


def pytest_sessionfinish(session, exitstatus):
    """Tells ctest (SKIP_RETURN_CODE 77) if all tests were skipped."""
    reporter = session.config.pluginmanager.get_plugin("terminalreporter")
    if exitstatus == 0 and reporter.stats.get("skipped") and not reporter.stats.get("passed"):
        session.exitstatus = 77


@pytest.fixture(scope="session")
def program():
    """Runs the kinloop program; returns its standard error."""

    def run(*arguments, expect=0):
        done = subprocess.run([os.environ["KINLOOP_PROGRAM"], *map(str, arguments)], capture_output=True, text=True)
        assert done.returncode == expect, done.stderr
        return done.stderr

    return run


@pytest.fixture(scope="session")
def sequence(tmp_path_factory, program):
    """A simulated recording in TUM layout."""
    folder = tmp_path_factory.mktemp("recording") / "room"
    program("simulate", "room", "-o", folder, "--frames", 120, "--size", "320x240", "-q")
    return folder


@pytest.fixture(scope="session")
def result(sequence):
    source = kinloop.open(sequence)
    slam = kinloop.Slam(source.camera)
    for frame in source:
        slam.process(frame)
    return slam.finish()


@pytest.fixture(scope="session")
def program_run(program, sequence, tmp_path_factory):
    """The folder of `kinloop run` on the same recording."""
    folder = tmp_path_factory.mktemp("program") / "out"
    program("run", sequence, "-o", folder, "-q")
    return folder

"""The trajectory of a real recording, if it is there."""

import pytest
from conftest import SHARED_DATA

import kinloop

RECORDING = SHARED_DATA / "redkitchen"


@pytest.mark.skipif(not RECORDING.exists(), reason="no ../shared/data/redkitchen")
def test_same_bytes_of_trajectory_as_the_program(program, tmp_path):
    program("run", RECORDING, "-o", tmp_path / "out", "-q")
    source = kinloop.open(RECORDING)
    slam = kinloop.Slam(source.camera)
    for frame in source:
        slam.process(frame)
    slam.finish().trajectory.save(tmp_path / "trajectory.txt")
    assert (tmp_path / "trajectory.txt").read_bytes() == (tmp_path / "out/trajectory.txt").read_bytes()

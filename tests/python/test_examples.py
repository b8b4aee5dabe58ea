"""The scripts of docs/examples/python and the code of docs/python.md and README."""

import os
import re
import subprocess
import sys

import pytest
from conftest import SOURCE

import kinloop


@pytest.fixture
def example(tmp_path):
    """Runs an example in a folder of its own; returns what it prints."""

    def run(name, *arguments):
        command = [sys.executable, SOURCE / "docs/examples/python" / name, *map(str, arguments)]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        return done.stdout

    return run


@pytest.mark.parametrize("name", ["compare", "export_colmap", "localize", "map_a_folder", "read_poses", "stream_frames"])
def test_usage(name):
    done = subprocess.run([sys.executable, SOURCE / f"docs/examples/python/{name}.py"], capture_output=True, text=True)
    assert done.returncode == 1 and f"\n  {name}.py " in done.stderr and "Traceback" not in done.stderr


def test_map_a_folder(example, sequence, program_run, tmp_path):
    assert "120 of 120 frames located" in example("map_a_folder.py", sequence, "out")
    assert (tmp_path / "out/trajectory.txt").read_bytes() == (program_run / "trajectory.txt").read_bytes()


def test_live_loop(example, sequence, tmp_path):
    assert "ms per frame" in example("live_loop.py", sequence)
    truth = sequence / "groundtruth.txt"
    assert kinloop.evaluate(tmp_path / "trajectory.txt", truth).ate_m.rmse < 0.05


def test_compare(example, sequence, program_run, tmp_path):
    (tmp_path / "empty.txt").write_text("0 0 0 0 0 0 0 1\n")
    table = example("compare.py", sequence / "groundtruth.txt", program_run / "trajectory.txt", "empty.txt").splitlines()
    assert len(table) == 3 and table[1].startswith("trajectory") and "%" in table[1]
    assert "give the ground truth of the same recording" in table[2]


def test_localize(example, sequence, program_run, tmp_path):
    assert "120 of 120 frames located" in example("localize.py", program_run, sequence)
    e = kinloop.evaluate(tmp_path / "located.txt", program_run / "trajectory.txt")
    assert e.ate_m.rmse < 0.02


def test_export_colmap(example, program_run, tmp_path):
    example("export_colmap.py", program_run, "model")
    assert list(tmp_path.glob("model/sparse/0/cameras.*")) and list(tmp_path.glob("model/images/*"))


def start(*command, **streams):
    return subprocess.Popen([*map(str, command)], text=True, **streams)


def test_frames_in_and_poses_out(sequence, program_run, tmp_path):
    """Frames come from a program and poses go to another one, while the run is under way."""
    send, read = (SOURCE / "docs/examples/python" / name for name in ("stream_frames.py", "read_poses.py"))
    with (
        start(sys.executable, send, sequence, stdout=subprocess.PIPE) as sender,
        start(os.environ["KINLOOP_PROGRAM"], "run", "-", "-q", "-o", tmp_path / "out", "--poses-to", "-",
              stdin=sender.stdout, stdout=subprocess.PIPE) as run,
        start(sys.executable, read, "-", stdin=run.stdout, stdout=subprocess.PIPE) as reader,
    ):
        lines = reader.stdout.read().splitlines()
    assert run.returncode == 0 and reader.returncode == 0
    assert len(lines) == 120 and all(" tracked at " in line for line in lines)
    assert (tmp_path / "out/trajectory.txt").read_bytes() == (program_run / "trajectory.txt").read_bytes()


def test_read_poses_of_a_socket(sequence, tmp_path):
    socket = tmp_path / "poses.sock"
    with start(sys.executable, SOURCE / "docs/examples/python/read_poses.py", socket, stdout=subprocess.PIPE) as reader:
        run = start(os.environ["KINLOOP_PROGRAM"], "run", sequence, "-q", "-o", tmp_path / "out", "--poses-to",
                    f"unix:{socket}", stderr=subprocess.PIPE)  # may say that the first lines found no reader
        lines = reader.stdout.read().splitlines()
        run.communicate()
    assert run.returncode == 0 and reader.returncode == 0
    last = (tmp_path / "out/trajectory.txt").read_text().splitlines()[-1].split()
    stamp_ns, status, *_ = lines[-1].split()
    assert status == "tracked" and int(stamp_ns) == round(float(last[0]) * 1e9)


def blocks_of(document):
    text = (SOURCE / document).read_text()
    return re.findall(r"^```python\n(.*?)^```", text, re.DOTALL | re.MULTILINE)


@pytest.mark.parametrize("document, least", [("docs/python.md", 8), ("README.md", 1)])
def test_documents(document, least, sequence, tmp_path, monkeypatch):
    """Runs all blocks of a document in order, as a reader would in one session."""
    (tmp_path / "recording").symlink_to(sequence)
    monkeypatch.chdir(tmp_path)
    blocks = blocks_of(document)
    assert len(blocks) >= least
    names = {}
    for block in blocks:
        exec(compile(block, document, "exec"), names)

#!/usr/bin/env python3
"""Runs the kinloop commands in the code blocks of README and docs as a reader would, block after block.

Usage: run_code_blocks.py KINLOOP SHARED_DATA [FILE.md...]

Each page gets a folder in which the names that it uses exist: a short simulated recording for each recording, shared
checkerboard images for stills. A line is run as it stands, but for SHORTER. Lines that are not run must be in
RUN_ELSEWHERE. tests/python/test_examples.py runs the Python blocks, tests/consumers does what the CMake blocks say.
"""

import re
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PATIENCE_S = 120
MAX_STILLS = 12

# Names of the pages, and what they stand for.
RECORDINGS = ["RECORDING", "SEQUENCE", "FIRST", "SECOND", "MORE", "IMAGES", "OTHER", "PHOTOS", "vocabulary_images", "redkitchen",
              "rgbd_dataset_freiburg1_desk", "rgbd_dataset_freiburg1_rpy"]
# Lines that run on less than they say: minutes would become hours, and ports of this machine may be taken.
SHORTER = [
    (r"\bsim:room\b", "RECORDING"),
    (r"--viewer(?= *$| 9000)( 9000)?", "--viewer=0"),
    (r":8080\b", ":0"),
    (r"-k 32 -L 3", "-k 10 -L 3"),
]
RUN_ELSEWHERE = [
    (r"\./demo\.sh|\./test\.sh|scripts/install_dependencies|cmake ", ".ci/run"),
    (r"scripts/build_packages|(sudo )?apt install|pip |podman |tar -xf|\S*/bin/kinloop", "hosted CI, the job packages"),
    (r"RELEASE=|wget ", "by hand: no release is published yet"),
    (r"kinloop run kinect[12]", "tests of the drivers: it needs the camera"),
    (r"kinloop fetch", "Fetch.*: it needs the network"),
    (r"kinloop batch|scripts/update_figures|sbatch |kubectl |dask ", "tests/batch, with a stand-in for the program"),
    (r"kinloop reproduce -o", "Reproduce.*, with a short sequence: it takes three CPU minutes"),
    (r"kinloop plan", "FloorPlan.*, on rooms: the short runs of this script show none"),
    (r"kinloop map withdraw", "MapCommand.*: the short runs of this script close no loop"),
    (r"mpirun", "VocabCommand.SeveralProcessesGiveIdenticalBytes"),
    (r"bench_place|scripts/train_default_vocabulary", "by hand: it takes minutes"),
    (r"(sudo )?apt-get install.*aarch64|scripts/aarch64_sysroot|qemu-aarch64", "by hand: it needs another architecture"),
]


def shell_blocks(text):
    """Yields the lines of each block of shell commands as (line number, line)."""
    block, language = None, ""
    for number, line in enumerate(text.splitlines(), 1):
        if line.startswith("```"):
            if block is None:
                block, language = [], line[3:]
            else:
                if language in ("", "sh") and is_shell(block):
                    yield block
                block = None
        elif block is not None:
            block.append((number, line))


def is_shell(block):
    """Not a diagram or the output of a program."""
    return re.match(r"(#|kinloop|mpirun|bench_place|\S+/\S+|cmake|sudo|apt|apt-get|pip|podman|tar) ", block[0][1] + " ") is not None


def link_stills(source, target):
    """Links as many stills as a calibration needs, of each camera."""
    target.mkdir()
    for folder in [path for path in source.iterdir() if path.is_dir()]:
        link_stills(folder, target / folder.name)
    for still in sorted(path for path in source.iterdir() if path.suffix in (".jpg", ".png"))[:MAX_STILLS]:
        (target / still.name).symlink_to(still)


def prepare(folder, text, program, recording, shared):
    for name in RECORDINGS:
        (folder / name).symlink_to(recording)
    if (stills := shared / "kinect2_checkerboard").is_dir():
        link_stills(stills if "STILLS/" in text else stills / "colour", folder / "STILLS")
    # Maps of the reader's, by what a page says of them.
    for name, mentioned in {"d": "d/map.kinmap", "monday": "monday --compare", "tuesday": "--compare tuesday"}.items():
        if mentioned in text:
            kinloop(program, folder, f"kinloop run RECORDING -o {name} -q")
    shutil.copy(recording / "groundtruth.txt", folder / "orbslam2.txt")  # the trajectory of another program


def kinloop(program, folder, line):
    """Runs a line; returns what is wrong with its end, or None. `view` is closed once it shows its address."""
    words = [str(program) if word == "kinloop" else word for word in shlex.split(line)]
    views = words[1] == "view"
    with tempfile.TemporaryFile("w+") as output:
        process = subprocess.Popen(words, cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE if views else output,
                                   stderr=subprocess.STDOUT, text=True)
        if views:
            seen = next((text for text in process.stdout if "http://" in text), "")
            process.send_signal(signal.SIGINT)
        try:
            code = process.wait(PATIENCE_S)
        except subprocess.TimeoutExpired:
            process.kill()
            return f"not done after {PATIENCE_S} s"
        if views:
            return None if seen and code == 0 else f"exit code {code}, address {seen!r}"
        output.seek(0)
        return None if code == 0 else f"exit code {code}: {output.read()[-1000:]}"


def commands_of(line):
    code = re.sub(r"(^|\s+)#.*", "", line).strip()
    return [part.strip() for part in code.split("&&") if part.strip()]


def as_run(command):
    for pattern, replacement in SHORTER:
        command = re.sub(pattern, replacement, command)
    return command


def run_page(page, program, recording, shared):
    """Runs a page; returns the numbers of lines run, run elsewhere, skipped and wrong."""
    run = elsewhere = skipped = wrong = 0
    with tempfile.TemporaryDirectory(prefix="kinloop_docs_") as scratch:
        folder = Path(scratch)
        text = page.read_text()
        prepare(folder, text, program, recording, shared)
        for number, command in [(number, command) for block in shell_blocks(text)
                                for number, line in block for command in commands_of(line)]:
            if any(re.match(pattern, command) for pattern, _ in RUN_ELSEWHERE):
                elsewhere += 1
            elif "STILLS" in command and not (folder / "STILLS").exists():
                print(f"{page}:{number}: skipped, there is no {shared}")
                skipped += 1
            elif not command.startswith("kinloop "):
                print(f"{page}:{number}: not in RUN_ELSEWHERE: {command}")
                wrong += 1
            else:
                run += 1
                if problem := kinloop(program, folder, as_run(command)):
                    print(f"{page}:{number}: {command}: {problem}")
                    wrong += 1
    return run, elsewhere, skipped, wrong


def main():
    program, shared = (Path(argument).resolve() for argument in sys.argv[1:3])
    pages = [Path(name) for name in sys.argv[3:]] or [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
    totals = [0, 0, 0, 0]
    with tempfile.TemporaryDirectory(prefix="kinloop_docs_") as scratch:
        recording = Path(scratch) / "recording"
        subprocess.run([program, "simulate", "room", "-o", recording, "--frames", "40", "--size", "320x240", "-q"],
                       check=True, stdout=subprocess.DEVNULL)
        for page in pages:
            if any(shell_blocks(page.read_text())):
                totals = [sum(pair) for pair in zip(totals, run_page(page, program, recording, shared))]
    print("{} lines run, {} run elsewhere, {} skipped, {} wrong".format(*totals))
    return 1 if totals[3] or not totals[0] else 0


if __name__ == "__main__":
    sys.exit(main())

"""The completion for bash that scripts/make_completion.py writes, asked as bash asks it.

Usage: completion_test.py KINLOOP      skipped (77) without bash
"""
import pathlib
import shutil
import subprocess
import sys
import tempfile

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "scripts" / "make_completion.py"
if not shutil.which("bash"):
    print("skipped: there is no bash")
    sys.exit(77)


def completed(file, *words):
    """What the completion offers for the last word."""
    done = subprocess.run(["bash", "-c", 'source "$0"; COMP_WORDS=(kinloop "$@"); COMP_CWORD=$#; _kinloop 2>/dev/null; '
                           'printf "%s\\n" "${COMPREPLY[@]}"', file, *words], capture_output=True, text=True, check=True)
    return done.stdout.split()


with tempfile.TemporaryDirectory() as folder:
    subprocess.run([sys.executable, SCRIPT, sys.argv[1], folder], check=True)
    file = f"{folder}/kinloop"
    for words, expected in [
            (["ru"], ["run"]),
            (["run", "si"], ["sim:room"]),
            (["run", "sim", ":", "ro"], ["room"]),
            (["run", "kin"], ["kinect1", "kinect2"]),
            (["run", "-o", "out", "oa"], ["oak"]),
            (["probe", "sim"], ["sim:room"]),
            (["map", "locate", "si"], ["sim:room"]),
            (["record", "real"], ["realsense"]),
            (["mesh", "si"], []),
            (["run", "README"], []),  # bash then offers files
            (["run", ""], []),
            (["run", "--view"], ["--viewer"])]:
        assert completed(file, *words) == expected, (words, completed(file, *words), expected)
    names = (pathlib.Path(folder) / "_kinloop").read_text()
    assert "sources:source:(sim\\:room kinect1" in names

"""Shared by the tests of kinloop batch: the package without its compiled module, and a program that stands for kinloop.

The stand-in answers `run` and `eval` in milliseconds, and does what --set fake.do=... says: crash, hang, ...; its figures
depend on the sequence, the options and the seed only. It appends a line to $FAKE_CALLS for each run."""

import contextlib
import io
import os
import pathlib
import stat
import subprocess
import sys
import tempfile
import types
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
PACKAGE = SOURCE / "python" / "kinloop" / "batch"
SKIPPED = 77

try:
    import yaml  # noqa: F401
except ImportError:
    print("skipped: there is no PyYAML: apt install python3-yaml")
    sys.exit(SKIPPED)

_kinloop = types.ModuleType("kinloop")
_kinloop.__path__ = [str(PACKAGE.parent)]
sys.modules["kinloop"] = _kinloop

FAKE_PROGRAM = f"""#!{sys.executable} -IS
import hashlib, json, os, signal, sys, time
words = sys.argv[1:]
if words[:2] == ["run", "--options=all"]:
    print("Options:\\n  seed=1\\n      random seed\\n  features.count=1000\\n      keypoints")
    sys.exit()
if words[0] == "batch":
    os.execv(sys.executable, [sys.executable, {str(PACKAGE)!r}, *words[1:]])
if words[0] == "probe":
    beside = os.path.join(os.path.dirname(words[2]), "calibration.txt")
    sys.exit(sys.stdout.write(open(beside).read()) and 0 if os.path.exists(beside) else "error: no camera")
if words[0] == "eval":
    if not os.path.exists(os.path.join(words[2], "groundtruth.txt")):
        sys.exit("error: no ground truth" if sys.stderr.write("") == 0 else 3)
    print(json.dumps({{"ate": {{"rmse_m": float(open(words[1]).read().split()[1])}}, "coverage": {{"time": 1.0}}}}))
    sys.exit()
if words[0] == "fetch":
    if words[1].endswith("unknown"):
        sys.exit("error: fetch: the server says 404")
    path = os.path.join(words[3], words[1])
    print(path, "licence: none", sep="\\n")
    os.makedirs(path, exist_ok=True)
    sys.exit()
options = dict(words[i + 1].split("=", 1) for i, word in enumerate(words) if word == "--set")
out = words[words.index("-o") + 1]
if calls := os.environ.get("FAKE_CALLS"):
    with open(calls, "a") as file:
        file.write(out + "\\n")
time.sleep(float(options.get("fake.sleep", 0)))
do = options.get("fake.do", "")
if do == "crash":
    os.kill(os.getpid(), signal.SIGSEGV)
if do == "kill":
    os.kill(os.getpid(), signal.SIGKILL)
if do == "kill_once" and not os.path.exists(os.environ["FAKE_ONCE"]):
    open(os.environ["FAKE_ONCE"], "w").close()
    os.kill(os.getpid(), signal.SIGKILL)
if do == "kill_while" and os.path.exists(os.path.join(os.path.dirname(os.environ["FAKE_CALLS"]), "killing")):
    os.kill(os.getpid(), signal.SIGKILL)
if do == "hang":
    time.sleep(1000)
def fail(code, message):
    with open(os.environ["KINLOOP_ERRORS"], "a") as file:
        file.write('{{"code": "' + code + '"}}\\n')
    sys.stderr.write("error: " + message + "\\n")
    sys.exit(3)
if do == "memory":
    try:
        hoard = bytearray(10 ** 9)
    except MemoryError:
        fail("memory", "out of memory")
if do == "limit":
    fail("limit", "too many files are open")
if do == "output":
    fail("output", "x: cannot be written (No space left on device)")
if do == "bad":
    sys.stderr.write("error: " + words[1] + ": no such thing\\n")
    sys.exit(3)
text = json.dumps([os.path.basename(words[1]), options.get("seed"), options.get("features.count", "1000"), "--no-loop" in words])
draw = int(hashlib.sha256(text.encode()).hexdigest()[:8], 16) / 2 ** 32
ate = 0.01 + 0.01 * draw
def write(name, text):
    try:
        with open(os.path.join(out, name), "w") as file:
            file.write(text)
    except OSError as error:
        os.unlink(os.path.join(out, name))
        fail("output", name + ": cannot be written (" + error.strerror + "); is the disk full?")
write("trajectory.txt", f"1.0 {{ate}} 0 0 0 0 0 1\\n")
write("map.ply", str(time.time()) if do == "random" else text.ljust(int(options.get("fake.bytes", 0))))
run = {{"frames": 0 if do == "no_frames" else 100, "tracked": 99, "keyframes": 7, "loops": [1, 2], "cpu_s": 1 + draw, "wall_s": 1.0,
       "frame_ms": {{"median": 5}}, "peak_memory_mib": 100.5, "depth_sensor": "kinect1",
       "quality": {{"verdict": "good", "seconds": 3.3, "seconds_doubtful": 0.1, "seconds_lost": 0}}}}
if do != "no_truth":
    run["evaluation"] = {{"ate": {{"rmse_m": ate}}, "live": {{"ate": {{"rmse_m": 2 * ate}}}}, "coverage": {{"time": 1.0}},
        "rpe_1s": {{"translation": {{"rmse_m": ate}}, "rotation": {{"rmse_deg": 0.5}}}},
        "rpe_1frame": {{"translation": {{"rmse_m": ate / 9}}}}}}
write("run.json", json.dumps(run))
sys.exit(4 if do == "lost" else 0)
"""


@contextlib.contextmanager
def tmpfs(folder, size):
    """A file system of some size, mounted at a new folder. Skips the test where this user may not mount."""
    folder.mkdir()
    mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}", "kinloop_batch", folder], capture_output=True, text=True)
    if mounted.returncode:
        raise unittest.SkipTest(f"no file system can be mounted: {mounted.stderr.strip()}")
    try:
        yield folder
    finally:
        subprocess.run(["umount", folder], check=True)


class BatchTest(unittest.TestCase):
    """A temporary folder with the stand-in for kinloop; `self.batch(...)` runs the command in this process."""

    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="kinloop_batch_")
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        self.program = self.write("kinloop", FAKE_PROGRAM)
        self.program.chmod(self.program.stat().st_mode | stat.S_IXUSR)
        self.calls_file = self.folder / "calls"
        self.environment = {"FAKE_CALLS": str(self.calls_file), "FAKE_ONCE": str(self.folder / "once"),
                            "XDG_STATE_HOME": str(self.folder / "state")}  # fmt: skip
        for name, value in self.environment.items():
            os.environ[name] = value
        self.results = self.folder / "results"

    def write(self, name, text):
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        return path

    def recording(self, name, content="image", truth=True):
        """A folder that stands for a recording."""
        self.write(f"{name}/rgb/1.png", content)
        if truth:
            self.write(f"{name}/groundtruth.txt", "1.0 0 0 0 0 0 0 1\n")
        return self.folder / name

    def batch(self, *words, expect=0):
        """Returns what the command printed on both streams."""
        from kinloop.batch.command import main

        output = io.StringIO()
        with contextlib.redirect_stderr(output), contextlib.redirect_stdout(output):
            code = main([str(word) for word in words])
        self.assertEqual(code, expect, output.getvalue())
        return output.getvalue()

    def run_suite(self, text, *options, expect=0, results=None):
        suite = self.write("suite.yaml", text)
        return self.batch(suite, "-o", results or self.results, "--program", self.program, "--workers", 2, *options, expect=expect)

    def rows(self, results=None):
        from kinloop.batch.tables import read_rows

        return read_rows((results or self.results) / "runs.csv")

    def table(self, results=None):
        """The table without what differs from run to run."""
        from kinloop.batch.tables import COLUMNS

        last = COLUMNS.index("key")
        return [line.split(",")[: last + 1] for line in ((results or self.results) / "runs.csv").read_text().splitlines()]

    def calls(self):
        return self.calls_file.read_text().splitlines() if self.calls_file.exists() else []

    def start(self, *words):
        """Starts the command as a process of its own."""
        call = [sys.executable, str(PACKAGE), *(str(word) for word in words)]
        return subprocess.Popen(call, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)

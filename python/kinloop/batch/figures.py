"""The figures of a run: from run.json of kinloop, or from kinloop eval for other trajectories.

In: the folder of a run. Out: a flat dictionary; a figure that is not known is absent. All but the MEASURED ones are the
same each time that the run is repeated."""

import json
import subprocess

from .files import read_json

# Columns of the tables. `status` comes from execute.py.
FIGURES = ("verdict", "ate_m", "live_ate_m", "rpe_1s_m", "rpe_1s_deg", "rpe_1frame_m", "coverage", "frames", "tracked",
           "doubtful_s", "lost_s", "seconds", "keyframes", "loops", "sensor")  # fmt: skip
MEASURED = ("cpu_s", "wall_s", "frame_ms", "peak_mib", "memory_limit")
TEXTS = {"verdict", "sensor", "memory_limit"}  # the others are numbers
EVAL_PATIENCE_S = 600
LARGEST = 1e100  # so that no sum overflows


def at(value, path):
    """value["a"]["b"] for the path "a.b"; None if it is not there."""
    for name in path.split("."):
        value = value.get(name) if isinstance(value, dict) else None
    return value


def is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool) and -LARGEST < value < LARGEST


def _known(figures):
    """Those that are what they should be; the files that they come from may be damaged."""
    return {name: value for name, value in figures.items() if (isinstance(value, str) if name in TEXTS else is_number(value))}


def checked_result(value):
    """The content of a result.json, with the figures that can be used; None if it is no result."""
    result = {name: at(value, name) for name in ("status", "exit", "files", "figures", "measured")}
    files, figures, measured = result["files"], result["figures"], result["measured"]
    if not isinstance(result["status"], str) or not all(isinstance(part, dict) for part in (files, figures, measured)):
        return None
    known = {name: figure for name, figure in figures.items() if name in FIGURES}
    also = {name: figure for name, figure in measured.items() if name in MEASURED}
    return result | {"exit": str(result["exit"]), "figures": _known(known), "measured": _known(also)}


def of_evaluation(evaluation):
    """The figures of what `kinloop eval --json` prints, which is `evaluation` of run.json, too."""
    return _known({
        "ate_m": at(evaluation, "ate.rmse_m"),
        "live_ate_m": at(evaluation, "live.ate.rmse_m"),
        "rpe_1s_m": at(evaluation, "rpe_1s.translation.rmse_m"),
        "rpe_1s_deg": at(evaluation, "rpe_1s.rotation.rmse_deg"),
        "rpe_1frame_m": at(evaluation, "rpe_1frame.translation.rmse_m"),
        "coverage": at(evaluation, "coverage.time"),
    })  # fmt: skip


def of_run(folder):
    """(figures, measured) of run.json; None if there is none."""
    run = read_json(folder / "run.json")
    if not isinstance(run, dict):
        return None
    loops = at(run, "loops")
    figures = _known({
        "verdict": at(run, "quality.verdict"),
        "frames": at(run, "frames"),
        "tracked": at(run, "tracked"),
        "doubtful_s": at(run, "quality.seconds_doubtful"),
        "lost_s": at(run, "quality.seconds_lost"),
        "seconds": at(run, "quality.seconds"),
        "keyframes": at(run, "keyframes"),
        "loops": len(loops) if isinstance(loops, list) else None,
        "sensor": at(run, "depth_sensor"),
    })  # fmt: skip
    measured = _known({"cpu_s": at(run, "cpu_s"), "wall_s": at(run, "wall_s"), "frame_ms": at(run, "frame_ms.median"),
                       "peak_mib": at(run, "peak_memory_mib")})  # fmt: skip
    return figures | of_evaluation(run.get("evaluation")), measured


def score(program, trajectory, truth, log):
    """The figures of a trajectory by `kinloop eval`; empty, with its message in the log, if it cannot be scored."""
    try:
        done = subprocess.run([program, "eval", str(trajectory), str(truth), "--json"], capture_output=True, text=True,
                              timeout=EVAL_PATIENCE_S, check=False, errors="replace")  # fmt: skip
        with open(log, "a") as file:
            file.write(done.stderr)
        return of_evaluation(json.loads(done.stdout)) if done.returncode == 0 else {}
    except (subprocess.TimeoutExpired, ValueError) as error:
        with open(log, "a") as file:
            file.write(f"kinloop eval: {error}\n")
        return {}

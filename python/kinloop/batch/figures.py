"""The figures of a run: from run.json of kinloop, or from kinloop eval for other trajectories.

In: the folder of a run. Out: a flat dictionary; a figure that is not known is absent. All but the MEASURED ones are the
same each time that the run is repeated."""

import json
import math
import subprocess

from .files import read_json

# Columns of the tables. `status` comes from execute.py.
FIGURES = ("verdict", "ate_m", "live_ate_m", "rpe_1s_m", "rpe_1s_deg", "rpe_1frame_m", "coverage", "frames", "tracked",
           "doubtful_s", "lost_s", "seconds", "keyframes", "loops", "sensor")  # fmt: skip
MEASURED = ("cpu_s", "wall_s", "frame_ms", "peak_mib", "memory_limit")
EVAL_PATIENCE_S = 600


def at(value, path):
    """value["a"]["b"] for the path "a.b"; None if it is not there or not a number, text or list."""
    for name in path.split("."):
        value = value.get(name) if isinstance(value, dict) else None
    if isinstance(value, bool) or not isinstance(value, (int, float, str, list)):
        return None
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _known(figures):
    return {name: value for name, value in figures.items() if value is not None}


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

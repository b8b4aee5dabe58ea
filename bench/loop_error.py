"""Which loops of a run are false, by ground truth. Needs numpy."""

import json

import numpy as np
import trajectory_error

FALSE_M, FALSE_RAD = 0.1, np.radians(5)  # that a loop measures off; verified ones of a good run are 1 to 3 cm off


def measured_loops(run):
    """(stamp a, stamp b, rotation, translation) of each loop: the last edges of graph.g2o, in the order of run.json."""
    loops = json.loads((run / "run.json").read_text())["loops"]
    if not loops:
        return
    edges = [line.split() for line in (run / "graph.g2o").read_text().splitlines() if line.startswith("EDGE")]
    for loop, edge in zip(loops, edges[-len(loops):], strict=True):
        pose = np.array(edge[3:10], float)
        yield float(loop["stamp_a"]), float(loop["stamp_b"]), trajectory_error.rotations_of(pose[None, 3:])[0], pose[:3]


def count_false_loops(run, truth_file):
    """The loops of the run in folder `run` that measure another relative pose than the true one."""
    truth, false = trajectory_error.read_path(truth_file), 0
    for stamp_a, stamp_b, rotation, translation in measured_loops(run):
        a, b = (int(np.argmin(abs(truth.stamps_s - stamp_s))) for stamp_s in (stamp_a, stamp_b))
        true_rotation = truth.rotations[a].T @ truth.rotations[b]
        true_translation = truth.rotations[a].T @ (truth.centers[b] - truth.centers[a])
        turned_rad = np.arccos(np.clip((np.trace(true_rotation.T @ rotation) - 1) / 2, -1, 1))
        false += bool(np.linalg.norm(translation - true_translation) > FALSE_M or turned_rad > FALSE_RAD)
    return false

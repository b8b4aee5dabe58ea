"""Errors of a trajectory of which a part may be wrong: a rigid alignment that the wrong part does not bend.

In: estimate and ground truth as TUM files, and the frames.txt of a run. Out: the error of every frame, and which of the
frames that are called tracked are silently wrong. Needs numpy."""

from dataclasses import dataclass

import numpy as np

SILENT_M, SILENT_SIGMAS = 0.05, 4  # a silent error is more than both
COVERAGES = (0.5, 0.8, 0.95, 1.0)  # shares of all frames
AVAILABLE_M = 0.05  # the most that the pose of an available frame is off
WORDS = {"status", "cause"}  # of the columns of frames.txt; the others are numbers
NOT_TRACKED = {"lost", "doubtful", "dropped", "skipped"}  # of the statuses in frames.txt
MOST_BETWEEN_S = 0.05  # truth is interpolated only next to a pose of it
ARM_M = 0.1  # how much an orientation counts in an alignment: as points so far from the camera
SCALES_M = (0.1, 0.05, 0.02)  # of the robust loss, from coarse to fine; the error of a good run is about 1 cm
HYPOTHESES, REFINED = 200, 5


@dataclass
class Path:
    """Camera poses in the world, in order of time."""

    stamps_s: np.ndarray
    centers: np.ndarray  # n x 3, m
    rotations: np.ndarray  # n x 3 x 3

    def __len__(self):
        return len(self.stamps_s)

    def of(self, selection):
        return Path(self.stamps_s[selection], self.centers[selection], self.rotations[selection])

    def points(self):
        """The camera centres and three points in front, beside and below of each: (n, 4, 3)."""
        arms = np.swapaxes(self.rotations, 1, 2) * ARM_M
        return np.concatenate([self.centers[:, None], self.centers[:, None] + arms], 1)


def rotations_of(quaternions):
    """Rotation matrices of quaternions x y z w."""
    x, y, z, w = (quaternions / np.linalg.norm(quaternions, axis=1, keepdims=True)).T
    rows = [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]
    return np.moveaxis(np.array(rows), 2, 0)


def read_path(file):
    lines = [line.split()[:8] for line in file.read_text().splitlines() if line.strip() and line[0] != "#"]
    table = np.array(lines, float).reshape(-1, 8)
    table = table[np.argsort(table[:, 0], kind="stable")]
    return Path(table[:, 0], table[:, 1:4], rotations_of(table[:, 4:]))


def matched(estimate, truth):
    """The poses of both at the stamps of the estimate, where there is truth."""
    after = np.searchsorted(truth.stamps_s, estimate.stamps_s).clip(1, len(truth) - 1)
    nearer_before = estimate.stamps_s - truth.stamps_s[after - 1] < truth.stamps_s[after] - estimate.stamps_s
    nearest = after - nearer_before
    known = abs(truth.stamps_s[nearest] - estimate.stamps_s) <= MOST_BETWEEN_S
    centers = np.stack([np.interp(estimate.stamps_s, truth.stamps_s, axis) for axis in truth.centers.T], 1)
    return estimate.of(known), Path(estimate.stamps_s, centers, truth.rotations[nearest]).of(known)


def fit(points, targets, weights):
    """The rigid motion (rotation, translation) that takes points to targets by least squares (Kabsch, Umeyama)."""
    weights = (weights / weights.sum())[:, None]
    middle, target_middle = (weights * points).sum(0), (weights * targets).sum(0)
    u, _, vt = np.linalg.svd((weights * (targets - target_middle)).T @ (points - middle))
    rotation = u @ np.diag([1, 1, np.linalg.det(u @ vt)]) @ vt
    return rotation, target_middle - rotation @ middle


def errors_m(motion, estimate, truth):
    return np.linalg.norm(estimate.centers @ motion[0].T + motion[1] - truth.centers, axis=1)


def least_squares(estimate, truth):
    """The alignment of the usual absolute trajectory error: by all centres."""
    return fit(estimate.centers, truth.centers, np.ones(len(estimate)))


def count_of(sigmas_m, scale_m):
    """How much a frame with this sigma counts, relative to an exact one. It is squared because the errors of uncertain
    frames are common to many: they do not average out."""
    return (scale_m**2 / (scale_m**2 + sigmas_m**2)) ** 2


def agreement(motion, estimate, truth, sigmas_m, scale_m):
    """From 1 for a frame without an error to 0 (Geman-McClure)."""
    return 1 / (1 + errors_m(motion, estimate, truth) ** 2 / (scale_m**2 + sigmas_m**2))


def support(motion, estimate, truth, sigmas_m, scale_m):
    """Frames that agree, those with an error or with a large sigma counted less."""
    return (count_of(sigmas_m, scale_m) * agreement(motion, estimate, truth, sigmas_m, scale_m)).sum()


def refine(motion, estimate, truth, sigmas_m):
    """Iteratively reweighted least squares with the weights of Geman-McClure."""
    points, targets = estimate.points().reshape(-1, 3), truth.points().reshape(-1, 3)
    for scale_m in SCALES_M:
        for _ in range(10):
            weights = count_of(sigmas_m, scale_m) * agreement(motion, estimate, truth, sigmas_m, scale_m) ** 2
            motion = fit(points, targets, np.repeat(weights, 4))
    return motion


def robust(estimate, truth, sigmas_m=0.0):
    """The alignment on which most frames agree, by their sigmas: those are relative to the first keyframe, so a part of
    the trajectory that claims to be uncertain must not decide where the world is. Hypotheses are those of single
    frames, whose poses are known."""
    motions = [least_squares(estimate, truth)]
    for i in np.unique(np.linspace(0, len(estimate) - 1, HYPOTHESES).round().astype(int)):
        rotation = truth.rotations[i] @ estimate.rotations[i].T
        motions.append((rotation, truth.centers[i] - rotation @ estimate.centers[i]))
    motions.sort(key=lambda motion: -support(motion, estimate, truth, sigmas_m, SCALES_M[1]))
    refined = [refine(motion, estimate, truth, sigmas_m) for motion in motions[:REFINED]]
    return max(refined, key=lambda motion: support(motion, estimate, truth, sigmas_m, SCALES_M[-1]))


def rmse(errors):
    return float(np.sqrt(np.mean(np.square(errors)))) if len(errors) else None


def read_frames(file):
    """The rows of frames.txt by the names in its header; numbers as floats."""
    lines = file.read_text().splitlines()
    names = next(line for line in lines if line.startswith("#"))[1:].split()
    rows = [dict(zip(names, line.split())) for line in lines if line.strip() and line[0] != "#"]
    return [{key: value if key in WORDS else float(value) for key, value in row.items()} for row in rows]


def component_errors_m(estimate, truth, components, sigmas_m=0.0):
    """The error of each frame, aligned robustly; each component of the map by itself."""
    sigmas_m = np.broadcast_to(sigmas_m, len(estimate))
    errors = np.zeros(len(estimate))
    for component in np.unique(components):
        own = components == component
        errors[own] = errors_m(robust(estimate.of(own), truth.of(own), sigmas_m[own]), estimate.of(own), truth.of(own))
    return errors


def silent_errors(errors, sigmas_m, called_tracked):
    """Which frames are called tracked and are more than 5 cm and 4 sigma off."""
    return called_tracked & (errors > SILENT_M) & (errors > SILENT_SIGMAS * sigmas_m)


def evaluate(run, truth_file, interval_s=None):
    """Errors of the run in folder `run`; also without the frames of `interval_s`, when it was disturbed."""
    rows = read_frames(run / "frames.txt")
    estimate, truth = matched(read_path(run / "trajectory.txt"), read_path(truth_file))
    by_stamp = {round(row["stamp_s"] * 1e6): row for row in rows}
    posed = [by_stamp.get(round(stamp * 1e6), {}) for stamp in estimate.stamps_s]
    tracked = np.array([row.get("status", "lost") not in NOT_TRACKED for row in posed], bool)
    result = {"frames": len(rows), "posed": len(estimate), **count_statuses(rows),
              "marked_share": marked_share(rows, interval_s)}
    if len(estimate) < 3:
        return {**result, "silent": 0, "silent_share": 0.0, "available": 0}
    sigmas_m = np.array([row.get("sigma_m", 0.0) for row in posed])
    errors = component_errors_m(estimate, truth, np.array([row.get("component", 0) for row in posed]), sigmas_m)
    silent = silent_errors(errors, sigmas_m, tracked)
    doubtful = np.array([row.get("status", "doubtful") == "doubtful" for row in posed], bool)
    outside = np.ones(len(estimate), bool)
    if interval_s:
        outside = ~is_within(estimate.stamps_s, interval_s)
    return {**result, "ate_m": rmse(errors_m(least_squares(estimate, truth), estimate, truth)),
            "ate_outside_m": ate_m(estimate.of(outside), truth.of(outside)), "median_m": float(np.median(errors)),
            "worst_m": float(errors[tracked].max(initial=0)), "silent": int(silent.sum()),
            "silent_share": float(silent.sum() / max(1, result["tracked"])),
            "available": int((~doubtful & (errors <= AVAILABLE_M)).sum()),
            "coverage_m": errors_at_coverage_m(errors, sigmas_m, doubtful, len(rows))}


def errors_at_coverage_m(errors, sigmas_m, doubtful, frames):
    """The rms error of the most certain frames that make up a share of all: risk and coverage. None where fewer have a
    pose that is not doubtful."""
    by_risk = errors[~doubtful][np.argsort(sigmas_m[~doubtful], kind="stable")]
    counts = {share: round(share * frames) for share in COVERAGES}
    return {f"{share:.0%}": rmse(by_risk[:count]) if 0 < count <= len(by_risk) else None for share, count in counts.items()}


def is_within(stamp_s, interval_s):
    """Stamps are written with microseconds."""
    return (stamp_s > interval_s[0] - 1e-5) & (stamp_s < interval_s[1] + 1e-5)


def ate_m(estimate, truth):
    return rmse(errors_m(least_squares(estimate, truth), estimate, truth)) if len(estimate) >= 3 else None


def count_statuses(rows):
    statuses = [row["status"] for row in rows]
    return {"tracked": sum(status not in NOT_TRACKED for status in statuses),
            "doubtful": statuses.count("doubtful"), "lost": statuses.count("lost")}


def marked_share(rows, interval_s):
    """The share of the disturbed frames that are not called tracked."""
    if not interval_s:
        return None
    disturbed = [row["status"] in NOT_TRACKED for row in rows if is_within(row["stamp_s"], interval_s)]
    return sum(disturbed) / len(disturbed) if disturbed else None

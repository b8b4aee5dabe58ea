"""Simulated rooms with and without what moves in them, and motions of the camera that are hard to follow. Needs numpy."""

import subprocess

import numpy as np
from runs import settings

EMPTY = "empty"
VARIANTS = {"room": [], EMPTY: ["spacious=true"], "people": ["movers.people=2"],
            "all": ["movers.people=2", "movers.door=true", "movers.chairs=2"]}  # "empty" is the room of the last two
HEIGHT_M, FPS = 1.4, 30


def camera_axes(heading_rad, pitch_rad, roll_rad):
    """The quaternion x y z w of a camera (x right, y down, z forward) in a world with z up."""
    def turn(axis, angle_rad):
        return np.append(np.sin(angle_rad / 2) * np.eye(3)[axis], np.cos(angle_rad / 2))

    def product(a, b):
        return np.append(a[3] * b[:3] + b[3] * a[:3] + np.cross(a[:3], b[:3]), a[3] * b[3] - a[:3] @ b[:3])

    level = np.array([-0.5, 0.5, -0.5, 0.5])  # forward is x of the world
    axes = product(product(turn(2, heading_rad), level), turn(0, pitch_rad))
    return product(axes, turn(2, roll_rad))


def rotations(seed):
    """Fast rotations about all axes, hardly any translation, like freiburg1_rpy: up to 100 degrees a second."""
    rng = np.random.default_rng(seed)
    phases, start_rad = rng.uniform(0, 2 * np.pi, 3), rng.uniform(0, 2 * np.pi)
    for t in np.arange(0, 15, 1 / FPS):
        heading, pitch, roll = (0.8, 0.4, 0.45) * np.sin(2 * np.pi * np.array([0.25, 0.37, 0.31]) * t + phases)
        sway_m = 0.04 * np.sin(2 * np.pi * np.array([0.2, 0.26, 0.23]) * t + phases)
        yield t, sway_m + (0, 0, HEIGHT_M), camera_axes(start_rad + heading, pitch, roll)


DIVE_BEGIN_S, DIVE_S = 6.0, 3.0


def dive(seed):
    """Along a side of the room, down under a desk and back up within 3 s, and on."""
    start_rad = np.random.default_rng(seed).uniform(0, 2 * np.pi)
    for t in np.arange(0, 15, 1 / FPS):
        phase = np.clip((t - DIVE_BEGIN_S) / DIVE_S, 0, 1)
        down = np.sin(np.pi * phase) ** 2
        center = np.array([0.08 * t - 0.6, 0.3 * np.sin(0.4 * t), HEIGHT_M - 0.7 * down])
        yield t, center, camera_axes(start_rad + 0.3 * np.sin(0.5 * t), -0.5 * down, 0.1 * np.sin(0.9 * t))


MOTIONS = {"rotations": rotations, "dive": dive}


def write_motion(name, seed, file):
    """A trajectory in TUM format for `kinloop simulate --path`."""
    lines = (f"{1 + t:.6f} " + " ".join(f"{value:.6f}" for value in (*center, *axes))
             for t, center, axes in MOTIONS[name](seed))
    file.write_text("\n".join(lines) + "\n")


def simulate_room(program, variant, seed, folder, arguments):
    """Renders the room of a seed into a folder, or the room around a motion."""
    call = [program, "simulate", "room", "--seed", str(seed), "-o", folder, "-q", *arguments]
    if variant in MOTIONS:
        path = folder.with_suffix(".path")
        write_motion(variant, seed, path)
        call += ["--path", path]
    subprocess.run([*call, *settings(VARIANTS.get(variant, []))], check=True)
    return folder

"""Simulated rooms with and without what moves in them, and motions of the camera that are hard to follow. Needs numpy and Pillow."""

import subprocess

import numpy as np
from look_alikes import motion, turn, write_path
from runs import settings

EMPTY = "empty"
VARIANTS = {"room": [], EMPTY: ["spacious=true"], "people": ["movers.people=2"],
            "all": ["movers.people=2", "movers.door=true", "movers.chairs=2"]}  # "empty" is the room of the last two
HEIGHT_M, FPS = 1.4, 30


def camera_pose(center, heading_rad, pitch_rad, roll_rad):
    """A camera (x right, y down, z forward) in a world with z up."""
    forward_is_x = np.array([[0, 0, 1], [-1, 0, 0], [0, -1, 0]])
    rotation = turn(np.array([0, 0, heading_rad])) @ forward_is_x @ turn(np.array([pitch_rad, 0, 0]))
    return motion(rotation @ turn(np.array([0, 0, roll_rad])), center)


def rotations(seed):
    """Fast rotations about all axes, hardly any translation, like freiburg1_rpy: up to 100 degrees a second."""
    rng = np.random.default_rng(seed)
    phases, start_rad = rng.uniform(0, 2 * np.pi, 3), rng.uniform(0, 2 * np.pi)
    for t in np.arange(0, 15, 1 / FPS):
        heading, pitch, roll = (0.8, 0.4, 0.45) * np.sin(2 * np.pi * np.array([0.25, 0.37, 0.31]) * t + phases)
        sway_m = 0.04 * np.sin(2 * np.pi * np.array([0.2, 0.26, 0.23]) * t + phases)
        yield 1 + t, camera_pose(sway_m + (0, 0, HEIGHT_M), start_rad + heading, pitch, roll)


DIVE_BEGIN_S, DIVE_S = 6.0, 3.0


def dive(seed):
    """Along a side of the room, down under a desk and back up within 3 s, and on."""
    start_rad = np.random.default_rng(seed).uniform(0, 2 * np.pi)
    for t in np.arange(0, 15, 1 / FPS):
        phase = np.clip((t - DIVE_BEGIN_S) / DIVE_S, 0, 1)
        down = np.sin(np.pi * phase) ** 2
        center = np.array([0.08 * t - 0.6, 0.3 * np.sin(0.4 * t), HEIGHT_M - 0.7 * down])
        yield 1 + t, camera_pose(center, start_rad + 0.3 * np.sin(0.5 * t), -0.5 * down, 0.1 * np.sin(0.9 * t))


MOTIONS = {"rotations": rotations, "dive": dive}


def simulate_room(program, variant, seed, folder, arguments):
    """Renders the room of a seed into a folder, or the room around a motion."""
    call = [program, "simulate", "room", "--seed", str(seed), "-o", folder, "-q", *arguments]
    if variant in MOTIONS:
        path = folder.with_suffix(".path")
        write_path(path, *zip(*MOTIONS[variant](seed)))
        call += ["--path", path]
    subprocess.run([*call, *settings(VARIANTS.get(variant, []))], check=True)
    return folder

"""Simulated rooms with and without what moves in them."""

import subprocess

from runs import settings

EMPTY = "empty"
VARIANTS = {"room": [], EMPTY: ["spacious=true"], "people": ["movers.people=2"],
            "all": ["movers.people=2", "movers.door=true", "movers.chairs=2"]}  # "empty" is the room of the last two


def simulate_room(program, variant, seed, folder, arguments):
    """Renders the room of a seed into a folder."""
    call = [program, "simulate", "room", "--seed", str(seed), "-o", folder, "-q", *arguments]
    subprocess.run([*call, *settings(VARIANTS[variant])], check=True)
    return folder

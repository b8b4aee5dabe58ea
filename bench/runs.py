"""What the benchmarks that run the program have in common."""


def is_unseen(seed):
    """Every third seed: nothing may be chosen on it."""
    return seed is not None and seed % 3 == 2


def parse_seeds(text):
    """The numbers of 0-4,7."""
    seeds = []
    for word in text.split(","):
        first, _, last = word.partition("-")
        seeds += range(int(first), int(last or first) + 1)
    return seeds


def settings(assignments):
    """The arguments of the program for options KEY=VALUE."""
    return [word for assignment in assignments for word in ("--set", assignment)]

"""Compares two batches, such as those of two versions of the program: the gate of a CI.

In: two folders of results, and thresholds. Out: a text, and whether the second is worse."""

import os
from dataclasses import dataclass
from pathlib import Path

from .errors import BatchError
from .statistics import SMALLEST_M, bootstrap_ratio, has_failed, pairs_of, summarise_sequences
from .tables import read_rows

REGRESSION_EXIT_CODE = 5
WORST_SHOWN = 5


@dataclass
class Thresholds:
    """What the second batch may be worse by. `cpu_ratio`: 0 = any."""

    ate_ratio: float = 1.05
    sequence_ratio: float = 1.5
    failures: int = 0
    cpu_ratio: float = 0.0


def read_summaries(path):
    """The summaries of the sequences of a folder of results, or of a runs.csv."""
    file = Path(path) / "runs.csv" if os.path.isdir(path) else Path(path)
    try:
        rows = read_rows(file)
    except (OSError, ValueError) as error:
        raise BatchError(f"{file}: cannot be read ({getattr(error, 'strerror', None) or error}); kinloop batch table writes it") from None
    return summarise_sequences(rows)


def _prepared(summaries):
    """Sequences and variants of a batch as one list of sequences, so that each is paired with itself."""
    return [s | {"dataset": "", "sequence": (s["sequence"], s["variant"])} for s in summaries]


def compare(before, after, thresholds):
    """Returns (lines, faults): what there is to see, and what exceeds a threshold."""
    before, after = _prepared(before), _prepared(after)
    old = {s["sequence"]: s for s in before}
    common = [s for s in after if s["sequence"] in old]
    if not common:
        raise BatchError("the two have no sequence and variant in common; did they run the same suite?")
    lines = [f"{len(common)} sequences in common, {len(before) - len(common)} only in the first, "
             f"{len(after) - len(common)} only in the second"]  # fmt: skip
    faults = _of_failures(old, common, thresholds, lines)
    faults += _of_ratios(old, before, common, thresholds, lines)
    return lines, faults


def _of_failures(old, common, thresholds, lines):
    new = [s for s in common if has_failed(s) and not has_failed(old[s["sequence"]])]
    mended = [s for s in common if not has_failed(s) and has_failed(old[s["sequence"]])]
    lines.append(f"failures   {len(new)} new, {len(mended)} gone")
    lines += [f"  fails now: {', '.join(s['sequence'])}" for s in new[:WORST_SHOWN]]
    return [f"{len(new)} new failures, {thresholds.failures} allowed"] if len(new) > thresholds.failures else []


def _of_ratios(old, before, common, thresholds, lines):
    faults = []
    ratio, low, high = bootstrap_ratio(pairs_of(before, common))
    if ratio is not None:
        lines.append(f"ATE        ratio {ratio:.3f} (95 %: {low:.3f} to {high:.3f})")
        if ratio > thresholds.ate_ratio and low > 1:
            faults.append(f"the ATE is {ratio:.3f} times that of the first, {thresholds.ate_ratio:g} allowed")
    both = [s for s in common if not has_failed(s) and not has_failed(old[s["sequence"]])]
    pairs = [(max(old[s["sequence"]]["ate_m"], SMALLEST_M), s["ate_m"], s) for s in both]
    for a, b, s in sorted(pairs, key=lambda pair: -pair[1] / pair[0])[:WORST_SHOWN]:
        name = ", ".join(s["sequence"])
        lines.append(f"  {b / a:6.3f}  {a:.4f} -> {b:.4f} m  {name}")
        if b / a > thresholds.sequence_ratio:
            faults.append(f"{name}: ATE {b / a:.3f} times that of the first, {thresholds.sequence_ratio:g} allowed")
    cpu, *_ = bootstrap_ratio(pairs_of(before, common, "cpu_s"))
    if cpu is not None:
        lines.append(f"CPU        ratio {cpu:.3f}")
        if thresholds.cpu_ratio and cpu > thresholds.cpu_ratio:
            faults.append(f"the CPU time is {cpu:.3f} times that of the first, {thresholds.cpu_ratio:g} allowed")
    return faults

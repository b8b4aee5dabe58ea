"""Medians over seeds, means over datasets, areas under the curve, and paired bootstraps.

In: rows of runs.csv. Out: rows of sequences.csv (one a sequence and variant) and variants.csv (one a variant)."""

import math
import random
import statistics

SUMMARISED = ("ate_m", "live_ate_m", "rpe_1s_m", "rpe_1s_deg", "coverage", "doubtful_s", "lost_s", "cpu_s", "wall_s", "peak_mib")
SPREAD = ("ate_m", "live_ate_m")
AUC_LIMITS_CM = (0.5, 2.0, 8.0)  # those of the plots of the ETH3D SLAM benchmark
SMALLEST_M = 1e-6  # of an error in a ratio
SAMPLES = 2000
SEQUENCE_COLUMNS = ("dataset", "sequence", "variant", "runs", "failed", *SUMMARISED,
                    *(f"{name}_{end}" for name in SPREAD for end in ("low", "high")))  # fmt: skip
VARIANT_COLUMNS = ("variant", "dataset", "sequences", "failed", "mean_ate_m", "mean_live_ate_m", "mean_coverage", "cpu_s",
                   *(f"auc_{limit:g}cm" for limit in AUC_LIMITS_CM), "ratio", "ratio_low", "ratio_high")  # fmt: skip


def median(values):
    """The median of the values that are known; None if none is."""
    known = [value for value in values if value is not None]
    return statistics.median(known) if known else None


def grouped(rows, *names):
    """The rows by the values of some columns, in the order of their first rows."""
    groups = {}
    for row in rows:
        groups.setdefault(tuple(row[name] for name in names), []).append(row)
    return groups


def summarise_sequences(rows):
    """A row for each sequence and variant: medians over its seeds, the lowest and the highest error, and failures. A
    sequence has failed if no more than half of its runs have an error."""
    summaries = []
    for (dataset, sequence, variant), group in grouped(rows, "dataset", "sequence", "variant").items():
        summary = {"dataset": dataset, "sequence": sequence, "variant": variant, "runs": len(group)}
        summary |= {name: median(row[name] for row in group) for name in SUMMARISED}
        summary["failed"] = sum(row["ate_m"] is None for row in group)
        for name in SPREAD:
            known = [row[name] for row in group if row[name] is not None]
            summary |= {f"{name}_low": min(known, default=None), f"{name}_high": max(known, default=None)}
        summaries.append(summary)
    return summaries


def has_failed(summary):
    return 2 * summary["failed"] >= summary["runs"]


def area_under_curve(summaries, limit_cm):
    """The area under the number of sequences with an error of at most x, for x from 0 to `limit_cm`, as the ETH3D SLAM
    benchmark gives it, in cm x sequences: a sequence counts as its distance below the limit, a failure as 0."""
    return sum(max(0.0, limit_cm - 100 * s["ate_m"]) for s in summaries if not has_failed(s))


def mean(values):
    known = [value for value in values if value is not None]
    return sum(known) / len(known) if known else None


def bootstrap_ratio(pairs):
    """The geometric mean of b/a over pairs (a, b), and its 95 % interval by 2000 resamplings of the pairs."""
    logs = [math.log(max(b, SMALLEST_M) / max(a, SMALLEST_M)) for a, b in pairs]
    if not logs:
        return None, None, None
    rng = random.Random(1)
    means = sorted(sum(rng.choices(logs, k=len(logs))) / len(logs) for _ in range(SAMPLES))
    low, high = means[int(0.025 * SAMPLES)], means[int(0.975 * SAMPLES) - 1]
    return math.exp(sum(logs) / len(logs)), math.exp(low), math.exp(high)


def pairs_of(before, after, name="ate_m"):
    """(a, b) of each sequence that has the figure in both, by (dataset, sequence) of the summaries."""
    first = {(s["dataset"], s["sequence"]): s for s in before if not has_failed(s)}
    pairs = [(first.get((s["dataset"], s["sequence"])), s) for s in after if not has_failed(s)]
    return [(a[name], b[name]) for a, b in pairs if a and a[name] is not None and b[name] is not None]


def _variant_row(variant, dataset, summaries, baseline):
    good = [s for s in summaries if not has_failed(s)]
    ratio, low, high = bootstrap_ratio(pairs_of(baseline, summaries)) if baseline is not summaries else (None, None, None)
    row = {"variant": variant, "dataset": dataset, "sequences": len(summaries), "failed": len(summaries) - len(good),
           "mean_ate_m": mean(s["ate_m"] for s in good), "mean_live_ate_m": mean(s["live_ate_m"] for s in good),
           "mean_coverage": mean(s["coverage"] for s in good), "cpu_s": sum(s["cpu_s"] or 0.0 for s in summaries),
           "ratio": ratio, "ratio_low": low, "ratio_high": high}  # fmt: skip
    return row | {f"auc_{limit:g}cm": area_under_curve(summaries, limit) for limit in AUC_LIMITS_CM}


def summarise_variants(summaries):
    """A row for each variant and dataset, and for each variant over all; `ratio`: its errors over those of the first
    variant, in pairs of sequences."""
    rows = []
    by_variant = grouped(summaries, "variant")
    first = next(iter(by_variant.values()), [])
    for (variant,), group in by_variant.items():
        datasets = grouped(group, "dataset")
        for (dataset,), part in datasets.items():
            of_first = first if group is first else [s for s in first if s["dataset"] == dataset]
            rows.append(_variant_row(variant, dataset, part, part if group is first else of_first))
        if len(datasets) > 1:
            rows.append(_variant_row(variant, "all", group, first))
    return rows

"""A table as papers print it: a row a sequence, a column a variant, the mean of each dataset below its rows."""

from .statistics import grouped, has_failed, mean
from .text import latex_of


def _centimetres(value):
    return "--" if value is None else f"{100 * value:.2f}"


def _cells(errors):
    """The errors as text, the smallest in bold."""
    known = [error for error in errors if error is not None]
    texts = [_centimetres(error) for error in errors]
    best = _centimetres(min(known)) if len(known) > 1 else None
    return [rf"\textbf{{{text}}}" if text == best else text for text in texts]


def latex_table(summaries):
    """ATE RMSE in cm, medians over seeds. `--`: failed; a mean leaves failures out and counts them in brackets."""
    variants = [variant for (variant,) in grouped(summaries, "variant")]
    lines = [r"% ATE RMSE in cm, median over seeds; --: failed; (n): number of failures that a mean leaves out",
             rf"\begin{{tabular}}{{l{'r' * len(variants)}}}", r"\toprule",
             " & ".join(["sequence", *map(latex_of, variants)]) + r" \\"]  # fmt: skip
    for (dataset,), group in grouped(summaries, "dataset").items():
        lines += [r"\midrule", rf"\multicolumn{{{len(variants) + 1}}}{{l}}{{{latex_of(dataset)}}} \\"]
        columns = {variant: [] for variant in variants}
        for (sequence,), rows in grouped(group, "sequence").items():
            errors = {row["variant"]: None if has_failed(row) else row["ate_m"] for row in rows}
            for variant in variants:
                columns[variant].append(errors.get(variant))
            lines.append(" & ".join([latex_of(sequence), *_cells([errors.get(v) for v in variants])]) + r" \\")
        failures = [sum(error is None for error in columns[v]) for v in variants]
        means = [_centimetres(mean(columns[v])) + (f" ({n})" if n else "") for v, n in zip(variants, failures)]
        lines.append(" & ".join([r"\textit{mean}", *means]) + r" \\")
    return "\n".join([*lines, r"\bottomrule", r"\end{tabular}", ""])

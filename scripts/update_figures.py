#!/usr/bin/env python3
"""Writes the figures of a batch into the documents, or checks that they are there.

    kinloop batch bench/suites/docs.yaml -o RESULTS
    scripts/update_figures.py RESULTS [--check] [FILE.md...]        (default: README.md, docs/measurements.md)

The lines between `<!-- figures: NAME -->` and `<!-- end of figures -->` are replaced by table NAME: `main` or `short`.
--check writes nothing and ends with 1 if a figure is not that of RESULTS; times and memory, which differ from run to
run, may. The exit code is 3 for bad input."""

import argparse
import csv
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
DOCUMENTS = (ROOT / "README.md", ROOT / "docs" / "measurements.md")
BLOCK = re.compile(r"(?P<begin><!-- figures: (?P<name>[\w-]*) -->\n)(?P<text>.*?)(?P<end><!-- end of figures -->\n)", re.DOTALL)
MARK = re.compile(r"<!-- (?:figures: |end of figures)")


class BadInput(Exception):
    """The message names the file and the remedy."""


def rounded(text, decimals):
    return f"{float(text):.{decimals}f}" if text else ""


def name_of(row, before):
    """A variant of the sequence in the row above has only its own name."""
    variant = "" if row["variant"] == "default" else f", `{row['variant']}`"
    same = before is not None and before["sequence"] == row["sequence"]
    return ("the same" if same else f"`{row['sequence']}`") + variant


# Columns: heading, and the text of a row.
FIGURES = {
    "tracked": lambda row: f"{row['tracked']} / {row['frames']}",
    "keyframes": lambda row: row["keyframes"],
    "loops": lambda row: row["loops"],
    "ATE m": lambda row: rounded(row["ate_m"], 4) or row["status"],
    "live ATE m": lambda row: rounded(row["live_ate_m"], 4),
    "CPU s": lambda row: rounded(row["cpu_s"], 1),
    "peak MiB": lambda row: rounded(row["peak_mib"], 0),
}
MEASURED = {"CPU s", "peak MiB"}
TABLES = {
    "main": (lambda row: True, tuple(FIGURES)),
    "short": (lambda row: row["variant"] == "default", ("tracked", "ATE m", "live ATE m")),
}


def table(name, rows):
    """The text of a table."""
    choose, columns = TABLES[name]
    lines, before = ["| " + " | ".join(["run", *columns]) + " |", "|" + "---|" * (1 + len(columns))], None
    for row in filter(choose, rows):
        lines.append("| " + " | ".join([name_of(row, before), *(FIGURES[column](row) for column in columns)]) + " |")
        before = row
    return "".join(line + "\n" for line in lines)


def without_measured(text):
    """The cells of a table but those that differ from run to run."""
    lines = [[cell.strip() for cell in line.strip().strip("|").split("|")] for line in text.splitlines()]
    keep = [heading not in MEASURED for heading in lines[0]] if lines else []
    return [[cell for cell, kept in zip(line, keep) if kept] + line[len(keep):] for line in lines]  # fmt: skip


def read_rows(results):
    file = Path(results) / "runs.csv"
    try:
        with open(file, newline="", encoding="utf-8") as lines:
            rows = list(csv.DictReader(lines))
        if not rows or any(row["status"] == "not run" for row in rows):
            raise BadInput(f"{file}: not all runs are finished; run kinloop batch bench/suites/docs.yaml -o {results}")
        for name in TABLES:
            table(name, rows)
        return rows
    except (OSError, ValueError, KeyError, TypeError, csv.Error) as error:
        reason = getattr(error, "strerror", None) or "no table of runs"
        raise BadInput(f"{file}: {reason}; kinloop batch table {results} writes it") from None


def read_document(path):
    """The text of a document. Throws BadInput for marks that are unknown or have no partner."""
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, ValueError) as error:
        raise BadInput(f"{path}: cannot be read ({getattr(error, 'strerror', None) or 'no UTF-8'})") from None
    blocks = list(BLOCK.finditer(text))
    if not blocks or 2 * len(blocks) != len(MARK.findall(text)):
        raise BadInput(f"{path}: needs pairs of '<!-- figures: NAME -->' and '<!-- end of figures -->', each on its own line")
    for block in blocks:
        if block["name"] not in TABLES:
            line = text[: block.start()].count("\n") + 1
            raise BadInput(f"{path}:{line}: unknown table '{block['name']}'; known: {', '.join(TABLES)}")
    return text


def stale_blocks(path, text, rows):
    """A message for each block whose figures are not those of the rows."""
    for block in BLOCK.finditer(text):
        before, now = without_measured(block["text"]), without_measured(table(block["name"], rows))
        if before != now:
            first = next((a for a, b in zip(now, before) if a != b), now[min(len(before), len(now) - 1)])
            line = text[: block.start()].count("\n") + 1
            yield f"{path}:{line}: stale figures, e.g. {' | '.join(first)}; run scripts/update_figures.py"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("results")
    parser.add_argument("files", nargs="*", type=Path, default=DOCUMENTS)
    parser.add_argument("--check", action="store_true")
    arguments = parser.parse_args()
    try:
        rows = read_rows(arguments.results)
        texts = {path: read_document(path) for path in arguments.files}
    except BadInput as error:
        print(f"error: {error}", file=sys.stderr)
        return 3
    if arguments.check:
        stale = [message for path, text in texts.items() for message in stale_blocks(path, text, rows)]
        print("\n".join(stale) if stale else "all figures are those of the results")
        return 1 if stale else 0
    for path, text in texts.items():
        path.write_text(BLOCK.sub(lambda block: block["begin"] + table(block["name"], rows) + block["end"], text), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())

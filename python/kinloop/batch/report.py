"""Everything that a batch leaves beside its runs: tables, LaTeX and the page.

RESULTS/runs.csv, runs.parquet   a row a run
RESULTS/sequences.csv            medians over seeds: a row a sequence and variant
RESULTS/variants.csv             means, areas under the curve, ratios: a row a variant and dataset
RESULTS/table.tex, index.html"""

from .files import write_whole
from .latex import latex_table
from .page import counts_text, page_text
from .statistics import SEQUENCE_COLUMNS, VARIANT_COLUMNS, summarise_sequences, summarise_variants
from .tables import csv_text, rows_of, write_rows


def write_report(title, jobs, store, program):
    """Writes all files; returns how many runs ended how. `program`: draws the pictures; None: there are none."""
    rows = rows_of(jobs, store)
    summaries = summarise_sequences(rows)
    variants = summarise_variants(summaries)
    write_rows(store.folder, rows)
    write_whole(store.folder / "sequences.csv", csv_text(SEQUENCE_COLUMNS, summaries))
    write_whole(store.folder / "variants.csv", csv_text(VARIANT_COLUMNS, variants))
    write_whole(store.folder / "table.tex", latex_table(summaries))
    write_whole(store.folder / "index.html", page_text(title, jobs, rows, variants, store, program))
    return counts_text(rows)

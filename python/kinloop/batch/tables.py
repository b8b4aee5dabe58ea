"""The rows of a batch, one a run, in the order of the suite; CSV and Parquet."""

import csv
import io

from .figures import FIGURES, MEASURED
from .figures import TEXTS as TEXT_FIGURES
from .figures import is_number
from .files import cannot_write, read_bytes, write_whole
from .text import cell_of, printable, text_of_cell

NAMES = ("dataset", "sequence", "variant", "seed", "status", "exit")
# Those after `key` differ from run to run.
COLUMNS = (*NAMES, *FIGURES, "key", *MEASURED)
TEXTS = {"dataset", "sequence", "variant", "status", "exit", "key", *TEXT_FIGURES}
MISSING = {"status": "not run", "exit": "", "figures": {}, "measured": {}}


def row_of(job, result):
    """A row as a dictionary; a figure that is not known is None. `result`: as Store.result gives it."""
    result = result or MISSING
    names = {"dataset": job.dataset, "sequence": job.sequence, "variant": job.variant, "seed": job.seed, "key": job.key,
             "status": result["status"], "exit": result["exit"]}  # fmt: skip
    row = dict.fromkeys(COLUMNS) | result["figures"] | result["measured"] | names
    return {name: printable(value) if isinstance(value, str) else value for name, value in row.items()}


def rows_of(jobs, store):
    results = {}
    for job in jobs:
        if job.key not in results:
            results[job.key] = store.result(job.key)
    return [row_of(job, results[job.key]) for job in jobs]


def text_of(value):
    """A figure with six significant digits, so that a table says what can be read, not the last bit."""
    if value is None or isinstance(value, str):
        return cell_of(value or "")
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def csv_text(columns, rows):
    file = io.StringIO()
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows([text_of(row[column]) for column in columns] for row in rows)
    return file.getvalue()


def write_parquet(path, rows):
    """Writes runs.parquet if pyarrow is installed; returns whether it is."""
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError:
        return False
    kind = {"seed": pyarrow.int64(), **dict.fromkeys(TEXTS, pyarrow.string())}
    schema = pyarrow.schema([(column, kind.get(column, pyarrow.float64())) for column in COLUMNS])
    columns = {c: [r[c] if c in kind or r[c] is None else float(r[c]) for r in rows] for c in COLUMNS}
    try:
        pyarrow.parquet.write_table(pyarrow.table(columns, schema=schema), path)
    except OSError as error:
        raise cannot_write(path, error) from None
    return True


def write_rows(folder, rows):
    write_whole(folder / "runs.csv", csv_text(COLUMNS, rows))
    write_parquet(folder / "runs.parquet", rows)


def read_rows(path):
    """The rows of a runs.csv, numbers as floats. Throws OSError, or ValueError if it is no table."""
    try:
        lines = list(csv.reader(io.StringIO(read_bytes(path).decode(), newline="")))
    except csv.Error:
        lines = []
    first = lines.pop(0) if lines else []
    if not set(COLUMNS) <= set(first) or any(len(line) != len(first) for line in lines):
        raise ValueError("is no table of runs")
    return [{name: text_of_cell(cell) if name in TEXTS else number(cell) for name, cell in zip(first, line)} for line in lines]


def number(text):
    try:
        return float(text) if is_number(float(text)) else None
    except ValueError:
        return None

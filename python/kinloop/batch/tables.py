"""The rows of a batch, one a run, in the order of the suite; CSV and Parquet."""

import csv
import io

from .figures import FIGURES, MEASURED
from .files import cannot_write, read_bytes, write_whole

NAMES = ("dataset", "sequence", "variant", "seed", "status", "exit")
# Those after `key` differ from run to run.
COLUMNS = (*NAMES, *FIGURES, "key", *MEASURED)
TEXTS = {"dataset", "sequence", "variant", "status", "exit", "verdict", "sensor", "key", "memory_limit"}
MISSING = {"status": "not run", "exit": ""}


def row_of(job, result):
    """A row as a dictionary; a figure that is not known is None."""
    if not isinstance(result, dict):
        result = MISSING
    names = {"dataset": job.dataset, "sequence": job.sequence, "variant": job.variant, "seed": job.seed, "key": job.key,
             "status": result["status"], "exit": str(result["exit"])}  # fmt: skip
    return dict.fromkeys(COLUMNS) | (result.get("figures") or {}) | (result.get("measured") or {}) | names


def rows_of(jobs, store):
    results = {}
    for job in jobs:
        if job.key not in results:
            results[job.key] = store.result(job.key)
    return [row_of(job, results[job.key]) for job in jobs]


def text_of(value):
    """A figure with six significant digits, so that a table says what can be read, not the last bit."""
    if value is None:
        return ""
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
    file = io.StringIO(read_bytes(path).decode(), newline="")
    try:
        return [{name: value if name in TEXTS else number(value) for name, value in row.items() if name} for row in csv.DictReader(file)]
    except csv.Error as error:
        raise ValueError(error) from None


def number(text):
    try:
        return float(text)
    except (TypeError, ValueError):
        return None

"""RESULTS/index.html: one page that opens from disk, with all rows, and the largest errors with pictures.

In: rows, summaries, the store. Out: the text of the page."""

import base64
import json
import subprocess
import tempfile
from pathlib import Path

from .files import kind_of
from .statistics import VARIANT_COLUMNS
from .tables import COLUMNS, TEXTS

TEMPLATE = Path(__file__).with_name("page.html")
WORST = 10
PICTURE_PATIENCE_S = 60


def counts_text(rows):
    """How many runs ended how: 12 done, 1 lost."""
    counts = {}
    for row in rows:
        counts[row["status"]] = counts.get(row["status"], 0) + 1
    return ", ".join(f"{count} {status}" for status, count in sorted(counts.items(), key=lambda item: (item[0] != "done", item)))


def _rounded(value):
    return float(f"{value:.6g}") if isinstance(value, float) else value


def _entry(folder):
    """The file that shows a run best."""
    return next((name for name in ("report.html", "run.json") if (folder / name).exists()), "log.txt")


def picture_of(program, folder):
    """The paths and errors of a run as `kinloop eval --plot` draws them, as a URL of data; empty without a trajectory."""
    if not program or not all(kind_of(folder / name) == "file" for name in ("trajectory.txt", "groundtruth.txt")):
        return ""
    with tempfile.TemporaryDirectory(prefix="kinloop_batch_") as scratch:
        file = Path(scratch) / "errors.svg"
        try:
            call = [program, "eval", folder.name, "--plot", str(file)]  # by its name: the picture shows it
            subprocess.run(call, cwd=folder.parent, capture_output=True, timeout=PICTURE_PATIENCE_S, check=False)
            return "data:image/svg+xml;base64," + base64.b64encode(file.read_bytes()).decode()
        except (OSError, subprocess.TimeoutExpired):
            return ""


def _worst(jobs, rows, store, program):
    """The runs with the largest errors: one a sequence and variant."""
    seen, worst = set(), []
    for job, row in sorted(zip(jobs, rows), key=lambda pair: -(pair[1]["ate_m"] or 0.0)):
        if row["ate_m"] is None or (job.sequence, job.variant) in seen or len(worst) == WORST:
            continue
        seen.add((job.sequence, job.variant))
        folder = store.run_folder(job.key)
        text = f"{job.sequence}, {job.variant}, seed {job.seed}: ATE {row['ate_m']:.4f} m"
        worst.append({"text": text, "href": f"runs/{job.key}/{_entry(folder)}", "picture": picture_of(program, folder)})
    return worst


def page_text(title, jobs, rows, variants, store, program):
    entries = {job.key: _entry(store.run_folder(job.key)) for job in jobs}
    data = {
        "title": title, "counts": counts_text(rows), "columns": COLUMNS, "texts": sorted(TEXTS),
        "rows": [[_rounded(row[column]) for column in COLUMNS] + [entries[row["key"]]] for row in rows],
        "variantColumns": VARIANT_COLUMNS, "variants": [[_rounded(row[column]) for column in VARIANT_COLUMNS] for row in variants],
        "worst": _worst(jobs, rows, store, program),
    }  # fmt: skip
    text = json.dumps(data, separators=(",", ":")).replace("<", "\\u003c")  # a name must not end the script
    return TEMPLATE.read_text().replace("DATA", text, 1)

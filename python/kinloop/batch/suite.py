"""What a suite says: sequences, variants, limits, and what is kept of a run.

In: a YAML file. Out: a Suite, whose sequences are still names, globs and URLs (recordings.py finds them)."""

import itertools
import re
import shlex
from dataclasses import dataclass, field
from pathlib import Path

from .suite_file import read_yaml
from .templates import placeholders

SUITE_KEYS = ("name", "sequences", "variants", "seeds", "limits", "keep", "threads")
SEQUENCE_KEYS = ("path", "name", "dataset", "camera", "truth", "sha256")
VARIANT_KEYS = ("set", "arguments", "every", "seeds", "prepare", "command", "external", "version")
RUN_KEYS = ("set", "arguments", "every")  # of kinloop run
LIMIT_KEYS = ("time", "memory")
DEFAULT_KEEP = ("run.json", "trajectory.txt", "live.txt", "groundtruth.txt", "frames.txt")
PLACEHOLDERS = ("recording", "camera", "output", "name", "seed", "threads")
MAX_ROOMS = 100_000
MAX_RUNS = 1_000_000
MAX_STEP = 100_000  # of --every
# Options of `kinloop run` that batch gives itself, or that would let a run wait or write elsewhere.
OWN_OPTIONS = {
    "-o": "a run writes to its own folder", "--output": "a run writes to its own folder",
    "--camera": "write 'camera:' for a sequence", "--set": "write 'set:'", "--every": "write 'every:'",
    "--threads": "write 'threads:' for the suite",
    "--pace": "its results depend on the machine", "--viewer": "runs are not watched",
    "--save-map": "write 'keep: [map.kinmap]'", "--load-map": "runs are independent of each other",
    "--trajectory": "write 'keep: [trajectory.txt]'", "--poses-to": "runs write files only",
}  # fmt: skip
FILE_OPTIONS = ("--mask", "--vocabulary")  # of `kinloop run`, whose value is a file


@dataclass
class Sequence:
    """A line of `sequences:`; `pattern` is a path, a glob, a URL or a name that `kinloop run` opens. `sha256`: what the names
    and bytes of the recording must hash to; "" for any."""

    pattern: str
    name: str = ""
    dataset: str = ""
    camera: str = ""
    truth: str = ""
    sha256: str = ""
    where: str = ""


@dataclass
class Variant:
    """How a sequence is run: kinloop with options, a `command`, or an `external` trajectory that only is scored.
    `every`: use each n-th frame; `prepare`: a command that writes a changed copy of the recording first."""

    name: str
    options: dict = field(default_factory=dict)
    arguments: list = field(default_factory=list)
    every: int = 1
    seeds: list = field(default_factory=list)
    prepare: str = ""
    command: str = ""
    external: str = ""
    version: str = ""


@dataclass
class Suite:
    """`file` is absolute; relative paths begin in its folder."""

    name: str
    file: Path
    sequences: list
    variants: list
    time_s: float = 3600.0
    memory_mib: int = 0
    keep: list = field(default_factory=lambda: list(DEFAULT_KEEP))
    threads: int = 1

    @property
    def folder(self):
        return self.file.parent


def seconds_of(value):
    """30 s, 10 min, 2 h as seconds."""
    match = re.fullmatch(r"(\d{1,9}(?:\.\d+)?) ?(s|min|h)", value.text())
    if not match or float(match[1]) == 0:
        value.fail(f"'{value.text()}': expected a time, e.g. 90 s, 10 min or 2 h")
    return float(match[1]) * {"s": 1, "min": 60, "h": 3600}[match[2]]


def mebibytes_of(value):
    """500 MiB, 4 GiB as MiB."""
    match = re.fullmatch(r"(\d{1,9}) ?(MiB|GiB)", value.text())
    if not match or int(match[1]) == 0:
        value.fail(f"'{value.text()}': expected a size, e.g. 500 MiB or 4 GiB")
    return int(match[1]) * {"MiB": 1, "GiB": 1024}[match[2]]


def _rooms(pattern, value):
    """sim:room:1..20 as twenty names; other patterns as they are."""
    match = re.fullmatch(r"(sim:\w+:)(\d{1,9})\.\.(\d{1,9})", pattern)
    if not match:
        return [pattern]
    first, last = int(match[2]), int(match[3])
    if not first <= last < first + MAX_ROOMS:
        value.fail(f"'{pattern}': expected a range such as 1..20, of at most {MAX_ROOMS} rooms")
    return [f"{match[1]}{i}" for i in range(first, last + 1)]


def _sequences(value, runs_each):
    """The sequences of a suite, which are counted before they take memory."""
    most = MAX_RUNS // runs_each
    sequences = list(itertools.islice(_all_sequences(value), most + 1))
    if len(sequences) > most:
        value.fail(f"more than {MAX_RUNS} runs, with {runs_each} of each sequence; divide the suite")
    return sequences


def _all_sequences(value):
    for item in value.items() if not value.is_mapping() else value.fail("expected a list: '- PATH'"):
        where = f"{item.file}:{item.node.start_mark.line + 1}"
        if not item.is_mapping():
            yield from (Sequence(pattern, where=where) for pattern in _rooms(item.text(), item))
            continue
        fields = item.fields(SEQUENCE_KEYS)
        if "path" not in fields:
            item.fail("a sequence needs 'path: ...'")
        texts = {name: given.text() for name, given in fields.items() if name != "path"}
        yield from (Sequence(pattern, where=where, **texts) for pattern in _rooms(fields["path"].text(), item))


def _seeds(value):
    seeds = [item.whole_number(0, 1_000_000_000) for item in value.items()]
    if not seeds or len(set(seeds)) < len(seeds):
        value.fail("expected seeds that differ, e.g. [1, 2, 3]")
    return seeds


def _template(value, known=PLACEHOLDERS):
    """A text with placeholders in braces, checked."""
    try:
        names = placeholders(value.text())
        shlex.split(value.text())
    except ValueError as error:
        value.fail(f"{error}; write {{{{ for a brace")
    for name in sorted(names - set(known)):
        value.fail(f"unknown placeholder {{{name}}}; known: {', '.join('{' + p + '}' for p in known)}")
    return value.text()


def _arguments(value):
    arguments = [item.text() for item in value.items()]
    for argument in arguments:
        if reason := OWN_OPTIONS.get(argument.partition("=")[0]):
            value.fail(f"{argument} is not for a suite: {reason}")
    return arguments


def _variant(name, value, seeds):
    fields = value.fields(VARIANT_KEYS)
    kinds = [kind for kind in ("command", "external") if kind in fields]
    if len(kinds) > 1:
        value.fail("'command' and 'external' exclude each other")
    for key in RUN_KEYS if kinds else ():
        if key in fields:
            value.fail(f"'{key}' is for kinloop run; remove it or '{kinds[0]}'")
    if "prepare" in fields and "external" in fields:
        value.fail("'prepare' changes a recording, but 'external' reads none; remove one")
    variant = Variant(name, seeds=_seeds(fields["seeds"]) if "seeds" in fields else seeds)
    if "set" in fields:
        variant.options = {key: given.text() for key, given in fields["set"].fields().items()}
        if "seed" in variant.options:
            fields["set"].fail("write 'seeds: [...]' in place of 'seed'")
    if "arguments" in fields:
        variant.arguments = _arguments(fields["arguments"])
    if "every" in fields:
        variant.every = fields["every"].whole_number(1, MAX_STEP)
    if "prepare" in fields:
        variant.prepare = _template(fields["prepare"])
        for needed in ("{recording}", "{output}"):
            if needed not in variant.prepare:
                fields["prepare"].fail(f"{needed} is missing, e.g. 'prepare: COMMAND {{recording}} {{output}}'")
    if kinds:
        known = PLACEHOLDERS if kinds[0] == "command" else tuple(name for name in PLACEHOLDERS if name != "output")
        setattr(variant, kinds[0], _template(fields[kinds[0]], known))
    if "version" in fields:
        variant.version = fields["version"].text()
    if variant.external or (variant.command and "{seed}" not in variant.command + variant.prepare):
        variant.seeds = [0]  # nothing depends on the seed
    return variant


def _kept_files(value):
    names = [item.text() for item in value.items()]
    for name in names:
        if name.startswith("/") or ".." in Path(name).parts:
            value.fail(f"'{name}': expected names of files in the folder of a run, or globs such as *.ply")
    return names


def read_suite(path):
    """Reads a suite. Throws BatchError that names file, line and remedy."""
    top = read_yaml(path)
    fields = top.fields(SUITE_KEYS)
    if "sequences" not in fields:
        top.fail("'sequences:' is missing")
    seeds = _seeds(fields["seeds"]) if "seeds" in fields else [1]
    variants = [_variant(name, value, seeds)
                for name, value in (fields["variants"].fields() if "variants" in fields else {}).items()]  # fmt: skip
    variants = variants or [Variant("default", seeds=seeds)]
    suite = Suite(
        name=fields["name"].text() if "name" in fields else Path(path).stem,
        file=Path(path).resolve(),
        sequences=_sequences(fields["sequences"], sum(len(variant.seeds) for variant in variants)),
        variants=variants,
    )
    limits = fields["limits"].fields(LIMIT_KEYS) if "limits" in fields else {}
    if "time" in limits:
        suite.time_s = seconds_of(limits["time"])
    if "memory" in limits:
        suite.memory_mib = mebibytes_of(limits["memory"])
    if "keep" in fields:
        suite.keep = _kept_files(fields["keep"])
    if "threads" in fields:
        suite.threads = fields["threads"].whole_number(1, 1024)
    if not suite.sequences:
        fields["sequences"].fail("is empty")
    return suite

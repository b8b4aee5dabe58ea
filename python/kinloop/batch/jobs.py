"""Jobs: one run each, with the key that names its result.

In: a suite, its recordings and the program. Out: a list of Jobs, in the order of the suite."""

import json
import os
import re
import shlex
import shutil
from dataclasses import asdict, dataclass, field, fields
from pathlib import Path

from .durations import by_size
from .errors import BatchError
from .figures import is_number
from .files import hash_of_file, hash_of_value
from .program import default_options, identity_of, number_or_text, options_in_effect
from .recordings import is_simulated
from .suite import FILE_OPTIONS, MAX_RUNS
from .templates import as_template, filled, placeholders

FORMAT = 1  # of results; another number makes all runs new
KEY = re.compile("[0-9a-f]{32}")  # of a run, and the name of its folder


@dataclass
class Job:
    """A run. `key` is the hash of `identity`; the rest does not change the result. `words`: templates of the command line,
    with {output} for the folder of the run and {prepared} for the recording that `prepare` writes; empty if a trajectory
    is only scored. `prepare`: the command line that writes its changed recording to {output}; usually empty. `expected_s`:
    about the CPU time, by which runs are put in order."""

    key: str
    sequence: str
    dataset: str
    variant: str
    seed: int
    kind: str
    program: str
    words: list
    recording: str
    truth: str
    external: str
    time_s: float
    memory_mib: int
    keep: list
    expected_s: float
    identity: dict = field(default_factory=dict)
    prepare: list = field(default_factory=list)

    def to_line(self):
        """The job as a line of JSON."""
        return json.dumps(asdict(self), sort_keys=True)

    @classmethod
    def from_line(cls, line):
        """Throws ValueError for a line that is no job."""
        try:
            job = cls(**json.loads(line))
        except (TypeError, RecursionError):
            raise ValueError("no job") from None
        for part in fields(job):
            value = getattr(job, part.name)
            if not (is_number(value) if part.type is float else isinstance(value, part.type)):
                raise ValueError(f"{part.name} is no {part.type.__name__}")
        words = job.words + job.prepare
        if not KEY.fullmatch(job.key) or not all(isinstance(word, str) and "\0" not in word for word in words + job.keep):
            raise ValueError("no key, or no words")
        if not set().union(*map(placeholders, words)) <= {"output", "prepared"}:
            raise ValueError("unknown placeholder")
        return job


class Planner:
    """Makes the jobs of a suite; asks the program once for its identity and its defaults."""

    def __init__(self, suite, program):
        self.suite, self.program = suite, program
        self.program_identity = identity_of(program)
        self.defaults = default_options(program)
        self.hashes = {}  # of the files that variants name

    def jobs(self, recordings):
        """All combinations of recordings, variants and seeds."""
        count = len(recordings) * sum(len(variant.seeds) for variant in self.suite.variants)
        if count > MAX_RUNS:
            raise BatchError(f"{self.suite.name}: {count} runs; a suite has at most {MAX_RUNS}, divide it")
        return [self._job(recording, variant, seed)
                for recording in recordings for variant in self.suite.variants for seed in variant.seeds]  # fmt: skip

    def _job(self, recording, variant, seed):
        kind = "command" if variant.command else "external" if variant.external else "run"
        make = {"command": self._command, "external": self._external, "run": self._run}[kind]
        path = "{prepared}" if variant.prepare else as_template(recording.path)
        words, external, identity = make(path, recording, variant, seed)
        identity |= {"format": FORMAT, "kind": kind, "recording": recording.identity, "program": self.program_identity}
        prepare = self._prepare(recording, variant, seed, identity) if variant.prepare else []
        truth = recording.truth or recording.path
        if is_simulated(truth) and kind != "run":
            raise BatchError(f"variant {variant.name}: {recording.name} is no file; write the room with kinloop simulate first")
        return Job(hash_of_value(identity)[:32], recording.name, recording.dataset, variant.name, seed, kind, self.program,
                   words, recording.path, truth, external, self.suite.time_s, self.suite.memory_mib, self.suite.keep,
                   by_size(recording, variant.options, variant.every), identity, prepare)  # fmt: skip

    def _run(self, path, recording, variant, seed):
        options = variant.options | {"seed": str(seed)}
        more = ["--threads", self.suite.threads]
        more += ["--camera", recording.camera] if recording.camera else []
        more += ["--every", variant.every] if variant.every > 1 else []
        arguments, files = self._arguments(variant)
        more += arguments + [word for key, value in options.items() for word in ("--set", f"{key}={value}")]
        words = [as_template(self.program), "run", path, "-o", "{output}", "-q", *map(as_template, more)]
        effective = {key: number_or_text(value) for key, value in options_in_effect(options, self.defaults).items()}
        identity = {"options": effective, "arguments": variant.arguments}
        return words, "", identity | ({"every": variant.every} if variant.every > 1 else {}) | ({"files": files} if files else {})

    def _arguments(self, variant):
        """The arguments with the paths of files made absolute, since a run starts in its own folder, and the hashes of these
        files."""
        words, files = [], {}
        for argument in variant.arguments:
            option, equals, value = argument.partition("=")
            words += [option, value] if equals and option in FILE_OPTIONS else [argument]
        for i, word in enumerate(words):
            if i and words[i - 1] in FILE_OPTIONS:
                words[i] = os.path.normpath(os.path.join(self.suite.folder, os.path.expanduser(word)))
                files[word] = self._hash_of(words[i], variant)
        return words, files

    def _hash_of(self, path, variant):
        """The hash of a file that a variant names."""
        try:
            if path not in self.hashes:
                self.hashes[path] = hash_of_file(path)
            return self.hashes[path]
        except OSError as error:
            raise BatchError(f"variant {variant.name}: {path}: cannot be read ({error.strerror}); paths begin at the suite's folder") from None

    def _command(self, path, recording, variant, seed):
        words, files = self._command_line(variant.command, path, recording, variant, seed)
        return words, "", {"command": variant.command, "seed": seed, "version": variant.version, "files": files}

    def _prepare(self, recording, variant, seed, identity):
        """The command line that writes the changed recording; adds to `identity` what it depends on."""
        words, files = self._command_line(variant.prepare, as_template(recording.path), recording, variant, seed)
        identity |= {"prepare": {"command": variant.prepare, "version": variant.version, "files": files}}
        if "{seed}" in variant.prepare:
            identity["prepare"]["seed"] = seed
        return words

    def _command_line(self, template, path, recording, variant, seed):
        """The words of a template, and the hashes of those that are files: the program, and scripts of the suite's folder.
        `path`: what the run finds the recording by, as a template."""
        values = {name: as_template(value) for name, value in self._values(template, recording, variant, seed).items()}
        values |= {"recording": path, "output": "{output}"}
        words, files = [], {}
        for word in shlex.split(template):
            file = self._file_of(word, is_program=not words)
            if file:
                files[word] = self._hash_of(file, variant)
            words.append(as_template(file) if file else filled(word, values, as_template))
        if not words:
            raise BatchError(f"variant {variant.name}: the command is empty")
        return words, files

    def _values(self, template, recording, variant, seed):
        """What the placeholders of a template stand for, but {output}, which is known when the run starts."""
        if "{camera}" in template and not recording.camera:
            raise BatchError(f"variant {variant.name}: {recording.name} has no 'camera:' in the suite, which the template uses")
        return {"recording": recording.path, "camera": recording.camera, "name": recording.name, "seed": seed,
                "threads": self.suite.threads}  # fmt: skip

    def _file_of(self, word, is_program):
        """The absolute path of a word of a template that names a file; None if it does not. Links are not followed: the
        Python of a virtual environment is one, and knows the environment by its place."""
        if is_program and "/" not in word:
            found = shutil.which(word)
        else:
            found = os.path.join(self.suite.folder, word)
        return os.path.abspath(found) if found and os.path.isfile(found) else None

    def _external(self, path, recording, variant, seed):
        values = self._values(variant.external, recording, variant, seed)
        file = Path(self.suite.folder, filled(variant.external, values))
        try:
            digest = hash_of_file(file)
        except OSError:
            digest = ""  # a row that says so
        return [], os.path.normpath(file), {"trajectory": digest, "version": variant.version}

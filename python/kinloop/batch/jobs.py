"""Jobs: one run each, with the key that names its result.

In: a suite, its recordings and the program. Out: a list of Jobs, in the order of the suite."""

import os
import shlex
import shutil
from dataclasses import asdict, dataclass, field
from pathlib import Path

from .errors import BatchError
from .files import hash_of_file, hash_of_value
from .program import default_options, identity_of, number_or_text, options_in_effect
from .recordings import is_simulated

FORMAT = 1  # of results; another number makes all runs new
MAX_JOBS = 1_000_000


@dataclass
class Job:
    """A run. `key` is the hash of `identity`; the rest does not change the result. `words`: the command line, with
    {output} for the folder of the run; empty if a trajectory is only scored."""

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
    bytes: int
    identity: dict = field(default_factory=dict)

    def to_json(self):
        return asdict(self)


def _filled(template, recording, variant, seed, suite):
    """A template with its placeholders filled, but {output}, which is known when the run starts."""
    values = {"recording": recording.path, "camera": recording.camera, "name": recording.name, "seed": seed,
              "threads": suite.threads, "output": "{output}"}  # fmt: skip
    if "{camera}" in template and not recording.camera:
        raise BatchError(f"variant {variant.name}: {recording.name} has no 'camera:' in the suite, which the template uses")
    return template.format(**values)


class Planner:
    """Makes the jobs of a suite; asks the program once for its identity and its defaults."""

    def __init__(self, suite, program):
        self.suite, self.program = suite, program
        self.program_identity = identity_of(program)
        self.defaults = default_options(program)

    def jobs(self, recordings):
        """All combinations of recordings, variants and seeds."""
        count = len(recordings) * sum(len(variant.seeds) for variant in self.suite.variants)
        if count > MAX_JOBS:
            raise BatchError(f"{self.suite.name}: {count} runs; a suite has at most {MAX_JOBS}, divide it")
        return [self._job(recording, variant, seed)
                for recording in recordings for variant in self.suite.variants for seed in variant.seeds]  # fmt: skip

    def _job(self, recording, variant, seed):
        kind = "command" if variant.command else "external" if variant.external else "run"
        make = {"command": self._command, "external": self._external, "run": self._run}[kind]
        words, external, identity = make(recording, variant, seed)
        identity |= {"format": FORMAT, "kind": kind, "recording": recording.identity, "program": self.program_identity}
        truth = recording.truth or recording.path
        if kind != "run" and is_simulated(truth):
            raise BatchError(f"variant {variant.name}: {recording.name} is no file; write the room with kinloop simulate first")
        return Job(hash_of_value(identity)[:32], recording.name, recording.dataset, variant.name, seed, kind, self.program,
                   words, recording.path, truth, external, self.suite.time_s, self.suite.memory_mib, self.suite.keep,
                   recording.bytes, identity)  # fmt: skip

    def _run(self, recording, variant, seed):
        options = variant.options | {"seed": str(seed)}
        words = [self.program, "run", recording.path, "-o", "{output}", "-q", "--threads", str(self.suite.threads)]
        words += ["--camera", recording.camera] if recording.camera else []
        words += variant.arguments + [word for key, value in options.items() for word in ("--set", f"{key}={value}")]
        effective = {key: number_or_text(value) for key, value in options_in_effect(options, self.defaults).items()}
        return words, "", {"options": effective, "arguments": variant.arguments}

    def _command(self, recording, variant, seed):
        words = [_filled(word, recording, variant, seed, self.suite) for word in shlex.split(variant.command)]
        if not words:
            raise BatchError(f"variant {variant.name}: the command is empty")
        found = shutil.which(os.path.join(self.suite.folder, words[0]) if "/" in words[0] else words[0])
        words[0] = os.path.realpath(found) if found else words[0]
        command_identity = hash_of_file(words[0]) if found else ""
        return words, "", {"command": variant.command, "seed": seed, "version": variant.version, "peer": command_identity}

    def _external(self, recording, variant, seed):
        path = Path(self.suite.folder, _filled(variant.external, recording, variant, seed, self.suite))
        try:
            digest = hash_of_file(path)
        except OSError:
            digest = ""  # a row that says so
        return [], os.path.normpath(path), {"trajectory": digest, "version": variant.version}

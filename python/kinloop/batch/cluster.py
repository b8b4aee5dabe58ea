"""Clusters that start a command by themselves: an array of Slurm, an indexed Job of Kubernetes.

In: a plan. Out: slurm.sh and kubernetes.yaml in the folder of results, each of which runs `kinloop batch shard i/n`; the
first can be submitted and waited for."""

import shlex
import subprocess
import time

from .errors import BatchError, Interrupted, Unfinished, UsageError
from .files import write_whole
from .workers import stopping_by_signals

SPARE_TIME = 1.2  # for hashing of files and evaluation

SLURM = """#!/bin/sh
# {name}: {runs} runs in {shards} shards. Submit it with:  sbatch {folder}/slurm.sh
# A shard whose machine fails is repeated; submit the script again for what is still missing.
#SBATCH --job-name=kinloop-{name}
#SBATCH --array=1-{shards}
#SBATCH --cpus-per-task={threads}
#SBATCH --time={minutes}
#SBATCH --requeue
#SBATCH --output="{output}"
{memory}exec {command} "$SLURM_ARRAY_TASK_ID/{shards}" {results} --help-others --trust
"""

KUBERNETES = """# {name}: {runs} runs in {shards} shards. Submit it with:  kubectl apply -f kubernetes.yaml
# Set `image` to one that has kinloop, and `claimName` to a volume that all nodes share, mounted where it is here.
apiVersion: batch/v1
kind: Job
metadata:
  name: kinloop-{name}
spec:
  completionMode: Indexed
  completions: {shards}
  parallelism: {shards}
  backoffLimit: {retries}
  template:
    spec:
      restartPolicy: OnFailure
      containers:
        - name: kinloop
          image: kinloop
          command: ["/bin/sh", "-c"]
          args: [{argument}]
          resources:
            requests: {{cpu: "{threads}", memory: {memory}Mi}}
          volumeMounts:
            - {{name: shared, mountPath: {mount}}}
      volumes:
        - name: shared
          persistentVolumeClaim: {{claimName: kinloop}}
"""
DEFAULT_MEMORY_MIB = 2048
POLL_S = 5.0  # of results and of Slurm's queue
SETTLING_S = 60.0  # NFS may show new folders that late


def _label(name):
    """A name that both accept: lower case letters, digits and hyphens."""
    return "".join(c if c.isascii() and c.isalnum() else "-" for c in name.lower()).strip("-")[:40] or "suite"


def write_scripts(suite, jobs, shards, program, store):
    """Writes both scripts, for at most `shards` shards and none that is empty; returns their paths."""
    shards = max(1, min(shards, len(jobs)))
    folder = str(store.folder.resolve())
    per_shard = -(-len(jobs) // shards)
    values = {"name": _label(suite.name), "runs": len(jobs), "shards": shards, "threads": suite.threads, "retries": 6 * shards}
    shell = f"{shlex.quote(program)} batch shard"
    slurm = SLURM.format(
        folder=shlex.quote(folder), output=folder.replace("%", "%%") + "/slurm-%A_%a.log", command=shell, results=shlex.quote(folder),
        minutes=max(1, round(per_shard * suite.time_s * SPARE_TIME / 60)),
        memory=f"#SBATCH --mem={suite.memory_mib + 512}M\n" if suite.memory_mib else "", **values)  # fmt: skip
    index = f'exec {shell} "$((JOB_COMPLETION_INDEX + 1))/{shards}" {shlex.quote(folder)} --help-others --trust'
    kubernetes = KUBERNETES.format(argument="'" + index.replace("'", "''") + "'", memory=(suite.memory_mib or DEFAULT_MEMORY_MIB) + 512,
                                   mount="'" + folder.replace("'", "''") + "'", **values)  # fmt: skip
    paths = store.folder / "slurm.sh", store.folder / "kubernetes.yaml"
    for path, text in zip(paths, (slurm, kubernetes)):
        write_whole(path, text)
    return paths


def _output_of(call):
    """What a command of Slurm prints. Throws BatchError with its message."""
    try:
        done = subprocess.run(call, capture_output=True, text=True, errors="replace", check=False)
    except OSError as error:
        raise BatchError(f"--slurm: {call[0]} cannot be run ({error.strerror}); run kinloop batch where jobs are submitted") from None
    if done.returncode:
        last = (done.stderr.strip().splitlines() or [f"ended with {done.returncode}"])[-1]
        raise BatchError(f"--slurm: {call[0]}: {last.removeprefix(f'{call[0]}: error: ')}")
    return done.stdout


def _has_ended(job):
    """Whether no task of a job is pending or running. While the controller does not answer, the job is taken to go on."""
    try:
        return not _output_of(["squeue", "-h", "-j", job]).strip()
    except BatchError as error:
        return "Invalid job id" in str(error)  # ended, and forgotten


def run_by_slurm(script, options, jobs, store, progress, say):
    """Submits `script` with further `options` of sbatch and waits until each job has a result. Ctrl-C cancels what is left."""
    try:
        words = shlex.split(options)
    except ValueError as error:
        raise UsageError(f"--slurm '{options}': {error}") from None
    with stopping_by_signals() as stop:
        number = _output_of(["sbatch", "--parsable", *words, str(script)]).strip().split(";")[0]
        say(f"slurm job  {number}")
        _wait_for_results(number, {job.key for job in jobs}, store, progress, stop)


def _wait_for_results(number, left, store, progress, stop):
    ended_s = None
    while left:
        if ended_s is None and _has_ended(number):
            ended_s = time.monotonic()
        done = left & store.finished()
        left -= done
        for key in done:
            progress.finish_one(key)
        if left and ended_s is not None and time.monotonic() - ended_s > SETTLING_S:
            raise Unfinished(f"slurm job {number} has ended, and {len(left)} runs have no result; see {store.folder}/slurm-{number}_*.log, "
                             "and run the same command again")  # fmt: skip
        if left and stop.wait(POLL_S):
            _output_of(["scancel", number])
            raise Interrupted("interrupted")

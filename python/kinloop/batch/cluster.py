"""Clusters that start a command by themselves: an array of Slurm, an indexed Job of Kubernetes.

In: a plan. Out: slurm.sh and kubernetes.yaml in the folder of results, each of which runs `kinloop batch shard i/n`."""

import shlex

from .files import write_whole

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
{memory}exec {command} "$SLURM_ARRAY_TASK_ID/{shards}" {results}
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


def _label(name):
    """A name that both accept: lower case letters, digits and hyphens."""
    return "".join(c if c.isascii() and c.isalnum() else "-" for c in name.lower()).strip("-")[:40] or "suite"


def write_scripts(suite, jobs, shards, program, store):
    """Writes both scripts; returns their paths."""
    folder = str(store.folder.resolve())
    per_shard = -(-len(jobs) // shards)
    values = {"name": _label(suite.name), "runs": len(jobs), "shards": shards, "threads": suite.threads, "retries": 6 * shards}
    shell = f"{shlex.quote(program)} batch shard"
    slurm = SLURM.format(
        folder=shlex.quote(folder), output=folder.replace("%", "%%") + "/slurm-%A_%a.log", command=shell, results=shlex.quote(folder),
        minutes=max(1, round(per_shard * suite.time_s * SPARE_TIME / 60)),
        memory=f"#SBATCH --mem={suite.memory_mib + 512}M\n" if suite.memory_mib else "", **values)  # fmt: skip
    index = f'exec {shell} "$((JOB_COMPLETION_INDEX + 1))/{shards}" {shlex.quote(folder)}'
    kubernetes = KUBERNETES.format(argument="'" + index.replace("'", "''") + "'", memory=(suite.memory_mib or DEFAULT_MEMORY_MIB) + 512,
                                   mount="'" + folder.replace("'", "''") + "'", **values)  # fmt: skip
    paths = store.folder / "slurm.sh", store.folder / "kubernetes.yaml"
    for path, text in zip(paths, (slurm, kubernetes)):
        write_whole(path, text)
    return paths

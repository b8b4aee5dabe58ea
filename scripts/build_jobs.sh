#!/usr/bin/env bash
# Prints the number of parallel compile jobs: one per core, as far as memory allows.
set -euo pipefail

per_job_mib=1900  # the largest unit takes 1.7 GiB

available_mib="$(($(sed -n 's/^MemAvailable: *\([0-9]*\) kB/\1/p' /proc/meminfo) / 1024))"
# The memory limit of a container.
limit="$(cat /sys/fs/cgroup/memory.max 2>/dev/null || echo max)"
if [[ "$limit" != max && $((limit / 1048576)) -lt $available_mib ]]; then available_mib="$((limit / 1048576))"; fi

jobs="$(nproc)"
if [[ $((available_mib / per_job_mib)) -lt $jobs ]]; then jobs="$((available_mib / per_job_mib))"; fi
echo "$((jobs > 0 ? jobs : 1))"

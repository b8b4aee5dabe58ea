"""kinloop batch: whole datasets on many machines, and tables that anyone can repeat.

    suite.py, suite_file.py   what to run: a YAML file
    recordings.py, program.py what the results depend on, as hashes
    jobs.py                   the runs, each named by the hash of what it depends on
    store.py                  the folder of results, shared by processes and machines
    process.py, cgroup.py, execute.py   one run under its limits, and its row
    workers.py, cluster.py    local workers, Dask, Slurm, Kubernetes
    command.py, command_line.py         commands and their options
    tables.py, statistics.py, latex.py, page.py, report.py, compare.py   what comes out

The package is plain Python and does not need the compiled module of kinloop. Its core needs PyYAML only."""

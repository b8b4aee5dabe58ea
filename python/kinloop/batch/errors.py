"""What the command ends with: a message of one line and an exit code."""


class BatchError(Exception):
    """Bad input: the message names the file, the line or key, and the remedy."""

    exit_code = 3


class UsageError(BatchError):
    """A wrong command line."""

    exit_code = 2


class Unfinished(BatchError):
    """Some runs have no result. The tables have the others."""


class Interrupted(Unfinished):
    """Ctrl-C or SIGTERM. Finished runs are kept."""

    exit_code = 130


class OutputError(BatchError):
    """The results cannot be written. No row is written for the runs under way."""

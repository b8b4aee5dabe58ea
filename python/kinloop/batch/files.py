"""Files that are written beside their target and renamed, and hashes of files."""

import errno
import hashlib
import json
import os
import uuid
from pathlib import Path

from .errors import BatchError, DiskFull

FULL = (errno.ENOSPC, errno.EDQUOT)


def disk_full(path):
    return DiskFull(f"{path}: the disk is full; make room and run the same command again, finished runs are kept")


def cannot_write(path, error):
    """The exception for an OSError while `path` is written."""
    if error.errno in FULL:
        return disk_full(path)
    return BatchError(f"{path}: cannot be written ({error.strerror}); choose another folder or change its permissions")


def write_whole(path, data, durable=False):
    """Writes text or bytes so that `path` never is half written; `durable`: not even after a power failure."""
    path = Path(path)
    beside = path.with_name(f".{path.name}.{uuid.uuid4().hex[:8]}.tmp")
    try:
        with open(beside, "wb") as file:
            file.write(data.encode() if isinstance(data, str) else data)
            if durable:
                file.flush()
                os.fsync(file.fileno())
        os.replace(beside, path)
    except OSError as error:
        beside.unlink(missing_ok=True)
        raise cannot_write(path, error) from None


def write_json(path, value, durable=False):
    write_whole(path, json.dumps(value, indent=1, sort_keys=True) + "\n", durable)


def read_json(path):
    """The value in a file; None if there is no such file or it is not JSON."""
    try:
        return json.loads(Path(path).read_bytes())
    except (OSError, ValueError, RecursionError):
        return None


def make_folder(path):
    try:
        Path(path).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise cannot_write(path, error) from None
    return Path(path)


def hash_of_file(path):
    digest = hashlib.sha256()
    with open(path, "rb") as file:
        while block := file.read(1 << 20):
            digest.update(block)
    return digest.hexdigest()


def hash_of_value(value):
    """The hash of a value of JSON, whatever the order of its keys."""
    return hashlib.sha256(json.dumps(value, sort_keys=True, separators=(",", ":")).encode()).hexdigest()

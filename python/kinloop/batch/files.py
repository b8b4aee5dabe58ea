"""What a path leads to, files that are written beside their target and renamed, and hashes of files."""

import contextlib
import errno
import hashlib
import json
import os
import shutil
import stat
import uuid
from pathlib import Path

from .errors import BatchError, OutputError

FULL = (errno.ENOSPC, errno.EDQUOT)
MAX_BYTES = 256 << 20  # of a file that is read as a whole
KINDS = {stat.S_IFREG: "file", stat.S_IFDIR: "folder", stat.S_IFIFO: "pipe", stat.S_IFSOCK: "socket", stat.S_IFCHR: "device",
         stat.S_IFBLK: "device"}  # fmt: skip


def kind_of(path):
    """What a path leads to, links followed; "nothing" also if that cannot be told."""
    try:
        return KINDS.get(stat.S_IFMT(os.stat(path).st_mode), "device")
    except (OSError, ValueError):
        return "nothing"


def open_file(path):
    """Opens a file to read its bytes. Throws OSError for anything else: a pipe would wait, and a device need not end."""
    kind = kind_of(path)
    if kind not in ("file", "nothing"):
        raise OSError(errno.EINVAL, f"is a {kind}, not a file", str(path))
    return open(path, "rb")


def read_bytes(path, most=MAX_BYTES):
    """The bytes of a file. Throws OSError, also for a file of more than `most` bytes, before it is read."""
    with open_file(path) as file:
        if os.fstat(file.fileno()).st_size > most:
            raise OSError(errno.EFBIG, f"is larger than {most / 1e6:.0f} MB", str(path))
        return file.read()


def disk_full(path):
    return OutputError(f"{path}: the disk is full; make room and run the same command again, finished runs are kept")


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
        with contextlib.suppress(OSError):
            beside.unlink()
        raise cannot_write(path, error) from None


def write_json(path, value, durable=False):
    write_whole(path, json.dumps(value, indent=1, sort_keys=True) + "\n", durable)


def read_json(path):
    """The value in a file; None if there is no such file or it is not JSON."""
    try:
        return json.loads(read_bytes(path))
    except (OSError, ValueError, RecursionError):
        return None


def make_folder(path):
    try:
        Path(path).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise cannot_write(path, error) from None
    return Path(path)


def remove(path):
    """Removes a file, link or folder as far as this user may."""
    shutil.rmtree(path, ignore_errors=True)
    with contextlib.suppress(OSError):
        os.unlink(path)


def hash_of_file(path):
    digest = hashlib.sha256()
    with open_file(path) as file:
        while block := file.read(1 << 20):
            digest.update(block)
    return digest.hexdigest()


def hash_of_value(value):
    """The hash of a value of JSON, whatever the order of its keys."""
    return hashlib.sha256(json.dumps(value, sort_keys=True, separators=(",", ":")).encode()).hexdigest()

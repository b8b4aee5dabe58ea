"""Whether this user has written a plan: by a signature with a key that only this user can read. A plan of somebody else may
name any program."""

import contextlib
import hashlib
import hmac
import os
import secrets
from pathlib import Path

from .files import read_bytes

KEY_BYTES = 32


def signature_of(text):
    """The signature of bytes; empty if there is no key and none can be written."""
    key = _key()
    return hmac.new(key, text, hashlib.sha256).hexdigest() if key else ""


def is_own(text, signature):
    return isinstance(signature, str) and signature.isascii() and signature != "" and hmac.compare_digest(signature, signature_of(text))


def _key():
    """The key of this user, which the first call makes."""
    path = Path(os.environ.get("XDG_STATE_HOME") or os.path.expanduser("~/.local/state")) / "kinloop/plan_key"
    with contextlib.suppress(OSError):
        if not path.exists():
            _make(path)
        key = read_bytes(path, KEY_BYTES)
        return key if len(key) == KEY_BYTES else None
    return None


def _make(path):
    path.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
    beside = path.with_name(f".{path.name}.{secrets.token_hex(4)}.tmp")
    try:
        with open(os.open(beside, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "wb") as file:
            file.write(secrets.token_bytes(KEY_BYTES))
        with contextlib.suppress(FileExistsError):
            os.link(beside, path)  # that of another process stays
    finally:
        beside.unlink(missing_ok=True)

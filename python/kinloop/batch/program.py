"""The program: what identifies it, and the defaults of its options."""

import os
import re
import shutil
import struct
import subprocess

from .errors import BatchError
from .files import hash_of_file

NT_GNU_BUILD_ID = 3
MAX_HEADER_BYTES = 1 << 20
PATIENCE_S = 60


def find_program(name):
    """The absolute path of a program. Throws BatchError if there is none."""
    found = shutil.which(name)
    if not found:
        raise BatchError(f"{name}: no such program; install kinloop or give its path with --program")
    return os.path.realpath(found)


def build_id(path):
    """The build id of an ELF program of 64 bits as hex digits; None if it has none."""
    with open(path, "rb") as file:
        data = file.read(MAX_HEADER_BYTES)
    if data[:6] != b"\x7fELF\x02\x01" or len(data) < 64:
        return None
    offset, size, count = struct.unpack_from("<Q", data, 32)[0], *struct.unpack_from("<HH", data, 54)
    for i in range(count):
        if offset + (i + 1) * size > len(data) or size < 56:
            return None
        kind, _, begin, _, _, length = struct.unpack_from("<IIQQQQ", data, offset + i * size)
        if kind == 4:  # PT_NOTE
            if found := _build_id_of_notes(data[begin : begin + length]):
                return found
    return None


def _build_id_of_notes(notes):
    place = 0
    while place + 12 <= len(notes):
        name_size, size, kind = struct.unpack_from("<III", notes, place)
        begin = place + 12 + (name_size + 3) // 4 * 4
        if kind == NT_GNU_BUILD_ID and notes[place + 12 : place + 16] == b"GNU\0" and begin + size <= len(notes):
            return notes[begin : begin + size].hex()
        place = begin + (size + 3) // 4 * 4
    return None


def identity_of(path):
    """What changes when the program changes: its build id, else the hash of its bytes."""
    try:
        found = build_id(path)
        return f"build-id:{found}" if found else f"sha256:{hash_of_file(path)}"
    except OSError as error:
        raise BatchError(f"{path}: cannot be read ({error.strerror})") from None


def default_options(program):
    """The defaults of --set by name. Throws BatchError if the program does not list them: without them, the keys of runs
    would be others."""
    call = [program, "run", "--options=all"]
    try:
        done = subprocess.run(call, capture_output=True, text=True, errors="replace", timeout=PATIENCE_S, check=False)
    except (OSError, subprocess.TimeoutExpired) as error:
        raise BatchError(f"{program}: cannot be run ({getattr(error, 'strerror', None) or 'no answer'}); is it kinloop?") from None
    if done.returncode:
        raise BatchError(f"{' '.join(call)} ended with {done.returncode}; is it kinloop 0.2 or newer?")
    return dict(re.findall(r"^  ([a-z][\w.]*)=(.*)$", done.stdout, re.MULTILINE))


def number_or_text(text):
    """Spellings of one number are equal: 0.5, 0.50."""
    try:
        return float(text)
    except ValueError:
        return text


def options_in_effect(options, defaults):
    """The options that differ from their defaults."""
    return {key: value for key, value in options.items()
            if key not in defaults or number_or_text(value) != number_or_text(defaults[key])}  # fmt: skip

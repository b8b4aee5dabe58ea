"""A YAML file as mappings that know their lines, so that each mistake is named where it stands."""

import difflib
import re
from pathlib import Path

from .errors import BatchError
from .files import read_bytes

MAX_BYTES = 1_000_000  # PyYAML needs up to 600 bytes for each
NO_TEXT = re.compile("[\0\ud800-\udfff]")


def _yaml():
    try:
        import yaml
    except ImportError:
        raise BatchError("PyYAML is missing: apt install python3-yaml, or pip install pyyaml") from None
    return yaml


class Value:
    """A node of the file."""

    def __init__(self, file, node, name=""):
        self.file, self.node, self.name = file, node, name

    def fail(self, problem, node=None):
        line = (node or self.node).start_mark.line + 1
        raise BatchError(f"{self.file}:{line}: {self.name + ': ' if self.name else ''}{problem}")

    def text(self):
        """The scalar as it is written: 0.5, true."""
        if self.node.id != "scalar" or self.node.tag.endswith(":null"):
            self.fail("expected a text or a number")
        if NO_TEXT.search(self.node.value):
            self.fail("holds a character that no name can have")
        return self.node.value

    def whole_number(self, lowest, highest):
        text = self.text()
        if not text.isascii() or not text.isdigit() or len(text) > 12 or not lowest <= int(text) <= highest:
            self.fail(f"'{text}': expected a whole number from {lowest} to {highest}")
        return int(text)

    def items(self):
        """The items of a list. A scalar is a list of one."""
        if self.node.id == "sequence":
            return [Value(self.file, item, self.name) for item in self.node.value]
        if self.node.id == "scalar" and not self.node.tag.endswith(":null"):
            return [self]
        return self.fail("expected a list")

    def is_mapping(self):
        return self.node.id == "mapping"

    def is_empty(self):
        return self.node.tag.endswith(":null")

    def fields(self, known=None):
        """The values of a mapping by name. `known`: the names that may occur; None: any."""
        if self.is_empty():
            return {}
        if not self.is_mapping():
            self.fail(f"expected {', '.join(known)}, each as 'name: value'" if known else "expected 'name: value'")
        found = {}
        for key, value in self.node.value:
            name = Value(self.file, key, self.name).text()
            if known is not None and name not in known:
                close = difflib.get_close_matches(name, known, 1)
                hint = f"did you mean '{close[0]}'?" if close else f"known here: {', '.join(known)}"
                self.fail(f"unknown key '{name}'; {hint}", key)
            if name in found:
                self.fail(f"'{name}' is given twice; remove one", key)
            found[name] = Value(self.file, value, name)
        return found


def read_yaml(path):
    """Returns the Value of the file. Throws BatchError with file and line."""
    yaml = _yaml()
    path = Path(path)
    try:
        data = read_bytes(path, MAX_BYTES)
    except OSError as error:
        raise BatchError(f"{path}: cannot be read ({error.strerror}); is this a suite?") from None
    try:
        node = yaml.compose(data, Loader=yaml.SafeLoader)
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        line = f":{mark.line + 1}" if mark else ""
        raise BatchError(f"{path}{line}: not YAML: {getattr(error, 'problem', None) or error}".split("\n")[0]) from None
    except (UnicodeDecodeError, RecursionError, ValueError) as error:
        raise BatchError(f"{path}: not YAML: {type(error).__name__}") from None
    if node is None:
        raise BatchError(f"{path}: empty; a suite has at least 'sequences:'")
    return Value(str(path), node)

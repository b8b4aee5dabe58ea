"""Reads the help of kinloop's commands: the one source of manual pages, completion and the check of documents."""
import re
import subprocess
from dataclasses import dataclass, field

COLUMN = 30  # where the texts of options and commands begin
HEADINGS = ("Positionals", "Options", "Subcommands")


@dataclass
class Item:
    """An argument, an option or a command, with its text."""

    left: str
    text: str = ""

    @property
    def flags(self):
        """The spellings of an option, ["-o", "--output"]."""
        return [re.sub(r"\{.*", "", flag) for flag in self.left.split(" ")[0].split(",")]

    @property
    def value(self):
        """What follows the flags, without the relations to other options; empty for a plain flag."""
        rest = self.left.partition(" ")[2]
        return re.sub(r"\s*(Needs|Excludes): .*|\s*\bREQUIRED\b", "", rest).strip()

    @property
    def choices(self):
        """The allowed values, if they are a list."""
        values = re.fullmatch(r"TEXT:([\w|-]+(?:, [\w|-]+)*)(?:=.*)?", self.value)
        return values.group(1).split(", ") if values else []


@dataclass
class Command:
    """The help of a command. `name` is what follows `kinloop`, "map merge"; empty for the program."""

    name: str
    description: str = ""
    usage: str = ""
    positionals: list = field(default_factory=list)
    options: list = field(default_factory=list)
    subcommands: list = field(default_factory=list)
    footer: list = field(default_factory=list)  # lines
    children: list = field(default_factory=list)  # Commands

    def walk(self):
        yield self
        for child in self.children:
            yield from child.walk()

    @property
    def flags(self):
        return [flag for option in self.options for flag in option.flags]


def output_of(program, *arguments):
    return subprocess.run([program, *arguments], check=True, capture_output=True, text=True).stdout


def split_row(line):
    """Splits a row into its left side and its text; a long left side stands alone."""
    left, text = line[:COLUMN].strip(), line[COLUMN:]
    if len(line) <= COLUMN or len(left) >= COLUMN - 2 or line[COLUMN - 1] != " ":
        return line.strip(), ""
    return left, text.strip()


def parse_rows(lines):
    """Takes the rows of a section off `lines`."""
    items = []
    while lines and lines[0].startswith("  "):
        line = lines.pop(0)
        if line.startswith(" " * COLUMN):
            items[-1].text = f"{items[-1].text} {line.strip()}".strip()
        else:
            items.append(Item(*split_row(line)))
    return items


def parse(name, text):
    """Returns the Command of the text that `kinloop NAME --help` prints."""
    command = Command(name)
    lines = text.splitlines()
    while lines and not lines[0].startswith("Usage: "):
        command.description += " " + lines.pop(0)
    command.description = command.description.strip()
    command.usage = lines.pop(0)[len("Usage: "):]
    while lines:
        heading = lines.pop(0)
        if heading.rstrip(":") in HEADINGS:
            setattr(command, heading.rstrip(":").lower(), parse_rows(lines))
        elif heading:
            command.footer = [heading, *lines]
            break
    return command


def read_commands(program, name=""):
    """Runs `kinloop NAME --help` for the program and, recursively, all of its commands."""
    command = parse(name, output_of(program, *name.split(), "--help"))
    command.children = [read_commands(program, f"{name} {row.left}".strip()) for row in command.subcommands]
    return command


def read_options(program, *which):
    """The options of --set as (key, default, text); `which` is "--options" or "--options=all"."""
    lines = output_of(program, "run", *which).splitlines()
    rows = [(a.strip().partition("="), b.strip()) for a, b in zip(lines, lines[1:])
            if re.fullmatch(r"  [a-z]\S*=.*", a) and b.startswith("      ")]
    return [(key, default, text) for (key, _, default), text in rows]

"""The command line of one command: options are declared once, help has the layout of the program's other commands, and
messages have its style."""

import argparse
import difflib
import textwrap

from .errors import UsageError

COLUMN = 30  # where texts begin, as in the help that the program makes; scripts/command_help.py reads it
WIDTH = 120


def number_from(lowest, highest, kind=int):
    """The type of an argument that is a number in a range."""

    def parse(text):
        try:
            value = kind(text)
        except ValueError:
            value = None
        if value is None or not lowest <= value <= highest:
            raise argparse.ArgumentTypeError(f"'{text}' is not a {'whole ' * (kind is int)}number from {lowest:.10g} to {highest:.10g}")
        return value

    parse.range_text = f":from {lowest:.10g} to {highest:.10g}"
    return parse


def _row(left, text):
    texts = textwrap.wrap(text, WIDTH - COLUMN)
    first = f"  {left}".ljust(COLUMN)
    lines = [first + texts.pop(0)] if len(first) == COLUMN and first.endswith(" ") else [first]
    return "\n".join(lines + [" " * COLUMN + line for line in texts])


def _left_of(action):
    """What stands before the text of an argument or option."""
    if not action.option_strings:
        return f"{action.metavar} TEXT{' REQUIRED' * action.required}"
    value = f" {action.metavar}{getattr(action.type, 'range_text', '')}" if action.metavar else ""
    return ",".join(action.option_strings) + value


def _text_of(action):
    default = action.default
    if default is None or default is False or default == argparse.SUPPRESS:
        return action.help
    return f"{action.help} (default: {default:g})" if isinstance(default, (int, float)) else f"{action.help} (default: {default})"


class Parser(argparse.ArgumentParser):
    """`name`: what follows `kinloop batch`. `commands`: (name, text) of the commands below it."""

    def __init__(self, name, description, commands=(), footer=""):
        super().__init__(f"kinloop batch {name}".strip(), description=description, add_help=False, allow_abbrev=False)
        self.commands, self.footer = commands, footer
        self.add_argument("-h", "--help", action="help", help="Print this help message and exit")
        self.add_argument("-q", "--quiet", action="store_true", help="print only results, warnings and errors")

    def add_text(self, metavar, text):
        """Adds a required argument."""
        self.add_argument(metavar.lower(), metavar=metavar, help=text)

    def add_option(self, *flags, metavar, text, kind=str, default=None):
        self.add_argument(*flags, metavar=metavar, help=text, type=kind, default=default)

    def add_flag(self, flag, text):
        self.add_argument(flag, action="store_true", help=text)

    def parse(self, words):
        """Returns the arguments. Throws UsageError that names what is wrong, and the closest known option."""
        arguments, left = self.parse_known_args(words)
        if left:
            word = next((word for word in left if word.startswith("-")), None)
            if word is None:
                self.error(f"unexpected argument '{left[0]}'")
            flag = word.partition("=")[0]
            close = difflib.get_close_matches(flag, [flag for action in self._actions for flag in action.option_strings], 1)
            self.error(f"unknown option {flag}" + (f"; did you mean '{close[0]}'?" if close else ""))
        return arguments

    def error(self, message):
        message = message.removeprefix("argument ").replace(": expected one argument", " requires a value")
        needed = "the following arguments are required: "
        if message.startswith(needed):
            message = message.removeprefix(needed).split(", ")[0] + " is missing"
        raise UsageError(f"{self.prog}: {message}{' See' if message.endswith('?') else '; see'} {self.prog} --help")

    def format_help(self):
        arguments = [action for action in self._actions if not action.option_strings]
        for action in arguments:
            action.required = not self.commands  # a command may stand in its place
        names = [action.metavar for action in arguments]
        usage = [self.prog, "[OPTIONS]", *(f"[{name}]" if self.commands else name for name in names)]
        parts = [
            f"{self.description}\nUsage: {' '.join(usage + ['[SUBCOMMAND]'] * bool(self.commands))}",
            "\n".join(["Positionals:", *(_row(_left_of(action), _text_of(action)) for action in arguments)]),
            "\n".join(["Options:", *(_row(_left_of(action), _text_of(action)) for action in self._actions if action.option_strings)]),
        ]
        if self.commands:
            parts.append("\n".join(["Subcommands:", *(_row(name, text) for name, text in self.commands)]))
        return "\n\n".join(parts + [self.footer] * bool(self.footer)) + "\n"

"""Which text may go into which output. Names come from suites, folders and results, and may hold any character."""

import re

# Of ASCII and C1, which terminals obey, those that separate lines or reverse the direction of writing, and halves of
# characters, by which Python stands for bytes that are not UTF-8.
CONTROL = re.compile("[\0-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff]")
FORMULA = re.compile(r"['=+@-]")  # how a cell begins that a spreadsheet computes; the quote only says that it is a text
LATEX = {c: "\\" + c for c in "&%$#_{}"} | {"\\": r"\textbackslash{}", "~": r"\textasciitilde{}", "^": r"\textasciicircum{}"}


def printable(text):
    """The text on one line and without control characters, which are written as \\n, \\x1b: for terminals and tables."""
    return CONTROL.sub(lambda match: _escape_of(ord(match[0])), text)


def _escape_of(code):
    if 0xDC80 <= code <= 0xDCFF:  # a byte that is not UTF-8
        code -= 0xDC00
    return "\\n" if code == 10 else f"\\x{code:02x}" if code < 256 else f"\\u{code:04x}"


def cell_of(text):
    """The text as a cell of CSV that a spreadsheet takes for a text."""
    return "'" + text if FORMULA.match(text) else text


def text_of_cell(cell):
    return cell[1:] if cell.startswith("'") and FORMULA.match(cell, 1) else cell


def latex_of(text):
    return re.sub(r"[&%$#_{}\\~^]", lambda match: LATEX[match[0]], text)

#!/usr/bin/env python3
"""Writes manual pages from the help of the program: kinloop.1, kinloop-COMMAND.1 and kinloop-options.7.

Usage: make_man_pages.py KINLOOP FOLDER
"""
import re
import sys
from pathlib import Path

from command_help import output_of, read_commands, read_options


def escape(text):
    text = text.replace("\\", "\\e").replace("-", "\\-")
    return re.sub(r"^([.'])", r"\\&\1", text)


def one_line(text):
    return text.splitlines()[0].rstrip(".")


def first_sentence(text):
    sentence = re.split(r"(?<=[a-z]{3})\. ", text)[0].rstrip(".")
    return sentence[0].lower() + sentence[1:]


def header(name, section, version, summary):
    return [f'.TH {name.upper()} {section} "" "{version}" "kinloop manual"', ".SH NAME",
            f"{escape(name)} \\- {escape(summary)}"]


def rows(items):
    lines = []
    for item in items:
        flags, _, rest = item.left.partition(" ")
        lines += [".TP", f"\\fB{escape(flags)}\\fR {escape(rest)}".rstrip(), escape(item.text)]
    return lines


def footer(lines):
    """Indented lines are kept as they are; others are filled."""
    page, kept = [], False
    for line in lines:
        if line.startswith("  ") != kept:
            page.append(".EE" if kept else ".EX")
            kept = not kept
        if not line:
            page.append(".PP")
        else:
            page.append(escape(line))
            if not kept and line.endswith(":"):
                page.append(".br")
    return page + ([".EE"] if kept else [])


def options_sections(command):
    page = []
    for title, items in (("ARGUMENTS", command.positionals), ("OPTIONS", command.options)):
        if items:
            page += [f".SH {title}", *rows(items)]
    return page


def child_sections(child):
    """A command of a command is a section."""
    page = [f".SH {escape('kinloop ' + child.name)}", escape(child.description), ".PP",
            f"\\fB{escape(child.usage)}\\fR", *rows(child.positionals), *rows(child.options)]
    return page + ([".PP", *footer(child.footer)] if child.footer else [])


def command_page(command, version):
    name = "kinloop-" + command.name
    page = header(name, 1, version, first_sentence(command.description))
    page += [".SH SYNOPSIS", f"\\fB{escape(command.usage)}\\fR", ".SH DESCRIPTION", escape(command.description)]
    if command.children:
        page += rows(command.subcommands)
    page += options_sections(command)
    if command.footer:
        page += [".SH NOTES", *footer(command.footer)]
    for child in command.children:
        page += child_sections(child)
    return page + [".SH SEE ALSO", ".BR kinloop (1),", ".BR kinloop\\-options (7)"]


def program_page(program, version):
    page = header("kinloop", 1, version, "RGB-D SLAM: camera trajectory and coloured 3D map from a depth camera")
    page += [".SH SYNOPSIS", "\\fBkinloop\\fR \\fICOMMAND\\fR [\\fIOPTIONS\\fR]", ".SH DESCRIPTION",
             escape(program.description), ".SH COMMANDS", *rows(program.subcommands)]
    page += options_sections(program)
    page.append(".SH EXIT STATUS")
    for code, meaning in (("0", "done"), ("1", "internal error"), ("2", "wrong use"),
                          ("3", "bad input, or results that could not be written"),
                          ("4", "tracking lost and not regained"),
                          ("5", "kinloop batch found a difference"),
                          ("129, 130, 143", "a run ended by SIGHUP, SIGINT (Ctrl-C), SIGTERM; its results are written"),
                          ("141", "the reader of standard output is gone")):
        page += [".TP", code, escape(meaning)]
    others = [f".BR kinloop\\-{child.name} (1)," for child in program.children]
    return page + [".SH SEE ALSO", *others, ".BR kinloop\\-options (7)"]


def options_page(options, version):
    page = header("kinloop-options", 7, version, "options of kinloop run --set")
    page += [".SH DESCRIPTION", escape("Options for --set KEY=VALUE, with their defaults."), ".SH OPTIONS"]
    for key, default, text in options:
        page += [".TP", f"\\fB{escape(key)}\\fR={escape(default)}", escape(text)]
    return page + [".SH SEE ALSO", ".BR kinloop\\-run (1)"]


def main():
    program_path, folder = sys.argv[1], Path(sys.argv[2])
    version = one_line(output_of(program_path, "--version"))
    program = read_commands(program_path)
    pages = {"kinloop.1": program_page(program, version),
             "kinloop-options.7": options_page(read_options(program_path, "--options=all"), version)}
    for command in program.children:
        pages[f"kinloop-{command.name}.1"] = command_page(command, version)
    folder.mkdir(parents=True, exist_ok=True)
    for name, page in pages.items():
        (folder / name).write_text("\n".join(page) + "\n")


if __name__ == "__main__":
    main()

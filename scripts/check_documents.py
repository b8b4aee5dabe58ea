#!/usr/bin/env python3
"""Checks that every kinloop command line in the documents names commands and options that exist, and that every page that
a file of the project names exists (check_references.py).

Usage: check_documents.py KINLOOP [FILE.md...]     (default: README.md, .github/CONTRIBUTING.md, docs/*.md, the references)
"""
import re
import sys
from pathlib import Path

import check_references
from command_help import read_commands, read_options

ROOT = Path(__file__).resolve().parent.parent


def code_lines(text):
    """Yields (line number, code) of fenced and indented blocks and of inline code that begins with kinloop."""
    fenced = False
    for number, line in enumerate(text.splitlines(), 1):
        if line.lstrip().startswith("```"):
            fenced = not fenced
        elif fenced or line.startswith("    "):
            yield number, line
        else:
            for code in re.findall(r"`([^`]+)`", line):
                if re.match(r"(\S*/)?kinloop \S", code):
                    yield number, code


def command_lines(code):
    """Yields the words that follow `kinloop` in a line of shell."""
    code = re.sub(r"(^|\s{2,})#.*| {6,}[a-z(].*", "", code)
    code = re.sub(r'"-[^"]*"', "VALUE", code)  # options for another program
    for part in re.split(r"&&|\|\||;|\$\(|(?<= )\| ", code):
        words = part.replace("[", " ").replace("]", " ").split()
        places = [i for i, word in enumerate(words) if re.fullmatch(r"(\S*/)?kinloop", word)]
        if not places or any(word in ("apt", "pip", "install", "cd", "image", "cmake", "build") for word in words[:places[0]]):
            continue
        yield words[places[0] + 1:]


def find_command(program, words):
    """Returns the command and the words after it; None if the first word is no command."""
    command = program
    while words and command.children and not words[0].startswith("-"):
        named = [child for child in command.children if child.name.split()[-1] == words[0]]
        if not named:
            return (command if command.positionals else None), words
        command, words = named[0], words[1:]
    return command, words


def check(program, keys, words):
    """Yields what is wrong with a command line."""
    if not words or not re.match(r"[a-z-]", words[0]) or words[0] in ("help", "..."):
        return
    command, rest = find_command(program, words)
    if command is None:
        yield f"unknown command: kinloop {' '.join(words)}"
        return
    known = {*command.flags, *program.flags}
    for word, following in zip(rest, [*rest[1:], ""]):
        if re.match(r"--?[a-zA-Z]", word) and word.partition("=")[0].rstrip(".,") not in known:
            yield f"kinloop {command.name} has no option {word}"
        key = following.partition("=")[0]
        if word == "--set" and re.fullmatch(r"[a-z_0-9.]+", key) and key not in keys:
            yield f"no option {key} of --set"


def all_keys(program_path, program):
    """Keys of --set of all commands: those of run, and those that footers list."""
    keys = {key for key, _, _ in read_options(program_path, "--options=all")}
    for command in program.walk():
        keys |= {match.group(1) for line in command.footer if (match := re.match(r"  ([a-z_0-9.]+)=", line))}
    # `kinloop features --set count=500`: the options of features without their prefix.
    return keys | {key.partition(".")[2] for key in keys if key.startswith("features.")}


def main():
    program_path = sys.argv[1]
    program = read_commands(program_path)
    keys = all_keys(program_path, program)
    files = [Path(name) for name in sys.argv[2:]] or [ROOT / "README.md", ROOT / ".github" / "CONTRIBUTING.md",
                                                      *sorted((ROOT / "docs").glob("*.md"))]
    checked, wrong = 0, 0
    for file in files:
        text = file.read_text()
        for number, code in code_lines(text):
            for words in command_lines(code):
                checked += 1
                for problem in check(program, keys, words):
                    print(f"{file}:{number}: {problem}")
                    wrong += 1
        if file.name != "CHANGELOG.md":  # every option that the page names
            prefixes = {key.partition(".")[0] for key in keys if "." in key}
            for name in re.findall(r"`(?:--set )?([a-z_]+\.[a-z_.0-9]+)(?:=[^`]*)?`", text):
                checked += 1
                if name.partition(".")[0] in prefixes and name not in keys:
                    print(f"{file}: no option {name}")
                    wrong += 1
    print(f"{checked} command lines and options checked, {wrong} wrong")
    dead = check_references.check()[1] if not sys.argv[2:] else 0
    return 1 if wrong or dead or not checked else 0


if __name__ == "__main__":
    sys.exit(main())

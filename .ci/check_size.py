#!/usr/bin/env python3
"""Counts what should not grow unnoticed, and fails if a number is larger than in .ci/size.csv.

usage: .ci/check_size.py [--list WHAT] [--update]

A commit that must make a number larger changes the table (--update), where its reader sees it. What is counted:

  lines              of .hpp and .cpp files of a module (a row of scripts/cmake/layers.txt)
  files              in a folder with more than 15 of them, without CMakeLists.txt and data; the table gives the reason
  words              of the README and of the pages of the site (docs/*.md)
  headers_one_user   .hpp files that one other source file includes, their own .cpp and tests not counted
  long_parameters    functions of the library with more than five parameters
  thresholds         numbers on which a module of the library decides: named constants of an arithmetic type whose value
                     is written as a number, `constexpr double kMaxError_m = 0.05;`, in any scope. Numbers that are not
                     named and constants computed from others are not counted
  options            fields of options structs: `visit` calls with a help text

Folders with one number for all of them are named "all". The last column is the reason for a folder of many files."""

import argparse
import csv
import functools
import pathlib
import re
import subprocess
import sys

SOURCE = pathlib.Path(__file__).resolve().parent.parent
TABLE = SOURCE / ".ci/size.csv"
COLUMNS = ["what", "where", "count", "reason"]
MOST_FILES, MOST_PARAMETERS = 15, 5
DATA_FOLDERS = ("docs/images", "tests/fuzz/corpus", "tests/fuzz/dictionaries")
DECIDING = ("tracking", "mapping", "loop", "back_end", "slam", "belief")
THRESHOLD = re.compile(r"\bconstexpr\s+(?:double|float|int|unsigned|size_t|u?int(?:8|16|32|64)_t)\s+([^;{}()]*);")
NUMBER = re.compile(r"k[A-Z]\w*\s*=\s*-?[\d.][\w.']*(?:\s*[-+*/]\s*[\d.][\w.']*)*$")
OPTION = re.compile(r'\bvisit\(\s*"\w+",\s*self\.\w+,')
INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]', re.M)
COMMENT_OR_TEXT = re.compile(r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|(?<![0-9A-Za-z_])\'(?:\\.|[^\'\\])\'', re.S)


@functools.lru_cache
def tracked():
    """All files under version control that are there."""
    listed = subprocess.run(["git", "-c", "safe.directory=*", "ls-files", "-z"], cwd=SOURCE, check=True,
                            capture_output=True, text=True).stdout
    return [path for path in map(pathlib.PurePosixPath, listed.split("\0")[:-1]) if (SOURCE / path).is_file()]


@functools.lru_cache
def text_of(path):
    return (SOURCE / path).read_text(errors="replace")


@functools.lru_cache
def code_of(path):
    """Without comments and texts."""
    return COMMENT_OR_TEXT.sub(lambda found: '""' if found[0][0] in "\"'" else " ", text_of(path))


def modules():
    rows = (SOURCE / "scripts/cmake/layers.txt").read_text().splitlines()
    return [row.partition(":")[0] for row in rows if ":" in row and not row.startswith("#")]


@functools.lru_cache
def sources():
    """The .hpp and .cpp files of all modules, with their module."""
    return {path: module for path in tracked() for module in modules()
            if path.suffix in (".hpp", ".cpp") and path.is_relative_to(module)}


def in_library(path):
    return path.parts[0] == "kinloop"


def count_lines():
    counts = dict.fromkeys(modules(), 0)
    for path, module in sources().items():
        counts[module] += text_of(path).count("\n")
    return counts, []


def count_files():
    counts = {}
    for path in tracked():
        folder = str(path.parent)
        if path.name != "CMakeLists.txt" and len(path.parts) > 1 and not folder.startswith(DATA_FOLDERS):
            counts[folder] = counts.get(folder, 0) + 1
    return {folder: count for folder, count in counts.items() if count > MOST_FILES}, []


def count_words():
    pages = [path for path in tracked() if path.match("docs/*.md") and len(path.parts) == 2]
    words = {str(path): len(text_of(path).split()) for path in [pathlib.PurePosixPath("README.md"), *pages]}
    return {"all": sum(words.values())}, [f"{page}: {count}" for page, count in words.items()]


def count_headers_with_one_user():
    users = {path: set() for path in sources() if path.suffix == ".hpp"}
    for path in sources():
        for name in INCLUDE.findall(text_of(path)):
            header = pathlib.PurePosixPath(name)
            if header in users and header.with_suffix("") != path.with_suffix(""):
                users[header].add(path)
    lonely = {header: user for header, (user, *others) in ((h, u) for h, u in users.items() if u) if not others}
    return {"all": len(lonely)}, [f"{header}: only {user}" for header, user in lonely.items()]


def declarations(code):
    """What stands in namespaces and classes, without the bodies of functions, as text with bodies cut to {}."""
    kept, stack, since = [], [], 0
    for at, character in enumerate(code):
        inside = all(stack)
        if character == "{":
            head = code[since:at]
            is_scope = bool(re.search(r"\b(namespace|struct|class|union|extern)\b[^()=;]*$", head))
            if inside:
                kept.append("{")
            stack.append(is_scope)
            since = at + 1
        elif character == "}" and stack:
            stack.pop()
            since = at + 1
            if all(stack):
                kept.append("}")
        else:
            if character == ";":
                since = at + 1
            if inside:
                kept.append(character)
    return "".join(kept)


def parameters(text):
    """How many parameters stand in a list: commas outside of brackets, braces and template arguments."""
    depth, count = 0, 1 if text.strip() else 0
    for character in text.replace("->", "").replace(">=", "").replace("<=", ""):
        depth += character in "([{<"
        depth -= character in ")]}>"
        count += character == "," and depth == 0
    return count


def closing(text, at):
    depth = 0
    for end in range(at, len(text)):
        depth += (text[end] == "(") - (text[end] == ")")
        if depth == 0:
            return end
    return len(text)


def functions(path):
    """(name, number of parameters) of what is declared or defined in a file."""
    code = re.sub(r"^\s*#[^\n]*(?:\\\n[^\n]*)*", "", code_of(path), flags=re.M)
    code = declarations(code)
    for found in re.finditer(r"\b(~?\w+|operator[^\s(]+)\s*\(", code):
        if found[1] not in ("if", "for", "while", "switch", "requires", "decltype", "sizeof", "alignas", "static_assert"):
            yield found[1], parameters(code[found.end(): closing(code, found.end() - 1)])


def count_long_parameter_lists():
    long = {(module, name, count): path for path, module in sources().items() if in_library(path)
            for name, count in functions(path) if count > MOST_PARAMETERS}
    return {"all": len(long)}, [f"{path}: {name} has {count}" for (_, name, count), path in long.items()]


def count_thresholds():
    counts, listed = {}, []
    for path, module in sources().items():
        if in_library(path) and path.parts[1] in DECIDING:
            for found in THRESHOLD.finditer(code_of(path)):
                numbers = [part.strip() for part in found[1].split(",") if NUMBER.match(part.strip())]
                counts[module] = counts.get(module, 0) + len(numbers)
                listed += [f"{path}: {number}" for number in numbers]
    return counts, listed


def count_options():
    listed = [f"{path}: {found[0]}" for path in sources() for found in OPTION.finditer(text_of(path))]
    return {"all": len(listed)}, listed


COUNTERS = {"lines": count_lines, "files": count_files, "words": count_words,
            "headers_one_user": count_headers_with_one_user, "long_parameters": count_long_parameter_lists,
            "thresholds": count_thresholds, "options": count_options}


def read_table():
    with open(TABLE, newline="") as file:
        return {(row["what"], row["where"]): row for row in csv.DictReader(file)}


def write_table(counts, before):
    with open(TABLE, "w", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        for (what, where), count in counts.items():
            reason = before.get((what, where), {}).get("reason", "")
            writer.writerow({"what": what, "where": where, "count": count, "reason": reason})


def complaints(counts, table):
    """What is larger than the table says, and which folders lack a reason."""
    for key, count in counts.items():
        row = table.get(key, {})
        before = int(row.get("count") or (MOST_FILES if key[0] == "files" else 0))
        if count > before:
            yield f"{key[0]} of {key[1]}: {count}, in .ci/size.csv {before}"
        if key[0] == "files" and not row.get("reason"):
            yield f"{key[1]} has {count} files, and .ci/size.csv gives no reason for more than {MOST_FILES}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--list", choices=COUNTERS, metavar="WHAT", help="print each thing that is counted")
    parser.add_argument("--update", action="store_true", help="write the numbers of today into the table")
    arguments = parser.parse_args()
    if arguments.list:
        print("\n".join(COUNTERS[arguments.list]()[1]))
        return 0
    counts = {(what, where): count for what, counter in COUNTERS.items() for where, count in sorted(counter()[0].items())}
    table = read_table() if TABLE.exists() else {}
    if arguments.update:
        write_table(counts, table)
        table = read_table()
    found = list(complaints(counts, table))
    print("\n".join(found) or f"{len(counts)} numbers, none larger than in .ci/size.csv")
    smaller = [key for key, row in table.items() if counts.get(key, 0) < int(row["count"])]
    if smaller:
        print(f"{len(smaller)} are smaller: .ci/check_size.py --update")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
"""Checks that what a file of the project names exists: pages with their headings (`docs/lab/README.md`), in sources, scripts
and tests; links of Markdown pages to files and headings; and files in `code` of the pages for users.

Usage: check_references.py
"""
import re
import sys
import unicodedata
from functools import lru_cache
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
NOT_OURS = {"build", "node_modules", ".git", "__pycache__", "corpus"}
TEXT = {"", ".cpp", ".hpp", ".in", ".py", ".pyi", ".sh", ".js", ".mjs", ".html", ".css", ".md", ".dox", ".cmake", ".txt",
        ".yml", ".yaml", ".toml", ".xml", ".json"}  # fmt: skip
MENTION = re.compile(r"(?<![\w/.-])((?:docs|\.github)/[\w./-]+\.md)(#[\w-]+)?")
PATH = re.compile(r"(?:\.ci|apps|bench|cmake|dense|docs|drivers|kinloop|python|ros|scripts|session|simulator|tests|tools|viewer)/[\w./-]+")
MADE_UP = re.compile(r"my|mine")  # names of the recipes
LINK = re.compile(r"\]\(([^)\s#]*)(#[^)\s]*)?\)")


def project_files(folder=ROOT):
    for path in sorted(folder.iterdir()):
        if path.is_dir() and not path.is_symlink():
            if path.name not in NOT_OURS:
                yield from project_files(path)
        elif path.is_file() and path.suffix in TEXT:
            yield path


def without_code(text):
    """The lines of a page that are not in fenced blocks; numbers stay."""
    fenced = False
    for number, line in enumerate(text.splitlines(), 1):
        if line.lstrip().startswith("```"):
            fenced = not fenced
        elif not fenced:
            yield number, line


def slug(heading):
    """The anchor of a heading, as mkdocs makes it."""
    text = re.sub(r"`|\[([^\]]*)\]\([^)]*\)", r"\1", heading)
    text = unicodedata.normalize("NFKD", text).encode("ascii", "ignore").decode()
    return re.sub(r"[-\s]+", "-", re.sub(r"[^\w\s-]", "", text).strip().lower())


@lru_cache(None)
def anchors(page):
    found, counts = set(), {}
    for _, line in without_code(page.read_text()):
        if match := re.match(r"#+ (.*)", line):
            name = slug(match[1])
            found.add(name if name not in counts else f"{name}_{counts[name]}")
            counts[name] = counts.get(name, 0) + 1
    return found


def problem(file, anchor):
    """What is wrong with a reference to a file and an anchor (`#heading` or empty); None if it holds."""
    if not file.exists():
        return f"no such file: {file.relative_to(ROOT) if file.is_relative_to(ROOT) else file}"
    if anchor and file.suffix == ".md" and anchor[1:] not in anchors(file):
        return f"no such heading: {file.relative_to(ROOT)}{anchor}"
    return None


def references(path, text):
    """Yields (line number, file, anchor) of the references in a file."""
    if path.suffix == ".md":
        for number, line in without_code(text):
            for target, anchor in LINK.findall(re.sub(r"`[^`]*`", "", line)):
                if not re.match(r"[a-z]+:|<", target):
                    yield number, (path.parent / target).resolve() if target else path, anchor
            if path.parent.name != "lab" and path.name != "CHANGELOG.md":
                for code in re.findall(r"`([^`]+)`", line):
                    if PATH.fullmatch(code) and not MADE_UP.search(code):
                        yield number, ROOT / code, ""
    for number, line in enumerate(text.splitlines(), 1):
        for name, anchor in MENTION.findall(line):
            yield number, ROOT / name, anchor


def check():
    """Prints what does not hold; returns the numbers of references and problems."""
    count, wrong = 0, 0
    for path in project_files():
        try:
            text = path.read_text()
        except UnicodeDecodeError:
            continue
        for number, file, anchor in references(path, text):
            count += 1
            if what := problem(file, anchor):
                print(f"{path.relative_to(ROOT)}:{number}: {what}")
                wrong += 1
    print(f"{count} references to pages checked, {wrong} wrong")
    return count, wrong


if __name__ == "__main__":
    counted, found = check()
    sys.exit(1 if found or not counted else 0)

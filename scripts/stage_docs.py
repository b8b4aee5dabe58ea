#!/usr/bin/env python3
"""Copies the pages of the documentation site into a folder: docs/ without its journals, CONTRIBUTING.md, the C++ reference.

Links from docs/ to a file of the project become links to a copy of it in files/. Journals (docs/lab) are named, not linked.
The places of the pages that name a reference become links to it.

Usage: stage_docs.py FOLDER [API_HTML]
"""
import re
import shutil
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
DOCS = ROOT / "docs"
CONTRIBUTING = ROOT / ".github" / "CONTRIBUTING.md"
NOT_STAGED = ("*.md", "Doxyfile", "reference.dox", "mkdocs.yml", "lab", "examples")
LINK = re.compile(r"\[([^\]]*)\]\(([^)\s#]+)(#[^)\s]*)?\)")
READABLE = (".md", ".txt", ".png", ".jpg", ".svg")
# Page, what it says, and where that leads in the site.
REFERENCES = {
    "architecture.md": ("the reference of all headers", "api/index.html"),
    "python.md": ("reference of the package", "python_reference.md"),
}


def moved(target, folder, staging):
    """Where the link `target` of a page in `folder` (docs or .github) leads in the site; None for a journal."""
    if re.match(r"[a-z]+:", target):
        return target
    file = (folder / target).resolve()
    if not file.is_relative_to(ROOT):
        return target
    if file == CONTRIBUTING:
        return file.name
    if file.is_relative_to(DOCS / "lab"):
        return None
    if file.is_relative_to(DOCS) and not file.is_relative_to(DOCS / "examples"):
        return file.relative_to(DOCS).as_posix()
    if file.is_file():
        name = file.relative_to(ROOT).as_posix()
        copy = staging / "files" / (name if file.suffix in READABLE else name + ".txt")
        copy.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(file, copy)
        return copy.relative_to(staging).as_posix()
    return target


def stage_page(page, staging):
    def link(match):
        target = moved(match[2], page.parent, staging)
        if target is None:
            return f"{match[1]} `docs/{match[2]}`"
        return f"[{match[1]}]({target}{match[3] or ''})"

    (staging / page.name).write_text(LINK.sub(link, page.read_text()))


def link_references(staging):
    for name, (words, target) in REFERENCES.items():
        page = staging / name
        text = page.read_text()
        if words not in text:
            sys.exit(f"{name}: expected '{words}', to be linked to {target}")
        page.write_text(text.replace(words, f"[{words}]({target})", 1))


def link_classes(staging):
    """Names like kinloop::Session in the table of architecture.md become links into the reference, as Doxygen makes them."""
    page = staging / "architecture.md"

    def link(match):
        for kind in ("class", "struct"):
            file = f"api/{kind}kinloop_1_1{match[1]}.html"
            if (staging / file).exists():
                return f"[kinloop::{match[1]}](<{file}>)"
        return f"`kinloop::{match[0][len('kinloop::'):]}`"

    page.write_text(re.sub(r"(?<![`:\w])kinloop::(\w+)(?!\w|::)(?=[,| ])|(?<![`:\w])kinloop::\w+::\w+", link, page.read_text()))


def main():
    staging = Path(sys.argv[1]).resolve()
    shutil.rmtree(staging, ignore_errors=True)
    shutil.copytree(DOCS, staging, ignore=shutil.ignore_patterns(*NOT_STAGED))
    if len(sys.argv) > 2:
        shutil.copytree(sys.argv[2], staging / "api")
    for page in [*sorted(DOCS.glob("*.md")), CONTRIBUTING]:
        stage_page(page, staging)
    if len(sys.argv) > 2:
        link_classes(staging)
        link_references(staging)


if __name__ == "__main__":
    main()

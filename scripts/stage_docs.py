#!/usr/bin/env python3
"""Copies the pages of the documentation site into a folder: docs/, CONTRIBUTING.md, CHANGELOG.md, the C++ reference.

Links from docs/ to a file of the project become links to a copy of it in files/, and links to headings of Doxygen's
main page become links to the reference.

Usage: stage_docs.py FOLDER [API_HTML]
"""
import re
import shutil
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
ROOT_PAGES = ("CONTRIBUTING.md", "CHANGELOG.md")
LINK = re.compile(r"(\]\()([^)\s#]+)(#[^)\s]*)?\)")


def moved(target, folder, staging):
    """Where the link `target` of a page in `folder` (docs or the root) leads in the site."""
    if re.match(r"[a-z]+:", target):
        return target
    file = (folder / target).resolve()
    if not file.is_relative_to(ROOT):
        return target
    name = file.relative_to(ROOT).as_posix()
    if name.startswith("docs/"):
        return name[len("docs/"):]
    if name in ROOT_PAGES:
        return name
    if file.is_file():
        copy = staging / "files" / (name if file.suffix in (".md", ".txt", ".png", ".jpg", ".svg") else name + ".txt")
        copy.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(file, copy)
        return copy.relative_to(staging).as_posix()
    return target


def stage_page(page, staging):
    text = LINK.sub(lambda m: f"{m[1]}{moved(m[2], page.parent, staging)}{m[3] or ''})", page.read_text())
    (staging / page.name).write_text(text)


def link_reference(staging):
    """Names like kinloop::Session in api.md become links into the reference, as Doxygen makes them."""
    page = staging / "api.md"

    def link(match):
        for kind in ("class", "struct"):
            file = f"api/{kind}kinloop_1_1{match[1]}.html"
            if (staging / file).exists():
                return f"[kinloop::{match[1]}](<{file}>)"
        return f"`kinloop::{match[0][len('kinloop::'):]}`"

    text = re.sub(r"(?<![`:\w])kinloop::(\w+)(?!\w|::)(?=[,| ])|(?<![`:\w])kinloop::\w+::\w+", link, page.read_text())
    page.write_text(text + "\n[The complete reference](api/index.html), made by Doxygen from the headers.\n")


def main():
    staging = Path(sys.argv[1]).resolve()
    shutil.rmtree(staging, ignore_errors=True)
    shutil.copytree(ROOT / "docs", staging, ignore=shutil.ignore_patterns("*.md", "Doxyfile"))
    if len(sys.argv) > 2:
        shutil.copytree(sys.argv[2], staging / "api")
    for page in [*sorted((ROOT / "docs").glob("*.md")), *(ROOT / name for name in ROOT_PAGES)]:
        stage_page(page, staging)
    if len(sys.argv) > 2:
        link_reference(staging)


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""Checks the links of a folder of HTML pages: the file and the heading of every link within it must exist, and no page
may load anything from another server.

Usage: check_links.py FOLDER
"""
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

LOADED = {("script", "src"), ("img", "src"), ("source", "src"), ("iframe", "src")}


class Page(HTMLParser):
    """The links, the loaded files and the ids of a page."""

    def __init__(self, text):
        super().__init__()
        self.links, self.loaded, self.ids = [], [], set()
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        named = dict(attrs)
        for name in ("id", "name"):
            if named.get(name):
                self.ids.add(named[name])
        for name in ("href", "src"):
            if named.get(name) is None:
                continue
            self.links.append(named[name])
            if (tag, name) in LOADED or (tag == "link" and "stylesheet" in named.get("rel", "")):
                self.loaded.append(named[name])


def main():
    folder = Path(sys.argv[1]).resolve()
    pages = {path: Page(path.read_text(errors="replace")) for path in sorted(folder.rglob("*.html"))}
    links, problems = 0, []
    for path, page in pages.items():
        # The reference has links to headings of its own that Doxygen checks.
        in_reference = "api" in path.relative_to(folder).parts[:-1]
        problems += [f"{path}: loads {target}" for target in page.loaded if urlsplit(target).netloc]
        for target in page.links:
            parts = urlsplit(target)
            if parts.scheme or parts.netloc:
                continue
            links += 1
            file = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            if file.is_dir():
                file /= "index.html"
            if path.name == "404.html" and parts.path.startswith("/"):
                file = folder / unquote(parts.path).lstrip("/")
                if file.is_dir():
                    file /= "index.html"
            if not file.exists():
                problems.append(f"{path.relative_to(folder)}: no such file: {target}")
            elif parts.fragment and not in_reference and file in pages and unquote(parts.fragment) not in pages[file].ids:
                problems.append(f"{path.relative_to(folder)}: no such heading: {target}")
    print("\n".join(problems[:50]))
    print(f"{len(pages)} pages, {links} links within them, {len(problems)} dead or external")
    return 1 if problems or not pages else 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
"""Runs clang-tidy on the library, the program and the viewer.

Skips sources that passed before with the same content, headers and checks: .ci/tidy_passed.txt holds their
hashes, which cover only project files. Use --all after a change of compiler or system headers.

  .ci/tidy.py            check what has changed
  .ci/tidy.py --all      check everything
  .ci/tidy.py --record   also record what passed
"""

import argparse
import concurrent.futures
import hashlib
import os
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
PASSED = ROOT / ".ci" / "tidy_passed.txt"
FOLDERS = ["kinloop", "drivers", "simulator", "tools", "viewer", "apps", "ros"]
BUILD = ROOT / "build" / "tidy"
COMMENT = re.compile(r"//(?!.*NOLINT)[^\n]*")
INCLUDE = re.compile(r'^\s*#\s*include\s+"([^"]+)"', re.MULTILINE)


def included(path, seen):
    """Returns `path` and all project files that it includes, directly or indirectly."""
    if path in seen or not path.is_file():
        return seen
    seen.add(path)
    for name in INCLUDE.findall(path.read_text(encoding="utf-8")):
        included(ROOT / name, seen)
    return seen


def content_hash(source):
    digest = hashlib.sha256((ROOT / ".clang-tidy").read_bytes())
    for path in sorted(included(source, set())):
        code = " ".join(COMMENT.sub("", path.read_text(encoding="utf-8")).split())
        digest.update(f"{path.relative_to(ROOT)}\0{code}\0".encode())
    return digest.hexdigest()


def tidy(source):
    result = subprocess.run(["clang-tidy", "--quiet", "-p", BUILD, source], capture_output=True, text=True)
    return result.returncode == 0, result.stdout


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--all", action="store_true", help="check everything")
    parser.add_argument("--record", action="store_true", help="record what passed")
    arguments = parser.parse_args()

    # clang-tidy only needs the compile commands of the single sources; nothing is built.
    subprocess.run(["cmake", "--preset", "tidy", "--log-level=WARNING"], cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
    sources = sorted(path for folder in FOLDERS for path in (ROOT / folder).rglob("*.cpp")
                     if "node_modules" not in path.parts)
    hashes = {source: content_hash(source) for source in sources}
    known = set(PASSED.read_text().split()) if PASSED.exists() and not arguments.all else set()
    passed = {source for source in sources if hashes[source] in known}
    todo = [source for source in sources if source not in passed]
    print(f"clang-tidy: {len(todo)} of {len(sources)} sources to check", flush=True)

    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for source, (ok, findings) in zip(todo, pool.map(tidy, todo)):
            if ok:
                passed.add(source)
            else:
                print(f"{source.relative_to(ROOT)}:\n{findings}", flush=True)
    if arguments.record:
        PASSED.write_text("".join(f"{hashes[s]} {s.relative_to(ROOT)}\n" for s in sorted(passed)))
    return 0 if len(passed) == len(sources) else 1


if __name__ == "__main__":
    sys.exit(main())

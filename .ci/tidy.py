#!/usr/bin/env python3
"""Runs clang-tidy on the library, the program and the viewer.

Sources are checked as the unity build combines them, which takes a tenth of the time, since most of it goes to system
headers. The static analyzer looks only into main files, so it needs --all.

  .ci/tidy.py          all but the static analyzer and some slow checks; about 10 minutes on 2 cores
  .ci/tidy.py --all    every check, source by source; more than an hour on 2 cores
"""

import argparse
import concurrent.futures
import json
import os
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
BUILD = ROOT / "build" / "tidy"
FOLDERS = ("kinloop", "dense", "session", "drivers", "simulator", "tools", "viewer", "apps", "ros")
# These take a quarter of the time, since they look at all system headers, and gcc warns of most that they find.
SLOW = ("reserved-identifier", "stringview-nullptr", "suspicious-string-compare", "multiple-statement-macro",
        "assert-side-effect", "infinite-loop", "suspicious-semicolon", "sizeof-expression", "dangling-handle")
SOURCES = rf"{ROOT}/({'|'.join(FOLDERS)})/.*\.[ch]pp$"


def translation_units(unity):
    """Configures (nothing is built) and returns the files that the compiler would see."""
    subprocess.run(["cmake", "--preset", "tidy", f"-DCMAKE_UNITY_BUILD={'ON' if unity else 'OFF'}", "--log-level=WARNING"],
                   cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
    files = {command["file"] for command in json.loads((BUILD / "compile_commands.json").read_text())}
    folders = tuple(f"{base}/{folder}/" for base in (ROOT, BUILD) for folder in FOLDERS)
    return sorted(file for file in files if file.startswith(folders))


def tidy(file, checks):
    command = ["clang-tidy", "--quiet", f"--config-file={ROOT}/.ci/clang-tidy", f"--checks={checks}", f"--header-filter={SOURCES}",
               "--extra-arg=-Wno-unknown-warning-option", "--extra-arg=-Wno-shadow", "-p", BUILD, file]
    result = subprocess.run(command, capture_output=True, text=True)
    return result.returncode == 0, result.stdout


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--all", action="store_true", help="every check, source by source")
    every = parser.parse_args().all

    files = translation_units(unity=not every)
    # Combined sources include each other. They also share anonymous namespaces, where names shadow each other
    # (-Wno-shadow above); the build itself warns of true shadowing.
    without = ["-clang-analyzer-*", "-bugprone-suspicious-include"] + [f"-bugprone-{check}" for check in SLOW]
    checks = "" if every else ",".join(without)
    failed = 0
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for ok, findings in pool.map(lambda file: tidy(file, checks), files):
            if not ok:
                failed += 1
                print(findings, flush=True)
    print(f"clang-tidy: {failed} of {len(files)} translation units with findings")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())

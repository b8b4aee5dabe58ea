#!/usr/bin/env python3
"""Runs clang-tidy on the library, the program and the viewer.

Sources are checked as the unity build combines them, which takes a tenth of the time, since most of it goes to system
headers. The static analyzer looks only into main files, so it needs --all. What has passed is not checked again until a
byte of it, of a header that it includes, of its command or of the checks changes (build/tidy/passed).

  .ci/tidy.py          all but the static analyzer and some slow checks; about 6 minutes on 2 cores if nothing has passed
  .ci/tidy.py --all    every check, source by source; more than an hour on 2 cores
"""

import argparse
import concurrent.futures
import functools
import hashlib
import json
import os
import pathlib
import shlex
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
BUILD = ROOT / "build" / "tidy"
FOLDERS = ("kinloop", "dense", "session", "drivers", "simulator", "tools", "viewer", "apps", "ros")
# These take a quarter of the time, since they look at all system headers, and gcc warns of most that they find.
SLOW = ("reserved-identifier", "stringview-nullptr", "suspicious-string-compare", "multiple-statement-macro",
        "assert-side-effect", "infinite-loop", "suspicious-semicolon", "sizeof-expression", "dangling-handle")
SOURCES = rf"{ROOT}/({'|'.join(FOLDERS)})/.*\.[ch]pp$"
PASSED = BUILD / "passed"
# The packaged one is newer than Debian's and takes half the time, since it does not look at system headers.
PACKAGED = ROOT / "build" / "test_packages" / "bin" / "clang-tidy"
CLANG_TIDY = str(PACKAGED) if PACKAGED.exists() else "clang-tidy"
FOR_DEBIAN = ("/usr/include/boost/mpl/", "/usr/include/CGAL/")  # headers that newer ones refuse
KEPT_S = 30 * 24 * 3600  # how long a file there that is not used stays


def translation_units(unity):
    """Configures (nothing is built) and returns the files that the compiler would see."""
    subprocess.run(["cmake", "--preset", "tidy", f"-DCMAKE_UNITY_BUILD={'ON' if unity else 'OFF'}", "--log-level=WARNING"],
                   cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
    commands = {entry["file"]: entry for entry in json.loads((BUILD / "compile_commands.json").read_text())}
    folders = tuple(f"{base}/{folder}/" for base in (ROOT, BUILD) for folder in FOLDERS)
    return [commands[file] for file in sorted(commands) if file.startswith(folders)]


@functools.lru_cache(maxsize=None)
def digest_of(path):
    return hashlib.sha256(pathlib.Path(path).read_bytes()).hexdigest()


@functools.lru_cache(maxsize=None)
def version(tool):
    return subprocess.run([tool, "--version"], capture_output=True, text=True, check=True).stdout


def dependencies(entry):
    """All files that the compiler of the build reads for a translation unit, which clang-tidy reads as well."""
    words = shlex.split(entry["command"])
    at = words.index("-o")
    del words[at: at + 2]
    words[words.index("-c")] = "-M"
    listed = subprocess.run([*words, "-w"], cwd=entry["directory"], capture_output=True, text=True, check=True)
    return listed.stdout.replace("\\\n", " ").split()[1:]


def mark_of(tool, entry, files, checks):
    """The file that says that a translation unit has passed, named after all that clang-tidy looks at."""
    seen = [version(tool), digest_of(ROOT / ".ci/clang-tidy"), digest_of(__file__), checks, entry["command"]]
    seen += [f"{file} {digest_of(pathlib.Path(entry['directory']) / file)}" for file in files]
    return PASSED / hashlib.sha256("\n".join(seen).encode()).hexdigest()


def tidy(entry, checks):
    """Whether a translation unit has passed, what was found, and whether that was known."""
    files = dependencies(entry)
    tool = "clang-tidy" if any(file.startswith(FOR_DEBIAN) for file in files) else CLANG_TIDY
    mark = mark_of(tool, entry, files, checks)
    if mark.exists():
        mark.touch()
        return True, "", True
    passed, findings = findings_of(tool, entry["file"], checks)
    if passed:
        mark.touch()
    return passed, findings, False


def findings_of(tool, file, checks):
    command = [tool, "--quiet", f"--config-file={ROOT}/.ci/clang-tidy", f"--checks={checks}", f"--header-filter={SOURCES}",
               "--extra-arg=-Wno-unknown-warning-option", "--extra-arg=-Wno-shadow",
               "--extra-arg=-Wno-deprecated-declarations", "-p", BUILD, file]
    result = subprocess.run(command, capture_output=True, text=True)
    return result.returncode == 0, result.stdout


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--all", action="store_true", help="every check, source by source")
    every = parser.parse_args().all

    units = translation_units(unity=not every)
    PASSED.mkdir(exist_ok=True)
    # Combined sources include each other. They also share anonymous namespaces, where names shadow each other
    # (-Wno-shadow above); the build itself warns of true shadowing.
    without = ["-clang-analyzer-*", "-bugprone-suspicious-include"] + [f"-bugprone-{check}" for check in SLOW]
    checks = "" if every else ",".join(without)
    failed = unchanged = 0
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for passed, findings, known in pool.map(lambda unit: tidy(unit, checks), units):
            unchanged += known
            if not passed:
                failed += 1
                print(findings, flush=True)
    for mark in PASSED.iterdir():
        if time.time() - mark.stat().st_mtime > KEPT_S:
            mark.unlink()
    print(f"clang-tidy: {failed} of {len(units)} translation units with findings, {unchanged} had passed before")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
"""Fails if a test was skipped that is not listed in allowed_skips.txt.

usage: .ci/check_skips.py build/release/tests.xml"""

import fnmatch
import pathlib
import sys
import xml.etree.ElementTree as xml

HERE = pathlib.Path(__file__).parent
SHARED_DATA = HERE.parent.parent / "shared" / "data"


def allowed_patterns():
    """The patterns of allowed_skips.txt; those under [without shared data] apply only if it is missing."""
    patterns, counts = [], True
    for line in (HERE / "allowed_skips.txt").read_text().splitlines():
        line = line.split("#")[0].strip()
        if line == "[without shared data]":
            counts = not SHARED_DATA.exists()
        elif line and counts:
            patterns.append(line)
    return patterns


def main():
    patterns = allowed_patterns()
    tests = xml.parse(sys.argv[1]).getroot().iter("testcase")
    skipped = [test.get("name") for test in tests if test.find("skipped") is not None]
    refused = [name for name in skipped if not any(fnmatch.fnmatchcase(name, p) for p in patterns)]
    for name in refused:
        print(f"skipped, but not in .ci/allowed_skips.txt: {name}")
    print(f"{len(skipped)} tests skipped, {len(refused)} of them not allowed")
    return 1 if refused else 0


if __name__ == "__main__":
    sys.exit(main())

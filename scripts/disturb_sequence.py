#!/usr/bin/env python3
"""Copies a sequence in TUM layout with disturbances painted into colour and depth, to test what a SLAM system makes of
things that move, cover, freeze or empty the view.

    scripts/disturb_sequence.py SEQUENCE COPY --do part:share=0.25,depth_m=0.6 [--do KIND[:NAME=VALUE,...]]... --seed N

Parameters that are not given are drawn from the seed: size, depth, texture, speed, place, and when it begins (`first`,
a frame) and how long it lasts (`seconds`). COPY/disturbance.json tells what was done and when. Images without a
disturbance are links to those of SEQUENCE; ground truth is copied unchanged. The depth has to be registered to colour.
Needs numpy and Pillow. degrade_sequence.py beside it makes whole sequences worse."""

import argparse
import json
import shutil
import sys
from pathlib import Path

from disturbances import KINDS, Disturbance
from painting import Frame
from tum_folder import depth_scale, read_color, rows_of, write_color, write_depth_m


def parse_step(text):
    """(kind, given parameters) of KIND:NAME=VALUE,..."""
    name, _, words = text.partition(":")
    if name not in KINDS:
        raise argparse.ArgumentTypeError(f"no kind {name}; there are {', '.join(KINDS)}")
    given = {}
    for word in filter(None, words.split(",")):
        key, _, value = word.partition("=")
        try:
            given[key] = int(value) if value.isdecimal() else float(value)
        except ValueError:
            given[key] = value
    return name, given


def write_frame(frame, row, copy):
    """Writes the images that were painted and links to the others; returns the row of the new lists."""
    color, depth = copy / row[1], copy / row[3]
    for path, source, painted in ((color, frame.color_path, frame.painted_color),
                                  (depth, frame.depth_path, frame.painted_depth_m)):
        path.unlink(missing_ok=True)  # it may be a link, and writing would go through it
        if painted is None:
            path.symlink_to(source.resolve())
    if frame.painted_color is not None:
        write_color(color, frame.painted_color)
    if frame.painted_depth_m is not None:
        write_depth_m(depth, frame.painted_depth_m, frame.scale)


def write_lists(rows, copy):
    for name, first in (("rgb.txt", 0), ("depth.txt", 2)):
        (copy / name).write_text("".join(" ".join(row[first : first + 2]) + "\n" for row in rows))
    (copy / "associations.txt").write_text("".join(" ".join(row) + "\n" for row in rows))


def prepare_copy(sequence, copy, rows):
    camera = (sequence / "camera.yaml").read_text()
    if any(line.startswith("depth:") for line in camera.splitlines()):
        raise ValueError(f"{sequence / 'camera.yaml'}: the depth is not registered to colour")
    for folder in {(copy / row[column]).parent for row in rows for column in (1, 3)}:
        folder.mkdir(parents=True, exist_ok=True)
    for name in ("camera.yaml", "groundtruth.txt"):
        if (sequence / name).exists():
            shutil.copy(sequence / name, copy)


def disturb(sequence, copy, steps, seed, frames=None):
    """Writes the disturbed copy; returns what is in its disturbance.json."""
    rows = rows_of(sequence / "associations.txt")[:frames]
    scale, stamps_s = depth_scale(sequence), [float(row[0]) for row in rows]
    shape = read_color(sequence / rows[0][1]).shape[:2]
    disturbances = [Disturbance(name, given, seed, stamps_s, shape) for name, given in steps]
    prepare_copy(sequence, copy, rows)
    kept = []
    for index, row in enumerate(rows):
        frame = Frame(index, row, sequence, scale)
        for disturbance in disturbances:
            disturbance.paint(frame)
        if not frame.removed:
            write_frame(frame, row, copy)
            kept.append(row)
    write_lists(kept, copy)
    record = {"source": str(sequence.resolve()), "seed": seed, "disturbances": [
        {"kind": d.name, "parameters": d.parameters, "begin_s": stamps_s[d.first], "end_s": stamps_s[d.last]}
        for d in disturbances]}
    (copy / "disturbance.json").write_text(json.dumps(record, indent=2) + "\n")
    return record


def kinds_help():
    return "\n".join(f"  {name:13}{kind.help}\n{'':15}({', '.join([*kind.draws, 'first', 'seconds'])})"
                     for name, kind in KINDS.items())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter,
                                     epilog=kinds_help())
    parser.add_argument("sequence", type=Path)
    parser.add_argument("copy", type=Path)
    parser.add_argument("--do", dest="steps", action="append", type=parse_step, required=True, metavar="KIND[:...]")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--frames", type=int, help="only the first so many")
    args = parser.parse_args()
    try:
        record = disturb(args.sequence, args.copy, args.steps, args.seed, args.frames)
    except (ValueError, OSError) as error:
        sys.exit(f"disturb_sequence.py: {error}")
    for disturbance in record["disturbances"]:
        print("{kind}: {begin_s:.6f} to {end_s:.6f}, {parameters}".format(**disturbance))


if __name__ == "__main__":
    main()

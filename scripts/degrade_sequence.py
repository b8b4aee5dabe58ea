#!/usr/bin/env python3
"""Copies a sequence in TUM layout with degraded images, to test the robustness of a SLAM system.

    scripts/degrade_sequence.py SEQUENCE COPY --do dim,noise [--frames 200] [--first 0] [--seed 1]

--help lists the degradations. Several are applied in order. Ground truth is copied unchanged.
Needs numpy and Pillow."""

import argparse
import shutil
from pathlib import Path

import numpy as np
from PIL import Image, ImageFilter
from tum_folder import depth_scale, read_color, read_depth_m, rows_of, write_color, write_depth_m


class Frame:
    """A pair of images: colour as floats from 0 to 255, depth in metres."""

    def __init__(self, index, row, folder, scale):
        self.index, self.color_s, self.depth_s = index, float(row[0]), float(row[2])
        self.color = read_color(folder / row[1]).astype(float)
        self.depth_m = read_depth_m(folder / row[3], scale)


def dim(frame, rng):
    """a quarter of the contrast, in the dark"""
    frame.color = 30 + 0.25 * frame.color


def plain(frame, rng):
    """hardly any texture: blurred by 3 px, a third of the contrast"""
    blurred = Image.fromarray(frame.color.astype(np.uint8)).filter(ImageFilter.GaussianBlur(3))
    frame.color = 85 + np.asarray(blurred, float) / 3


def exposure(frame, rng):
    """brightness jumps by up to three times every 20 frames, as with automatic exposure"""
    gain = (1.0, 0.4, 1.6, 0.55, 1.25)[frame.index // 20 % 5]
    frame.color = frame.color * gain


def gamma(frame, rng):
    """gamma drifts between 0.5 and 2"""
    frame.color = 255 * (frame.color / 255) ** (2 ** np.sin(frame.index / 25))


def noise(frame, rng):
    """grey noise of 12 levels"""
    frame.color = frame.color + rng.normal(0, 12, frame.color.shape[:2])[..., None]


def near(frame, rng):
    """no depth beyond 2 m"""
    frame.depth_m[frame.depth_m > 2] = 0


def holes(frame, rng):
    """two thirds of the depth image missing in blocks of a sixteenth of the width"""
    height, width = frame.depth_m.shape
    side = width // 16
    keep = rng.random((height // side + 1, 17)) < 1 / 3
    frame.depth_m *= np.kron(keep, np.ones((side, side)))[:height, :width]


def rough(frame, rng):
    """depth noise of 8 mm"""
    frame.depth_m += (frame.depth_m > 0) * rng.normal(0, 0.008, frame.depth_m.shape)


def blind(frame, rng):
    """no depth at all in frames 60 to 89"""
    if 60 <= frame.index < 90:
        frame.depth_m[:] = 0


def walker(frame, rng):
    """a person in a chequered shirt, a third of the image wide, walks past at 1.1 m every 60 frames"""
    height, width = frame.depth_m.shape
    left = int((frame.index % 60 / 60 * 1.66 - 0.33) * width)
    columns = slice(*np.clip((left, left + width // 3), 0, width))
    y, x = np.mgrid[:height, columns]
    check = (y * 16 // width + (x - left) * 16 // width) % 2
    frame.color[:, columns] = (90 + 40 * check)[..., None]
    frame.depth_m[:, columns] = 1.1


def jitter(frame, rng):
    """depth stamped 8 ms early, with 4 ms of jitter"""
    frame.depth_s += rng.normal(-0.008, 0.004)


def dropped(frame, rng):
    """one in eight colour images and one in eight depth images are lost"""
    if rng.random() < 1 / 8:
        frame.color = None
    if rng.random() < 1 / 8:
        frame.depth_m = None


DEGRADATIONS = {f.__name__: f for f in (dim, plain, exposure, gamma, noise, near, holes, rough, blind, walker,
                                        jitter, dropped)}


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter,
                                     epilog="\n".join(f"  {n:10}{f.__doc__}" for n, f in DEGRADATIONS.items()))
    parser.add_argument("sequence", type=Path)
    parser.add_argument("copy", type=Path)
    parser.add_argument("--do", default="", help="degradations to apply, separated by commas")
    parser.add_argument("--frames", type=int, default=10**9)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--step", type=int, default=1, help="keep every n-th frame")
    parser.add_argument("--seed", type=int, default=1)
    return parser.parse_args()


def main():
    args = arguments()
    steps = [DEGRADATIONS[name] for name in args.do.split(",") if name]
    rng = np.random.default_rng(args.seed)
    scale = depth_scale(args.sequence)
    for name in ("rgb", "depth"):
        (args.copy / name).mkdir(parents=True, exist_ok=True)
    for name in ("camera.yaml", "groundtruth.txt"):
        shutil.copy(args.sequence / name, args.copy)
    rows = rows_of(args.sequence / "associations.txt")[args.first :: args.step][: args.frames]
    with open(args.copy / "rgb.txt", "w") as color_list, open(args.copy / "depth.txt", "w") as depth_list:
        for index, row in enumerate(rows):
            frame = Frame(index, row, args.sequence, scale)
            for step in steps:
                step(frame, rng)
            if frame.color is not None:
                name = f"rgb/{frame.color_s:.6f}.png"
                write_color(args.copy / name, frame.color)
                color_list.write(f"{frame.color_s:.6f} {name}\n")
            if frame.depth_m is not None:
                name = f"depth/{frame.depth_s:.6f}.png"
                write_depth_m(args.copy / name, frame.depth_m, scale)
                depth_list.write(f"{frame.depth_s:.6f} {name}\n")


if __name__ == "__main__":
    main()

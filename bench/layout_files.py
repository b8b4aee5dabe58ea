"""Frames of a recording, and writers of the image formats that people hand over. Needs numpy and Pillow."""

import io
import pathlib
import struct
import sys
import zlib

import numpy as np
from PIL import Image

SOURCE = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(SOURCE / "scripts"))
from tum_folder import depth_scale, pose_matrix, read_depth_m, rows_of  # noqa: E402


class Sample:
    """Colour (h, w, 3) of 8 bits, depth in mm of 16 bits, poses (4, 4) world from camera, and K (3, 3)."""

    def __init__(self, folder, frames, step):
        rows = rows_of(folder / "associations.txt")[::step][:frames]
        scale = depth_scale(folder)
        images = [Image.open(folder / row[1]).convert("RGB") for row in rows]
        self.size = (images[0].width // 2, images[0].height // 2)
        self.color = [np.asarray(image.resize(self.size, Image.BOX)) for image in images]
        self.mm = [(1000 * read_depth_m(folder / row[3], scale)[::2, ::2]).round().astype(np.uint16) for row in rows]
        text = dict(line.split(":")[:2] for line in (folder / "camera.yaml").read_text().splitlines() if ":" in line)
        fx, fy, cx, cy = (float(text[key].split("#")[0]) for key in ("fx", "fy", "cx", "cy"))
        self.K = np.array([[fx / 2, 0, cx / 2 - 0.25], [0, fy / 2, cy / 2 - 0.25], [0, 0, 1]])
        truth = np.array([[float(x) for x in row] for row in rows_of(folder / "groundtruth.txt")])
        self.poses = [pose_matrix(truth[np.argmin(abs(truth[:, 0] - float(row[0])))]) for row in rows]

    def intrinsics(self):
        return self.K[0, 0], self.K[1, 1], self.K[0, 2], self.K[1, 2]


def png(array):
    stream = io.BytesIO()
    Image.fromarray(array).save(stream, "PNG", compress_level=1)
    return stream.getvalue()


def jpeg(array, orientation=None):
    stream = io.BytesIO()
    exif = Image.Exif()
    if orientation:
        exif[0x0112] = orientation
    Image.fromarray(array).save(stream, "JPEG", quality=97, exif=exif)
    return stream.getvalue()


def tiff(array):
    stream = io.BytesIO()
    Image.fromarray(array).save(stream, "TIFF")
    return stream.getvalue()


def png48(color):
    """RGB of 16 bits, which Pillow does not write."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    rows = (color.astype(">u2") * 257).reshape(color.shape[0], -1)
    data = b"".join(b"\0" + row.tobytes() for row in rows)
    header = struct.pack(">IIBBBBB", color.shape[1], color.shape[0], 16, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(data, 1)) + chunk(b"IEND", b"")


def numpy_file(array, zipped=False):
    stream = io.BytesIO()
    np.savez_compressed(stream, depth=array) if zipped else np.save(stream, array)
    return stream.getvalue()


def pgm(mm):
    return b"P5\n%d %d\n65535\n" % mm.shape[::-1] + mm.astype(">u2").tobytes()


def opencv_yaml(mm):
    rows, columns = mm.shape
    return (f"%YAML:1.0\n---\ndepth: !!opencv-matrix\n   rows: {rows}\n   cols: {columns}\n   dt: w\n   data: [ "
            + ", ".join(str(value) for value in mm.ravel()) + " ]\n").encode()


def exr(metres):
    """Half floats in one channel R, compressed by ZIP in blocks of 16 rows, as Record3D writes them."""
    rows, columns = metres.shape
    def attribute(name, kind, data):
        return name + b"\0" + kind + b"\0" + struct.pack("<I", len(data)) + data
    box = struct.pack("<4i", 0, 0, columns - 1, rows - 1)
    header = b"\x76\x2f\x31\x01\x02\0\0\0" + b"".join((
        attribute(b"channels", b"chlist", b"R\0" + struct.pack("<iB3xii", 1, 0, 1, 1) + b"\0"),
        attribute(b"compression", b"compression", b"\x03"), attribute(b"dataWindow", b"box2i", box),
        attribute(b"displayWindow", b"box2i", box), attribute(b"lineOrder", b"lineOrder", b"\0"),
        attribute(b"pixelAspectRatio", b"float", struct.pack("<f", 1)),
        attribute(b"screenWindowCenter", b"v2f", struct.pack("<2f", 0, 0)),
        attribute(b"screenWindowWidth", b"float", struct.pack("<f", 1)))) + b"\0"
    blocks = []
    for y in range(0, rows, 16):
        raw = np.frombuffer(metres[y:y + 16].astype("<f2").tobytes(), np.uint8)
        split = np.concatenate((raw[::2], raw[1::2])).astype(np.int32)
        split[1:] = (np.diff(split) + 128) & 255
        data = zlib.compress(split.astype(np.uint8).tobytes())
        blocks.append(struct.pack("<iI", y, len(data)) + data)
    offsets, at = [], len(header) + 8 * len(blocks)
    for block in blocks:
        offsets.append(at)
        at += len(block)
    return header + struct.pack(f"<{len(offsets)}Q", *offsets) + b"".join(blocks)


def put(file, content):
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_bytes(content.encode() if isinstance(content, str) else content)


def images(folder, sample, color="rgb/{:06d}.png", depth="depth/{:06d}.png", write_color=png, write_depth=png, at=0):
    for i in range(len(sample.color)):
        put(folder / color.format(i + at), write_color(sample.color[i]))
        put(folder / depth.format(i + at), write_depth(sample.mm[i]))


def matrix_text(matrix):
    return "\n".join(" ".join(f"{value:.9g}" for value in row) for row in matrix) + "\n"


def scaled(factor):
    return lambda mm: (factor * mm).astype(np.float32)


METRES = scaled(1e-3)


def numbers(values, between=" "):
    return between.join(f"{value:.9g}" for value in values)

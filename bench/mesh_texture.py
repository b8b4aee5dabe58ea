#!/usr/bin/env python3
"""Compares meshes with images of the same run that they were not made of.

Usage: mesh_texture.py IMAGES STORED MESH... [--pictures FOLDER] [--views N]
IMAGES and STORED are folders of `kinloop export out --nerfstudio FOLDER`, the first with `--images N`, so that it
also has images that the map does not hold; the meshes are .glb or .ply files of `kinloop mesh out`. Prints for each
mesh the PSNR over the pixels that it covers in N (20) of the images that STORED does not have, after a factor for each
channel that compensates the exposure of the image. Needs numpy, Pillow and Open3D."""
import argparse
import io
import json
import math
import pathlib
import struct

import numpy as np
import open3d as o3d
from PIL import Image

FLOAT, UINT16 = 5126, 5123


class Mesh:
    """Triangles with the colours of their corners, or with a texture."""

    def __init__(self, points, triangles, colors=None, uvs=None, texture=None):
        self.points, self.triangles = points.astype(np.float32), triangles.astype(np.uint32)
        self.colors, self.uvs, self.texture = colors, uvs, texture
        self.scene = o3d.t.geometry.RaycastingScene()
        self.scene.add_triangles(o3d.core.Tensor(self.points), o3d.core.Tensor(self.triangles))

    def look(self, rays):
        """Colours (H, W, 3), 0 to 255, of what the rays (H, W, 6) hit; NaN where they hit nothing."""
        hits = self.scene.cast_rays(o3d.core.Tensor(rays.astype(np.float32)))
        number = hits["primitive_ids"].numpy()
        hit = np.isfinite(hits["t_hit"].numpy())
        corners = self.triangles[np.where(hit, number, 0)]
        u, v = np.moveaxis(hits["primitive_uvs"].numpy(), -1, 0)
        shares = np.stack([1 - u - v, u, v], axis=-1)[..., None]
        if self.texture is None:
            colors = (self.colors[corners] * shares).sum(axis=-2)
        else:
            colors = bilinear(self.texture, (self.uvs[corners] * shares).sum(axis=-2))
        colors[~hit] = np.nan
        return colors


def bilinear(image, uv):
    height, width = image.shape[:2]
    x, y = uv[..., 0] * width - 0.5, uv[..., 1] * height - 0.5
    col, row = np.floor(x).astype(int), np.floor(y).astype(int)
    right, down = (x - col)[..., None], (y - row)[..., None]

    def at(r, c):
        return image[r.clip(0, height - 1), c.clip(0, width - 1)].astype(float)

    return (1 - down) * ((1 - right) * at(row, col) + right * at(row, col + 1)) + down * (
        (1 - right) * at(row + 1, col) + right * at(row + 1, col + 1)
    )


def srgb(linear):
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * np.maximum(linear, 1e-9) ** (1 / 2.4) - 0.055)


def read_glb(path):
    data = path.read_bytes()
    length = struct.unpack_from("<I", data, 12)[0]
    gltf, body = json.loads(data[20:20 + length]), data[28 + length:]

    def part(view):
        view = gltf["bufferViews"][view]
        return body[view["byteOffset"]:view["byteOffset"] + view["byteLength"]]

    def array(number):
        accessor = gltf["accessors"][number]
        kind = {FLOAT: np.float32, UINT16: np.uint16}.get(accessor["componentType"], np.uint32)
        return np.frombuffer(part(accessor["bufferView"]), kind).reshape(accessor["count"], -1)

    primitive = gltf["meshes"][0]["primitives"][0]
    attributes = primitive["attributes"]
    points, triangles = array(attributes["POSITION"]), array(primitive["indices"]).reshape(-1, 3)
    if "TEXCOORD_0" not in attributes:
        return Mesh(points, triangles, colors=255 * srgb(array(attributes["COLOR_0"])[:, :3] / 65535))
    texture = np.asarray(Image.open(io.BytesIO(part(gltf["images"][0]["bufferView"]))).convert("RGB"))
    return Mesh(points, triangles, uvs=array(attributes["TEXCOORD_0"]), texture=texture)


def read_mesh(path):
    if path.suffix == ".glb":
        return read_glb(path)
    mesh = o3d.io.read_triangle_mesh(str(path))
    return Mesh(np.asarray(mesh.vertices), np.asarray(mesh.triangles), colors=255 * np.asarray(mesh.vertex_colors))


def rays_of(camera, pose):
    """Rays (H, W, 6) of a pinhole camera with an OpenGL pose (4, 4)."""
    x, y = np.meshgrid(np.arange(camera["w"]), np.arange(camera["h"]))
    right, up = (x - camera["cx"]) / camera["fl_x"], -(y - camera["cy"]) / camera["fl_y"]
    directions = np.stack([right, up, -np.ones_like(right)], axis=-1)
    rays = np.empty((*x.shape, 6))
    rays[..., :3], rays[..., 3:] = pose[:3, 3], directions @ pose[:3, :3].T
    return rays


def compare(shown, image):
    """Sum of squared errors and number of values, after the gain of each channel; and the image so exposed."""
    error = count = 0
    covered = np.isfinite(shown[..., 0]) & (image.max(axis=-1) < 250)
    exposed = shown.copy()
    for k in range(3):
        a, b = shown[covered, k], image[covered, k].astype(float)
        gain = np.median(b) / max(np.median(a), 1)
        exposed[..., k] *= gain
        error += ((gain * a - b) ** 2).sum()
        count += len(a)
    return error, count, exposed


def save_picture(path, shown, image):
    both = np.concatenate([np.nan_to_num(shown, nan=255).clip(0, 255).astype(np.uint8), image], axis=1)
    Image.fromarray(both).save(path, quality=92)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("images", type=pathlib.Path)
    parser.add_argument("stored", type=pathlib.Path)
    parser.add_argument("meshes", type=pathlib.Path, nargs="+")
    parser.add_argument("--pictures", type=pathlib.Path)
    parser.add_argument("--views", type=int, default=20)
    arguments = parser.parse_args()
    camera = json.loads((arguments.images / "transforms.json").read_text())
    stored = {path.name for path in (arguments.stored / "images").iterdir()}
    frames = [f for f in camera["frames"] if pathlib.Path(f["file_path"]).name not in stored]
    frames = [frames[i * len(frames) // arguments.views] for i in range(min(arguments.views, len(frames)))]
    for path in arguments.meshes:
        mesh, error, count, pixels = read_mesh(path), 0, 0, 0
        for i, frame in enumerate(frames):
            image = np.asarray(Image.open(arguments.images / frame["file_path"]).convert("RGB"))
            shown = mesh.look(rays_of(camera, np.asarray(frame["transform_matrix"])))
            sum_of_squares, values, exposed = compare(shown, image)
            error, count, pixels = error + sum_of_squares, count + values, pixels + image.size
            if arguments.pictures:
                arguments.pictures.mkdir(parents=True, exist_ok=True)
                save_picture(arguments.pictures / f"{path.stem}{path.suffix[1:]}_{i:02d}.jpg", exposed, image)
        psnr = 10 * math.log10(255**2 / (error / count))
        print(f"{path.name}: {psnr:.2f} dB over {100 * count / pixels:.0f} % of {len(frames)} images, "
              f"{len(mesh.triangles)} triangles, {path.stat().st_size / 1e6:.1f} MB", flush=True)


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""Fuses posed frames of a TUM folder with Open3D's TSDF, for comparison with kinloop's mesh and cloud.

Usage: open3d_fusion.py SEQUENCE POSES.txt OUT.ply [VOXEL_M]
Takes the frames whose stamps are in POSES (TUM format, camera to world), e.g. keyframes.txt of a run; writes
the vertices of the mesh in the format of kinloop's map.ply. The camera must have no distortion."""
import pathlib
import sys
import time

import numpy as np
import open3d as o3d
import yaml

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "scripts"))
from tum_folder import pose_matrix  # noqa: E402


def read_poses(path):
    lines = [line.split() for line in open(path) if not line.startswith("#")]
    return {round(float(f[0]), 4): pose_matrix(f) for f in lines}


def write_cloud(path, points, colors):
    vertices = np.empty(len(points), dtype=[("p", "<f4", 3), ("c", "u1", 3)])
    vertices["p"], vertices["c"] = points, np.round(255 * np.asarray(colors))
    header = (
        "ply\nformat binary_little_endian 1.0\ncomment kinloop\nelement vertex %d\nproperty float x\n"
        "property float y\nproperty float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
        "end_header\n" % len(points)
    )
    with open(path, "wb") as file:
        file.write(header.encode() + vertices.tobytes())


def main():
    folder, poses_path, out = sys.argv[1:4]
    voxel_m = float(sys.argv[4]) if len(sys.argv) > 4 else 0.01
    camera = yaml.safe_load(open(folder + "/camera.yaml"))
    assert not any(camera["distortion"]), "give a sequence without lens distortion"
    intrinsic = o3d.camera.PinholeCameraIntrinsic(
        camera["width"], camera["height"], camera["fx"], camera["fy"], camera["cx"], camera["cy"]
    )
    poses = read_poses(poses_path)
    rows = [line.split() for line in open(folder + "/associations.txt") if not line.startswith("#")]
    start = time.time()
    volume = o3d.pipelines.integration.ScalableTSDFVolume(
        voxel_length=voxel_m,
        sdf_trunc=4 * voxel_m,
        color_type=o3d.pipelines.integration.TSDFVolumeColorType.RGB8,
    )
    used = 0
    for stamp, color, _, depth in rows:
        pose = poses.get(round(float(stamp), 4))
        if pose is None:
            continue
        image = o3d.geometry.RGBDImage.create_from_color_and_depth(
            o3d.io.read_image(folder + "/" + color),
            o3d.io.read_image(folder + "/" + depth),
            depth_scale=camera["depth_scale"],
            depth_trunc=4.0,
            convert_rgb_to_intensity=False,
        )
        volume.integrate(image, intrinsic, np.linalg.inv(pose))
        used += 1
    mesh = volume.extract_triangle_mesh()
    seconds = time.time() - start
    write_cloud(out, np.asarray(mesh.vertices), np.asarray(mesh.vertex_colors))
    print("%d frames, %d vertices, %.1f s wall, %.1f s CPU" % (used, len(mesh.vertices), seconds, time.process_time()))


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""Reads clouds, meshes and posed depth images of kinloop with Open3D, and compares them with each other.

Usage: open3d_test.py KINLOOP SHARED_DATA      skipped (77) without Open3D, which scripts/install_test_packages.sh
installs. SHARED_DATA is not used.
"""

import json
import sys
import unittest

from program import SmallRunTest, kinloop

try:
    import numpy as np
    import open3d as o3d
except ImportError as error:
    print(f"skipped: {error}; see scripts/install_test_packages.sh")
    sys.exit(77)

ROUNDED_M = 1e-4  # of text files
MAX_MEDIAN_M, MAX_95_M = 0.015, 0.06  # voxels of 10 mm, single depth images against their fusion


def cloud_of_images(folder):
    """The cloud of all depth images in their poses, as docs/other_programs.md tells."""
    scene = json.loads((folder / "transforms.json").read_text())
    camera = o3d.camera.PinholeCameraIntrinsic(scene["w"], scene["h"], scene["fl_x"], scene["fl_y"],
                                               scene["cx"] - 0.5, scene["cy"] - 0.5)
    cloud = o3d.geometry.PointCloud()
    for frame in scene["frames"]:
        depth = o3d.io.read_image(str(folder / frame["depth_file_path"]))
        T_world_camera = np.array(frame["transform_matrix"]) @ np.diag([1, -1, -1, 1])
        cloud += o3d.geometry.PointCloud.create_from_depth_image(depth, camera, np.linalg.inv(T_world_camera),
                                                                 depth_scale=1000, depth_trunc=4)
    return cloud.voxel_down_sample(0.01)


class Open3d(SmallRunTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.cloud = o3d.io.read_point_cloud(str(cls.run_folder / "map.ply"))

    def test_cloud_has_points_colours_and_unit_normals(self):
        self.assertGreater(len(self.cloud.points), 1000)
        self.assertTrue(self.cloud.has_colors())
        self.assertGreater(np.asarray(self.cloud.colors).std(), 0.01)
        lengths = np.linalg.norm(np.asarray(self.cloud.normals), axis=1)
        np.testing.assert_allclose(lengths, 1, atol=1e-3)

    def test_clouds_of_both_formats_are_the_same(self):
        kinloop("export", self.run_folder, "-q", "--cloud", self.folder / "cloud.pcd")
        kinloop("export", self.run_folder, "-q", "--cloud", self.folder / "cloud.ply")
        pcd, ply = (o3d.io.read_point_cloud(str(self.folder / name)) for name in ("cloud.pcd", "cloud.ply"))
        np.testing.assert_allclose(np.asarray(pcd.points), np.asarray(ply.points), atol=ROUNDED_M)
        np.testing.assert_allclose(np.asarray(pcd.colors), np.asarray(ply.colors), atol=1 / 255)

    def test_meshes_of_both_formats_are_the_same_and_lie_on_the_cloud(self):
        for name in ("mesh.ply", "mesh.obj"):
            kinloop("mesh", self.run_folder, "-q", "-o", self.folder / name)
        ply, obj = (o3d.io.read_triangle_mesh(str(self.folder / name)) for name in ("mesh.ply", "mesh.obj"))
        self.assertTrue(ply.has_vertex_colors())
        self.assertEqual(len(ply.triangles), len(obj.triangles))
        np.testing.assert_allclose(ply.get_surface_area(), obj.get_surface_area(), rtol=1e-3)
        vertices = o3d.geometry.PointCloud(ply.vertices)
        self.assertLess(np.median(vertices.compute_point_cloud_distance(self.cloud)), MAX_MEDIAN_M)

    def test_posed_depth_images_give_the_cloud_of_the_run(self):
        kinloop("export", self.run_folder, "-q", "--nerfstudio", self.folder / "scene")
        distances = np.asarray(cloud_of_images(self.folder / "scene").compute_point_cloud_distance(self.cloud))
        self.assertGreater(len(distances), 1000)
        self.assertLess(np.median(distances), MAX_MEDIAN_M)
        self.assertLess(np.quantile(distances, 0.95), MAX_95_M)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])

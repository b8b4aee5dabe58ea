#!/usr/bin/env python3
"""Reads what kinloop export --colmap writes with COLMAP's own Python package: cameras, poses, points and tracks.

Usage: colmap_test.py KINLOOP SHARED_DATA      skipped (77) without pycolmap, which scripts/install_test_packages.sh
installs. SHARED_DATA is not used.
"""

import sys
import tempfile
import unittest

from program import SmallRunTest, kinloop

try:
    import numpy as np
    import pycolmap
except ImportError as error:
    print(f"skipped: {error}; see scripts/install_test_packages.sh")
    sys.exit(77)

FRAMES, WIDTH, HEIGHT = 40, 320, 240
SMALL = ("--set", f"sim.frames={FRAMES}", "--set", f"sim.width={WIDTH}", "--set", f"sim.height={HEIGHT}")
IMAGES, CLOUD_POINTS = 30, 2000
MAX_ERROR_PX = 4  # of kinloop's observations


def poses_of(file):
    """Camera positions of a trajectory in TUM format, by stamp."""
    return {line.split()[0]: np.array(line.split()[1:4], float) for line in file.read_text().splitlines() if line[0] != "#"}


class Colmap(SmallRunTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.model_folder = cls.folder / "model"
        kinloop("export", cls.run_folder, "-q", "--frame", "camera", "--colmap", cls.model_folder, "--images", IMAGES,
                "--points", CLOUD_POINTS)
        cls.model = pycolmap.Reconstruction(cls.model_folder / "sparse/0")

    def test_images_are_as_many_as_asked_with_files_of_the_cameras_size(self):
        self.assertEqual(self.model.num_images(), IMAGES)
        self.assertEqual(self.model.num_reg_images(), IMAGES)
        (camera,) = self.model.cameras.values()
        self.assertEqual(camera.model, pycolmap.CameraModelId.PINHOLE)
        for image in self.model.images.values():
            bitmap = pycolmap.Bitmap.read(str(self.model_folder / "images" / image.name), True)
            self.assertEqual((bitmap.width, bitmap.height), (camera.width, camera.height))

    def test_poses_are_those_of_the_trajectory(self):
        centers = np.array(list(poses_of(self.run_folder / "trajectory.txt").values()))
        self.assertEqual(len(self.model.images), IMAGES)
        for image in self.model.images.values():
            distances = np.linalg.norm(centers - image.projection_center(), axis=1)
            self.assertLess(distances.min(), 1e-5, image.name)

    def test_colmap_computes_the_same_reprojection_errors(self):
        stated = {id_: point.error for id_, point in self.model.points3D.items() if point.track.length() > 0}
        self.assertGreater(len(stated), 100)
        self.model.update_point_3d_errors()
        for id_, error in stated.items():
            self.assertAlmostEqual(self.model.points3D[id_].error, error, delta=0.01)
        self.assertLess(self.model.compute_mean_reprojection_error(), MAX_ERROR_PX / 2)

    def test_points_of_the_cloud_come_in_addition_to_landmarks(self):
        without_track = [point for point in self.model.points3D.values() if point.track.length() == 0]
        self.assertEqual(len(without_track), CLOUD_POINTS)
        colors = np.array([point.color for point in without_track])
        self.assertGreater(colors.std(), 10)

    def test_colmap_writes_a_model_that_it_reads_again(self):
        with tempfile.TemporaryDirectory() as folder:
            self.model.write_binary(folder)
            again = pycolmap.Reconstruction(folder)
        self.assertEqual(again.num_points3D(), self.model.num_points3D())
        self.assertEqual(again.num_images(), IMAGES)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])

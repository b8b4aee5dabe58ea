#!/usr/bin/env python3
"""Opens meshes of kinloop with the USD library, validates them, and compares them with the same mesh as .ply.

Usage: usd_test.py KINLOOP SHARED_DATA      skipped (77) without usd-core, which scripts/install_test_packages.sh
installs. SHARED_DATA is not used.
"""

import sys
import unittest

from program import SmallRunTest, kinloop

try:
    import numpy as np
    import pxr  # noqa: F401
except ImportError as error:
    print(f"skipped: {error}; see scripts/install_test_packages.sh")
    sys.exit(77)
from pxr import Ar, Usd, UsdGeom, UsdShade, UsdValidation  # noqa: E402

ROUNDED_M = 1e-5  # of the text in the scene
JPEG = b"\xff\xd8\xff"


def mesh_of(stage):
    """The mesh of a stage, which has one."""
    (mesh,) = (UsdGeom.Mesh(prim) for prim in stage.Traverse() if prim.IsA(UsdGeom.Mesh))
    return mesh


def findings(stage):
    """What all validators of USD have against a stage."""
    validators = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
    return [error.GetErrorAsString() for error in UsdValidation.ValidationContext(validators).Validate(stage)]


def vertices_of_ply(file):
    """The positions of a binary .ply, which has them first in each vertex."""
    header, body = file.read_bytes().split(b"end_header\n", 1)
    lines = [line.split() for line in header.decode().splitlines()]
    (count,) = (int(words[2]) for words in lines if words[:2] == ["element", "vertex"])
    last = next(i for i, words in enumerate(lines) if words[:2] == ["element", "face"])
    kinds = {"float": "<f4", "double": "<f8", "uchar": "u1"}
    fields = [(words[2], kinds[words[1]]) for words in lines[:last] if words[0] == "property"]
    vertices = np.frombuffer(body, dtype=fields, count=count)
    return np.stack([vertices["x"], vertices["y"], vertices["z"]], axis=1)


class UsdFiles(SmallRunTest):
    def open(self, name, *options):
        kinloop("mesh", self.run_folder, "-q", "--voxel", 0.02, *options, "-o", self.folder / name)
        stage = Usd.Stage.Open(str(self.folder / name))
        self.assertEqual(findings(stage), [])
        self.assertEqual(UsdGeom.GetStageMetersPerUnit(stage), 1)
        return stage

    def test_meshes_are_that_of_the_ply_file(self):
        kinloop("mesh", self.run_folder, "-q", "--voxel", 0.02, "-o", self.folder / "mesh.ply")
        expected = vertices_of_ply(self.folder / "mesh.ply")
        for name in ("mesh.usda", "mesh.usdz"):
            with self.subTest(name):
                stage = self.open(name)
                points = np.array(mesh_of(stage).GetPointsAttr().Get())
                self.assertGreater(np.ptp(points), 1)
                np.testing.assert_allclose(points, expected, atol=ROUNDED_M)

    def test_colours_belong_to_vertices(self):
        stage = self.open("colours.usdz")
        mesh = mesh_of(stage)
        colours = np.array(mesh.GetDisplayColorPrimvar().Get())
        self.assertEqual(len(colours), len(mesh.GetPointsAttr().Get()))
        self.assertGreater(colours.std(), 0.01)

    def test_textures_are_bound_and_found_in_the_file(self):
        stage = self.open("textured.usdz", "--texture", 512, "--triangles", 5000)
        mesh = mesh_of(stage)
        places = UsdGeom.PrimvarsAPI(mesh).GetPrimvar("st").ComputeFlattened()
        self.assertEqual(len(places), len(mesh.GetFaceVertexIndicesAttr().Get()))
        self.assertTrue(((np.array(places) >= 0) & (np.array(places) <= 1)).all())
        material, _ = UsdShade.MaterialBindingAPI(mesh).ComputeBoundMaterial()
        images = [shader.GetInput("file").Get() for shader in map(UsdShade.Shader, Usd.PrimRange(material.GetPrim()))
                  if shader and shader.GetInput("file")]
        self.assertEqual(len(images), 1)
        asset = Ar.GetResolver().OpenAsset(Ar.ResolvedPath(images[0].resolvedPath))
        self.assertEqual(asset.GetBuffer()[:3], JPEG)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])

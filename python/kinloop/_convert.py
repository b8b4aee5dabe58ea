"""Conversion to the types of other packages, which are imported only when asked for."""

import importlib


def _imported(package, method):
    try:
        return importlib.import_module(package)
    except ImportError as error:
        raise ImportError(f"{method} requires the package {package}; install it: pip install {package}") from error


def cloud_to_open3d(cloud):
    """Returns an open3d.geometry.PointCloud with colours and normals, in the world frame. Requires Open3D."""
    o3d = _imported("open3d", "Cloud.to_open3d")
    points = o3d.geometry.PointCloud()
    points.points = o3d.utility.Vector3dVector(cloud.points.astype("float64"))
    points.colors = o3d.utility.Vector3dVector(cloud.colors / 255.0)
    if len(cloud.normals):
        points.normals = o3d.utility.Vector3dVector(cloud.normals.astype("float64"))
    return points


def mesh_to_open3d(mesh):
    """Returns an open3d.geometry.TriangleMesh with colours, and the texture if there is one, in the world frame.
    Requires Open3D."""
    o3d = _imported("open3d", "Mesh.to_open3d")
    triangles = o3d.geometry.TriangleMesh()
    triangles.vertices = o3d.utility.Vector3dVector(mesh.points.astype("float64"))
    triangles.vertex_colors = o3d.utility.Vector3dVector(mesh.colors / 255.0)
    triangles.triangles = o3d.utility.Vector3iVector(mesh.triangles.astype("int32"))
    if mesh.texture is not None:
        # In Open3D, too, v counts from the first row of the image.
        triangles.triangle_uvs = o3d.utility.Vector2dVector(mesh.uvs[mesh.uv_triangles.ravel()].astype("float64"))
        triangles.triangle_material_ids = o3d.utility.IntVector([0] * len(mesh.triangles))
        triangles.textures = [o3d.geometry.Image(mesh.texture.copy(order="C"))]
    return triangles


def trajectory_to_pandas(trajectory):
    """Returns a pandas.DataFrame with columns tx ty tz (metres) qx qy qz qw, indexed by stamp_s. Requires pandas."""
    pd = _imported("pandas", "Trajectory.to_pandas")
    p, q = trajectory.positions, trajectory.quaternions
    columns = dict(zip("tx ty tz qx qy qz qw".split(), [*p.T, *q.T]))
    return pd.DataFrame(columns, index=pd.Index(trajectory.stamps_s, name="stamp_s"))

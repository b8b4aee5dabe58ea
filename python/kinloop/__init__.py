"""RGB-D visual SLAM on an ordinary CPU: camera trajectory and coloured 3D map from a Kinect-class camera.

    import kinloop
    source = kinloop.open("recording")                 # or "sim:room", "kinect1", ...
    slam = kinloop.Slam(source.camera)
    for frame in source:
        pose = slam.process(frame)                     # T_world_camera, 4x4; None while lost
    result = slam.finish()
    result.trajectory.save("trajectory.txt")
    result.cloud.save("map.ply")

Units are metres and seconds. `T_a_b` maps points of frame b to frame a. Camera axes: x right, y down, z forward; the
world is the first camera. Bad files raise InputError and bad arguments UsageError, both with the texts of the program.
"""

from . import _calls, _convert, _rerun
from ._kinloop import (
    BoardView,
    Calibration,
    Camera,
    Cloud,
    ErrorStatistics,
    Evaluation,
    Frame,
    InputError,
    Map,
    Mesh,
    PlaceIndex,
    PoseGraph,
    PoseGraphSummary,
    RelativePoseError,
    Result,
    Slam,
    Source,
    Trajectory,
    UsageError,
    Viewer,
    Vocabulary,
    __version__,
    calibrate,
    evaluate,
    evaluation_plot,
    evaluation_table,
    find_board,
    open,
    set_log_level,
    share,
    view,
)

Cloud.to_open3d = _convert.cloud_to_open3d
Map.export_rerun = _rerun.map_export_rerun
Mesh.to_open3d = _convert.mesh_to_open3d
Trajectory.to_pandas = _convert.trajectory_to_pandas

__all__ = [
    "BoardView",
    "Calibration",
    "Camera",
    "Cloud",
    "ErrorStatistics",
    "Evaluation",
    "Frame",
    "InputError",
    "Map",
    "Mesh",
    "PlaceIndex",
    "PoseGraph",
    "PoseGraphSummary",
    "RelativePoseError",
    "Result",
    "Slam",
    "Source",
    "Trajectory",
    "UsageError",
    "Viewer",
    "Vocabulary",
    "calibrate",
    "evaluate",
    "evaluation_plot",
    "evaluation_table",
    "find_board",
    "open",
    "set_log_level",
    "share",
    "view",
]

_calls.make_pythonic(globals(), __all__)
for _name in __all__:
    globals()[_name].__module__ = "kinloop"  # where users know them from
del _name

"""Writes the parts of a run (session/store/rerun_parts.hpp) into a recording for Rerun, https://rerun.io.

Usage: _rerun.py PARTS FILE.rrd     or, to find out whether that would work: _rerun.py
"""

import json
import os
import sys
import tempfile
from decimal import Decimal
from pathlib import Path

MISSING = "a recording for Rerun needs the Python package rerun-sdk; install it: pip install rerun-sdk"
WARNING = "warning: "  # apps/shared/files/python_files.cpp shows such lines
LOST, DOUBTFUL, TRACKED = range(3)
TRACKED_COLOR, KEYFRAME_COLOR, LOOP_COLOR = [90, 160, 250], [250, 200, 60], [240, 70, 70]


def import_rerun():
    """Returns the modules rerun and rerun.blueprint. Raises ImportError that says how to install them."""
    try:
        import rerun
        import rerun.blueprint
    except ImportError as error:
        raise ImportError(f"{MISSING} ({error})") from error
    if not hasattr(rerun, "EncodedDepthImage"):
        raise ImportError("rerun-sdk is too old; pip install --upgrade rerun-sdk")
    return rerun, rerun.blueprint


def read_ply(path):
    """Returns positions (N, 3) and colours (N, 3) of a binary cloud that kinloop wrote."""
    import numpy as np

    header, _, body = path.read_bytes().partition(b"end_header\n")
    types = {"float": "<f4", "uchar": "u1"}
    properties = [line.split() for line in header.decode().splitlines() if line.startswith("property ")]
    points = np.frombuffer(body, [(name, types[kind]) for _, kind, name in properties])
    return tuple(np.stack([points[name] for name in names], axis=1) for names in ("xyz", ("red", "green", "blue")))


def write_rrd(parts, file):
    """Writes `file` from the folder `parts`; an error leaves an incomplete file.

    Raises ImportError without rerun-sdk, and OSError.
    """
    rerun, blueprint = import_rerun()
    parts, file = Path(parts), Path(file)
    run = json.loads((parts / "run.json").read_text(encoding="utf-8"))
    recording = rerun.RecordingStream("kinloop")
    recording.save(file, default_blueprint=_views(blueprint))
    recording.send_recording_name(run["name"])
    _log_frames(rerun, recording, run["frame"])
    _log_poses(rerun, recording, run)
    _log_status(rerun, recording, run["frames"])
    if run["frame_table"]:
        _log_sigma(rerun, recording, Path(run["frame_table"]), set(run["frames"]["stamps_ns"]))
    _log_images(rerun, recording, parts, set(run["trajectory"]["stamps_ns"]))
    points, colors = read_ply(parts / "cloud.ply")
    recording.log("world/cloud", rerun.Points3D(points, colors=colors), static=True)
    recording.disconnect()


def map_export_rerun(map, file, *, images=0, recording=""):
    """Writes the last recording of the map as FILE.rrd for Rerun: poses, images, status, cloud. Requires rerun-sdk.

    `images`: at least so many, of which those that the map lacks are read from its recording. Raises ImportError
    without rerun-sdk, OSError if `file` cannot be written, and InputError if the map or its recording lacks images.
    """
    import_rerun()
    file = Path(file).resolve()
    with tempfile.TemporaryDirectory(prefix=".kinloop_rerun_", dir=file.parent) as unfinished:
        with tempfile.TemporaryDirectory(prefix="kinloop_rerun_") as parts:
            map._write_rerun_parts(parts, images, recording)
            write_rrd(parts, Path(unfinished) / "run.rrd")
        os.replace(Path(unfinished) / "run.rrd", file)


def _views(rrb):
    return rrb.Blueprint(
        rrb.Horizontal(
            rrb.Spatial3DView(origin="world", name="map"),
            rrb.Vertical(
                rrb.Spatial2DView(origin="world/run/camera/image", name="camera"),
                rrb.TimeSeriesView(origin="plots/sigma_m", name="standard deviation of the position, m"),
                rrb.TimeSeriesView(origin="plots/status", name="2 tracked, 1 doubtful, 0 lost"),
            ),
            column_shares=[2, 1],
        ),
        collapse_panels=True,
    )


def _log_frames(rerun, recording, frame):
    """The axes of the cloud, and below it the world of the trajectory: the first camera."""
    upright = frame["frame"] == "z-up"
    axes = rerun.ViewCoordinates.RIGHT_HAND_Z_UP if upright else rerun.ViewCoordinates.RIGHT_HAND_Y_DOWN
    recording.log("world", axes, static=True)
    quaternion = frame.get("rotation_xyzw", [0, 0, 0, 1])
    recording.log("world/run", rerun.Transform3D(quaternion=quaternion), static=True)


def _stamps(rerun, stamps_ns):
    import numpy as np

    return [rerun.TimeColumn("stamp", timestamp=np.array(stamps_ns, "datetime64[ns]"))]


def _log_poses(rerun, recording, run):
    import numpy as np

    poses = np.array(run["trajectory"]["poses"], float).reshape(-1, 7)
    columns = rerun.Transform3D.columns(translation=poses[:, :3], quaternion=poses[:, 3:])
    recording.send_columns("world/run/camera", _stamps(rerun, run["trajectory"]["stamps_ns"]), columns)
    path = rerun.LineStrips3D([poses[:, :3]], colors=[TRACKED_COLOR])
    recording.log("world/run/trajectory", path, static=True)
    keyframes = np.array(run["keyframes"]["poses"], float).reshape(-1, 7)[:, :3]
    points = rerun.Points3D(keyframes, colors=[KEYFRAME_COLOR], radii=rerun.Radius.ui_points(4))
    recording.log("world/run/keyframes", points, static=True)
    recording.log("world/run/loops", rerun.LineStrips3D(run["loops"], colors=[LOOP_COLOR]), static=True)


def _log_status(rerun, recording, frames):
    status = [
        (DOUBTFUL if doubtful else TRACKED) if located else LOST
        for located, doubtful in zip(frames["located"], frames["doubtful"])
    ]
    columns = rerun.Scalars.columns(scalars=status)
    recording.send_columns("plots/status", _stamps(rerun, frames["stamps_ns"]), columns)


def _known_sigmas(table):
    """The standard deviations of frames.txt by stamp in ns, where they are known. Raises ValueError."""
    known = {}
    for line in table.read_text(encoding="utf-8").splitlines():
        fields = line.split()
        if line.startswith("#") or len(fields) < 6:
            continue
        try:
            stamp_ns, sigma_m = int(Decimal(fields[0]) * 10**9), float(fields[5])
        except ArithmeticError as error:
            raise ValueError(f"{fields[0]} is not a time stamp") from error
        if sigma_m > 0:
            known[stamp_ns] = sigma_m
    return known


def _log_sigma(rerun, recording, table, stamps_ns):
    """The standard deviations of frames.txt, of the frames at these stamps; warns if it is another table."""
    try:
        known = {stamp: sigma for stamp, sigma in _known_sigmas(table).items() if stamp in stamps_ns}
    except (OSError, ValueError) as error:
        print(f"{WARNING}{table}: is not a table of frames, left out ({error})", file=sys.stderr)
        return
    columns = rerun.Scalars.columns(scalars=list(known.values()))
    recording.send_columns("plots/sigma_m", _stamps(rerun, list(known)), columns)


def _log_images(rerun, recording, parts, located):
    """Colour and depth of the stored frames whose pose is in the trajectory, below their camera."""
    import numpy as np

    scene = json.loads((parts / "transforms.json").read_text(encoding="utf-8"))
    camera = rerun.Pinhole(
        resolution=[scene["w"], scene["h"]],
        focal_length=[scene["fl_x"], scene["fl_y"]],
        principal_point=[scene["cx"], scene["cy"]],
        camera_xyz=rerun.ViewCoordinates.RDF,
    )
    recording.log("world/run/camera/image", camera, static=True)
    for frame in scene["frames"]:
        if frame["stamp_ns"] not in located:
            continue
        recording.set_time("stamp", timestamp=np.datetime64(frame["stamp_ns"], "ns"))
        color = rerun.EncodedImage(path=parts / frame["file_path"])
        depth_mm = (parts / frame["depth_file_path"]).read_bytes()
        depth = rerun.EncodedDepthImage(depth_mm, media_type="image/png", meter=1000)
        recording.log("world/run/camera/image/color", color)
        recording.log("world/run/camera/image/depth", depth)


def main(arguments):
    try:
        write_rrd(*arguments) if arguments else import_rerun()
    except (ImportError, OSError, ValueError) as error:
        print(error)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

"""Camera, sources, Slam and Result: the same results and messages as the program."""

import gc
import json
import pickle
import threading

import numpy as np
import pytest

import kinloop


def arrays_of(sequence):
    for frame in kinloop.open(sequence):
        yield frame.stamp_s, frame.rgb, frame.depth_m


def test_same_bytes_of_trajectory_as_the_program(result, program_run, tmp_path):
    result.trajectory.save(tmp_path / "trajectory.txt")
    assert (tmp_path / "trajectory.txt").read_bytes() == (program_run / "trajectory.txt").read_bytes()
    result.keyframes.save(tmp_path / "keyframes.txt")
    assert (tmp_path / "keyframes.txt").read_bytes() == (program_run / "keyframes.txt").read_bytes()


def test_covariances_are_those_of_the_program(result, program_run):
    rows = np.loadtxt(program_run / "covariances.txt")
    covariances = result.covariances
    assert covariances.shape == (len(result.trajectory), 6, 6) and len(rows) == len(covariances)
    np.testing.assert_allclose(rows[:, 0], result.trajectory.stamps_s, atol=1e-6)
    assert np.isnan(covariances[0]).all() and not np.isnan(covariances[1:]).any()
    np.testing.assert_allclose(covariances, covariances.transpose(0, 2, 1), rtol=1e-9, atol=1e-18)
    np.testing.assert_allclose(covariances[(..., *np.triu_indices(6))], rows[:, 1:], rtol=1e-7)
    assert np.linalg.eigvalsh(covariances[1:]).min() > 0


def test_same_options_as_the_program(sequence, program, tmp_path):
    program("run", sequence, "-o", tmp_path / "out", "-q", "--set", "seed=5", "--set", "features.count=500", "--no-loop")
    slam = kinloop.Slam(str(sequence / "camera.yaml"), {"seed": 5}, features={"count": 500}, loop={"enabled": False})
    for frame in kinloop.open(sequence):
        slam.process(frame)
    slam.finish().trajectory.save(tmp_path / "trajectory.txt")
    assert (tmp_path / "trajectory.txt").read_bytes() == (tmp_path / "out/trajectory.txt").read_bytes()


def test_poses_are_given_before_the_frame_is_mapped(sequence, program_run, tmp_path):
    source = kinloop.open(sequence)
    slam = kinloop.Slam(source.camera)
    with pytest.raises(kinloop.UsageError, match="call track"):
        slam.update_map()
    for number, frame in enumerate(source):
        pose = slam.track(frame) if number % 2 else slam.track(frame.stamp_s, frame.rgb, frame.depth_m)
        assert not slam.lost and len(slam.trajectory) == number
        np.testing.assert_allclose(slam.update_map(), pose, atol=0.02)
        assert len(slam.trajectory) == number + 1
        if number == 9:
            break
    assert number == 9


def test_poses_are_rigid_motions_and_none_while_lost(sequence):
    source = kinloop.open(sequence)
    slam = kinloop.Slam(source.camera)
    assert slam.lost
    pose = slam.process(next(source))
    np.testing.assert_allclose(pose, np.eye(4), atol=1e-12)
    dark = np.zeros((240, 320, 3), np.uint8), np.zeros((240, 320), np.float32)
    assert slam.process(next(source).stamp_s, *dark) is None
    assert slam.lost and not slam.doubtful
    assert slam.position_sigma_m == 0 and not slam.covariance.any()
    pose = slam.process(next(source))
    assert pose.shape == (4, 4) and pose.dtype == np.float64
    np.testing.assert_allclose(pose[:3, :3] @ pose[:3, :3].T, np.eye(3), atol=1e-9)
    assert slam.covariance.shape == (6, 6)
    largest = np.linalg.eigvalsh(slam.covariance[:3, :3]).max()
    assert slam.position_sigma_m == pytest.approx(np.sqrt(max(largest, 0)), abs=1e-12)


def test_the_verdict_is_that_of_the_program(result, program_run):
    quality = json.loads((program_run / "run.json").read_text())["quality"]
    assert result.quality.keys() == quality.keys()
    assert result.quality["verdict"] == quality["verdict"] == "good"
    assert result.quality["seconds"] == pytest.approx(quality["seconds"])
    assert result.quality["reasons"] == quality["reasons"]


def test_doubtful_poses_can_be_kept(sequence, result):
    slam = kinloop.Slam(kinloop.open(sequence).camera)
    for frame in kinloop.open(sequence):
        slam.process(frame)
    assert len(slam.finish(keep_doubtful=True).trajectory) >= len(result.trajectory)


@pytest.mark.parametrize("copy", [True, False])
def test_arrays_give_the_same_as_files_in_the_same_units(sequence, result, copy):
    # Depth stamps of the recording differ from those of colour; without them the results would differ slightly.
    by_stamp = dict(line.split()[:1] * 2 for line in (sequence / "depth.txt").read_text().splitlines() if line[0] != "#")
    depth_stamps = np.array([float(stamp) for stamp in by_stamp])
    slam = kinloop.Slam(kinloop.open(sequence).camera)
    for stamp_s, rgb, depth_m in arrays_of(sequence):
        depth_stamp_s = depth_stamps[np.argmin(abs(depth_stamps - stamp_s))]
        slam.process(stamp_s, rgb, depth_m, depth_stamp_s=depth_stamp_s, copy=copy)
        del rgb, depth_m
    trajectory = slam.finish().trajectory
    np.testing.assert_array_equal(trajectory.stamps_ns, result.trajectory.stamps_ns)
    np.testing.assert_array_equal(trajectory.poses, result.trajectory.poses)


def test_layouts_and_units_of_arrays_do_not_matter(sequence):
    poses = []
    for convert_rgb, convert_depth in [
        (lambda rgb: rgb, lambda depth: depth),
        (np.ascontiguousarray, lambda depth: np.round(depth * 5000).astype(np.uint16)),
        (np.asfortranarray, np.asfortranarray),
        (lambda rgb: np.repeat(rgb, 2, axis=1)[:, ::2], lambda depth: np.where(depth > 0, depth, np.nan)),
    ]:
        slam = kinloop.Slam(kinloop.open(sequence).camera)
        for _, (stamp_s, rgb, depth_m) in zip(range(5), arrays_of(sequence)):
            pose = slam.process(stamp_s, convert_rgb(rgb), convert_depth(depth_m))
        poses.append(pose)
    for pose in poses[1:]:
        np.testing.assert_allclose(pose, poses[0], atol=1e-6)


@pytest.mark.parametrize("copy", [True, False])
def test_depth_that_cannot_be_shared_is_copied(sequence, copy):
    """Misaligned memory, rows at odd strides, and pixels without a distance."""

    def misaligned(depth):
        return np.frombuffer(b"-" + depth.tobytes(), np.float32, offset=1).reshape(depth.shape)

    def odd_rows(depth):
        height, width = depth.shape
        rows = np.ndarray(depth.shape, np.float32, np.zeros(height * (4 * width + 2), np.uint8), strides=(4 * width + 2, 4))
        rows[:] = depth
        return rows

    def unknown_is_not_finite(depth):
        return np.where(depth > 0, depth, np.where(np.arange(depth.shape[1]) % 2, np.nan, -np.inf)).astype(np.float32)

    def poses(convert):
        slam = kinloop.Slam(kinloop.open(sequence).camera)
        frames = [(stamp_s, rgb, convert(depth_m)) for _, (stamp_s, rgb, depth_m) in zip(range(5), arrays_of(sequence))]
        return [slam.process(*frame, copy=copy) for frame in frames]

    expected = poses(np.ascontiguousarray)
    for convert in (misaligned, odd_rows, unknown_is_not_finite):
        np.testing.assert_array_equal(poses(convert), expected, convert.__name__)


@pytest.mark.parametrize("argument, spoil", [
    ("rgb", lambda rgb: rgb[:, :, 0]),
    ("rgb", lambda rgb: rgb[:, :, :1]),
    ("rgb", lambda rgb: np.dstack([rgb, rgb[:, :, 0]])),
    ("rgb", lambda rgb: rgb / 255),
    ("rgb", lambda rgb: rgb.astype(np.int64)),
    ("depth", lambda depth: np.dstack([depth])),
    ("depth", lambda depth: depth.astype(np.float16)),
    ("depth", lambda depth: (5000 * depth).astype(np.int32)),
])
def test_what_an_error_advises_for_an_array_helps(sequence, argument, spoil):
    source = kinloop.open(sequence)
    frame = next(source)
    arrays = {"rgb": frame.rgb, "depth": frame.depth_m}
    arrays[argument] = spoil(arrays[argument])
    with pytest.raises(kinloop.UsageError) as error:
        kinloop.Slam(source.camera).process(0, **arrays)
    code = str(error.value).rsplit("; ", 1)[1].split(": ", 1)[1]
    arrays[argument] = eval(code, {"np": np}, arrays)
    assert kinloop.Slam(source.camera).process(0, **arrays) is not None


def test_bad_arrays_are_named(sequence):
    source = kinloop.open(sequence)
    frame = next(source)
    slam = kinloop.Slam(source.camera)
    rgb, depth_m = frame.rgb, frame.depth_m
    with pytest.raises(kinloop.UsageError, match=r"rgb: expected uint8 .* got float64 of shape \(240, 320, 3\)"):
        slam.process(0, rgb / 255, depth_m)
    with pytest.raises(kinloop.UsageError, match=r"depth: expected float32 .* got uint8"):
        slam.process(0, rgb, rgb[:, :, 0])
    with pytest.raises(kinloop.UsageError, match="rgb: 160 x 240 pixels where the camera has 320 x 240"):
        slam.process(0, rgb[:, :160], depth_m)
    with pytest.raises(kinloop.UsageError, match="rgb: 240 x 320 pixels .*; an array has its height first"):
        slam.process(0, np.swapaxes(rgb, 0, 1), depth_m)
    with pytest.raises(kinloop.UsageError, match="depth: 160 x 120 pixels .*; register depth to colour"):
        slam.process(0, rgb, depth_m[::2, ::2])
    with pytest.raises(kinloop.UsageError, match="stamp nan: expected seconds"):
        slam.process(float("nan"), rgb, depth_m)
    slam.process(1, rgb, depth_m)
    with pytest.raises(kinloop.UsageError, match="stamps must increase"):
        slam.process(1, rgb, depth_m)


def test_shared_arrays_stay_alive_and_are_released(sequence):
    import sys

    source = kinloop.open(sequence)
    slam = kinloop.Slam(source.camera)
    frame = next(source)
    depth = np.array(frame.depth_m)
    before = sys.getrefcount(depth)
    slam.process(frame.stamp_s, frame.rgb, depth, copy=False)
    assert sys.getrefcount(depth) > before
    slam.finish()
    del slam
    gc.collect()
    assert sys.getrefcount(depth) == before


def test_frames_are_views(sequence):
    frame = next(kinloop.open(sequence))
    rgb, depth_m = frame.rgb, frame.depth_m
    del frame
    gc.collect()
    assert rgb.shape == (240, 320, 3) and rgb.dtype == np.uint8 and not rgb.flags.owndata
    assert depth_m.shape == (240, 320) and depth_m.dtype == np.float32 and not depth_m.flags.owndata
    assert 0 < np.median(depth_m) < 10
    with pytest.raises(ValueError, match="read-only"):
        depth_m[0, 0] = 1


def test_source(sequence):
    source = kinloop.open(sequence)
    assert len(source) == 120 and not source.live and source.skipped == []
    assert len(source.ground_truth) > 0
    assert [frame.index for frame in source] == list(range(120))
    assert list(source) == []
    assert len(kinloop.open("sim:room", sim={"frames": 7})) == 7


def test_camera_of_a_source(sequence):
    camera = kinloop.Camera.from_yaml(sequence / "camera.yaml")
    wider = kinloop.Camera(width=320, height=240, fx=camera.fx * 1.1, fy=camera.fy * 1.1, cx=160, cy=120)
    assert kinloop.open(sequence, camera=wider).camera.fx == wider.fx
    assert kinloop.open(sequence, camera=sequence / "camera.yaml").camera == camera
    with pytest.raises(kinloop.UsageError, match="camera: expected a Camera"):
        kinloop.open(sequence, camera=3)
    with pytest.raises(kinloop.UsageError, match="simulated"):
        kinloop.open("sim:room", camera=camera)


def test_a_source_without_length_is_true(sequence):
    assert kinloop.open(sequence)
    assert type(kinloop.open(sequence)).__bool__


def test_frame_of_another_size_is_refused_and_the_source_goes_on(sequence):
    source = kinloop.open(sequence)
    slam = kinloop.Slam("freiburg1")
    with pytest.raises(kinloop.UsageError, match="frame: 320 x 240 pixels where the camera of this Slam has 640 x 480"):
        slam.process(next(source))
    assert kinloop.Slam(source.camera).process(next(source)) is not None


def test_damaged_frame_is_skipped_and_named(sequence, tmp_path):
    import shutil

    folder = tmp_path / "damaged"
    shutil.copytree(sequence, folder)
    image = sorted((folder / "rgb").iterdir())[3]
    image.write_bytes(image.read_bytes()[:2000])
    source = kinloop.open(folder)
    slam = kinloop.Slam(source.camera)
    frames = [slam.process(frame) for frame in source]
    assert len(frames) == 119
    assert len(source.skipped) == 1 and image.name in source.skipped[0][0] + source.skipped[0][1]


def test_messages_of_the_program(sequence, program, tmp_path):
    def error_of(*arguments, code):
        return program(*arguments, expect=code).strip().splitlines()[-1].removeprefix("error: ")

    with pytest.raises(kinloop.UsageError) as unknown:
        kinloop.Slam("freiburg1", features={"cuont": 3})
    assert str(unknown.value) == error_of("run", sequence, "-o", tmp_path / "o", "--set", "features.cuont=3", code=2)
    with pytest.raises(kinloop.UsageError) as value:
        kinloop.Slam("freiburg1", seed=-1)
    assert str(value.value) == error_of("run", sequence, "-o", tmp_path / "o", "--set", "seed=-1", code=2)
    with pytest.raises(kinloop.InputError) as missing:
        kinloop.open(tmp_path / "nothing.bag")
    assert str(missing.value) == error_of("run", tmp_path / "nothing.bag", "-o", tmp_path / "o", code=3)
    assert issubclass(kinloop.InputError, ValueError) and issubclass(kinloop.UsageError, ValueError)


def test_a_finished_run_is_over(sequence):
    source = kinloop.open(sequence)
    slam = kinloop.Slam(source.camera)
    slam.process(next(source))
    assert len(slam.finish().trajectory) == len(slam.finish().trajectory) == 1
    with pytest.raises(kinloop.UsageError, match="finish"):
        slam.process(next(source))


def test_one_source_for_two_runs_and_two_sources_for_one(sequence):
    source = kinloop.open(sequence)
    a, b = kinloop.Slam(source.camera), kinloop.Slam(source.camera)
    for _, frame in zip(range(20), source):
        np.testing.assert_array_equal(a.process(frame), b.process(frame))
    for frame in list(kinloop.open(sequence))[30:40]:
        assert a.process(frame) is not None
    assert len(a.finish().trajectory) == 30


def test_progress_is_reported_and_its_errors_are_raised(sequence):
    source = kinloop.open(sequence)
    slam = kinloop.Slam(source.camera)
    for _, frame in zip(range(40), source):
        slam.process(frame)

    def fail(stage, done, total):
        raise KeyError(stage)

    with pytest.raises(KeyError):
        slam.finish(progress=fail)


def test_other_threads_run_while_a_frame_is_processed(sequence):
    source = kinloop.open(sequence)
    slam = kinloop.Slam(source.camera)
    counts, done = [0], threading.Event()

    def count():
        while not done.is_set():
            counts[0] += 1

    thread = threading.Thread(target=count)
    thread.start()
    during = 0
    for _, frame in zip(range(10), source):
        before = counts[0]
        slam.process(frame)
        during += counts[0] > before
    done.set()
    thread.join()
    assert during > 0


def test_result(result, tmp_path):
    assert result.frames == 120 and len(result.trajectory) == 120
    assert result.trajectory.poses.shape == (120, 4, 4)
    cloud = result.cloud
    assert cloud is result.cloud
    assert cloud.points.shape == (len(cloud), 3) and cloud.points.dtype == np.float32
    assert cloud.colors.shape == (len(cloud), 3) and cloud.colors.dtype == np.uint8
    points = cloud.points
    copy = points.copy()
    assert not points.flags.owndata and not points.flags.writeable
    del cloud
    gc.collect()
    np.testing.assert_array_equal(points, copy)
    assert result.landmarks.shape[1] == 3
    assert len(result.pose_graph()) == len(result.keyframes)


def test_views_outlive_their_owner():
    points = kinloop_cloud_points()
    gc.collect()
    assert np.isfinite(points).all() and len(points) > 100


def kinloop_cloud_points():
    source = kinloop.open("sim:room", sim={"frames": 10, "width": 320, "height": 240})
    slam = kinloop.Slam(source.camera)
    for frame in source:
        slam.process(frame)
    return slam.finish().cloud.points


def test_cloud_and_mesh_files_are_those_of_the_program(result, program, program_run, tmp_path):
    result.cloud.save(tmp_path / "map.ply")
    assert (tmp_path / "map.ply").read_bytes() == (program_run / "map.ply").read_bytes()
    np.testing.assert_allclose(kinloop.Cloud.load(tmp_path / "map.ply").points, result.cloud.points, atol=1e-5)
    program("mesh", program_run, "-o", tmp_path / "program.ply", "--voxel", 0.03, "-q")
    mesh = result.mesh(voxel_m=0.03)
    mesh.save(tmp_path / "mesh.ply")
    assert (tmp_path / "mesh.ply").stat().st_size == pytest.approx((tmp_path / "program.ply").stat().st_size, rel=0.05)
    assert mesh.triangles.max() < len(mesh.points) == len(mesh.colors)
    with pytest.raises(kinloop.UsageError, match="must end in .ply, .pcd or .las"):
        result.cloud.save(tmp_path / "map.stl")


def test_a_mesh_has_a_texture_on_request(result, tmp_path):
    mesh = result.mesh(voxel_m=0.03)
    assert mesh.texture is mesh.uvs is mesh.uv_triangles is None
    mesh = result.mesh(voxel_m=0.03, texture_px=512)
    assert mesh.texture.dtype == np.uint8 and max(mesh.texture.shape[:2]) <= 512
    assert mesh.uvs.dtype == np.float32 and 0 <= mesh.uvs.min() and mesh.uvs.max() <= 1
    assert mesh.uv_triangles.shape == mesh.triangles.shape and mesh.uv_triangles.max() < len(mesh.uvs)
    height, width = mesh.texture.shape[:2]
    col, row = (mesh.uvs * (width, height)).astype(int).T
    shown = mesh.texture[row, col][mesh.uv_triangles.ravel()].astype(float)
    assert np.median(np.abs(shown - mesh.colors[mesh.triangles.ravel()])) < 12
    mesh.save(tmp_path / "mesh.obj")
    assert {path.name for path in tmp_path.iterdir()} == {"mesh.obj", "mesh.mtl", "mesh.jpg"}
    with pytest.raises(kinloop.UsageError, match="must end in .glb, .obj, .usda or .usdz"):
        mesh.save(tmp_path / "mesh.ply")


def test_save_writes_a_folder_of_the_program(result, program, tmp_path):
    result.save(tmp_path / "out")
    names = {path.name for path in (tmp_path / "out").iterdir()}
    assert {"trajectory.txt", "covariances.txt", "keyframes.txt", "map.ply", "map.kinmap", "graph.g2o", "camera.yaml"} <= names
    program("map", "info", tmp_path / "out")


def test_camera(tmp_path):
    lens = dict(width=640, height=480, fx=525, fy=526.5, cx=319.5, cy=np.float32(239.5))
    camera = kinloop.Camera(**lens, distortion=np.array([0.1, -0.2, 0, 0, 0.3]), fps=15)
    camera.save(tmp_path / "camera.yaml")
    assert kinloop.Camera.from_yaml(tmp_path / "camera.yaml") == camera
    assert (camera.width, camera.fy, camera.cy, camera.fps) == (640, 526.5, 239.5, 15)
    np.testing.assert_array_equal(camera.K, [[525, 0, 319.5], [0, 526.5, 239.5], [0, 0, 1]])
    assert kinloop.Camera(**lens).distortion == [0, 0, 0, 0, 0]
    assert kinloop.Camera.preset("freiburg1").fx == pytest.approx(517.306408)
    with pytest.raises(kinloop.InputError, match="'fz'"):
        kinloop.Camera(**lens, fz=3)
    with pytest.raises(kinloop.InputError, match="fy"):
        kinloop.Camera(width=640, height=480, fx=525, cx=320, cy=240)


def test_trajectory(result, tmp_path):
    t = result.trajectory
    again = kinloop.Trajectory(t.stamps_s, t.poses)
    np.testing.assert_array_equal(again.stamps_ns, t.stamps_ns)
    np.testing.assert_allclose(again.poses, t.poses, atol=1e-12)
    np.testing.assert_array_equal(t.positions, t.poses[:, :3, 3])
    np.testing.assert_allclose(np.linalg.norm(t.quaternions, axis=1), 1)
    t.save(tmp_path / "t.csv")
    assert len((tmp_path / "t.csv").read_text().splitlines()) == 121
    with pytest.raises(kinloop.UsageError, match=r"poses\[1\]: expected the 4x4 matrix of a rigid motion"):
        kinloop.Trajectory([0, 1], [np.eye(4), 2 * np.eye(4)])
    with pytest.raises(kinloop.UsageError, match=r"expected stamps_s of shape \(N,\)"):
        kinloop.Trajectory([0, 1], [np.eye(4)])
    # Stamps of Unix time survive the way through a float.
    unix = kinloop.Trajectory([1305031102.175304], [np.eye(4)])
    assert unix.stamps_ns[0] == 1305031102175304000


def test_a_trajectory_is_indexed_sliced_and_pickled(result, tmp_path):
    trajectory = result.trajectory
    np.testing.assert_array_equal(trajectory[3], trajectory.poses[3])
    np.testing.assert_array_equal(trajectory[-1], trajectory.poses[-1])
    assert len(list(trajectory)) == len(trajectory)
    part = trajectory[10:40:3]
    assert isinstance(part, kinloop.Trajectory)
    np.testing.assert_array_equal(part.stamps_ns, trajectory.stamps_ns[10:40:3])
    np.testing.assert_array_equal(part.quaternions, trajectory.quaternions[10:40:3])
    assert len(trajectory[5:2]) == 0
    for index in (len(trajectory), -len(trajectory) - 1):
        with pytest.raises(IndexError, match=f"index {index} of {len(trajectory)} poses"):
            trajectory[index]
    with pytest.raises(kinloop.UsageError, match="positive step"):
        trajectory[::-1]
    trajectory.save(tmp_path / "before.txt")
    pickle.loads(pickle.dumps(trajectory)).save(tmp_path / "after.txt")
    assert (tmp_path / "after.txt").read_bytes() == (tmp_path / "before.txt").read_bytes()


def test_evaluation(result, sequence, program, program_run, tmp_path):
    truth = kinloop.open(sequence).ground_truth
    evaluation = kinloop.evaluate(result.trajectory, truth)
    assert evaluation.ate_m.rmse < 0.05
    by_file = kinloop.evaluate(program_run / "trajectory.txt", str(sequence / "groundtruth.txt"))
    assert by_file.to_dict()["ate"]["rmse_m"] == pytest.approx(evaluation.ate_m.rmse, abs=1e-6)
    assert np.sqrt(np.mean(evaluation.errors_m**2)) == pytest.approx(evaluation.ate_m.rmse)
    # A moved copy of the truth has no error.
    moved = np.eye(4)
    moved[:3, 3] = 1, 2, 3
    exact = kinloop.evaluate(kinloop.Trajectory(truth.stamps_s, moved @ truth.poses), truth)
    assert exact.ate_m.max < 1e-6
    np.testing.assert_allclose(exact.T_truth_estimate, np.linalg.inv(moved), atol=1e-6)
    later = kinloop.Trajectory(truth.stamps_s + 1000, truth.poses)
    with pytest.raises(kinloop.InputError, match="give the ground truth of the same recording"):
        kinloop.evaluate(later, truth)
    shifted = kinloop.evaluate(later, truth, offset=truth.stamps_s[0] - later.stamps_s[0], rpe=["1m"], align="sim3")
    assert shifted.scale == pytest.approx(1)
    assert shifted.offset_s == pytest.approx(truth.stamps_s[0] - later.stamps_s[0])
    assert list(shifted.rpe) == ["1 m"]
    assert kinloop.evaluate(program_run, sequence).to_dict() == by_file.to_dict()  # folders
    table = kinloop.evaluation_table({"a": evaluation, "b": by_file}, "csv")
    assert [line.split(",")[0] for line in table.splitlines()] == ["estimate", "a", "b"]
    assert kinloop.evaluation_plot({"a": evaluation}).startswith("<svg")
    for wrong in ({"align": "yow"}, {"rpe": ["5"]}, {"offset": "now"}, {"max_difference": -1}, {"convention": "x"}):
        with pytest.raises(kinloop.UsageError, match=next(iter(wrong))):
            kinloop.evaluate(result.trajectory, truth, **wrong)


def test_a_mask_leaves_pixels_out(sequence):
    (stamp_s, rgb, depth_m), *_ = arrays_of(sequence)
    used = np.ones(depth_m.shape, bool)
    used[:, : used.shape[1] // 2] = False
    counts = []
    for mask in (None, used, used.astype(np.uint8) * 255):
        slam = kinloop.Slam(kinloop.open(sequence).camera)
        slam.process(stamp_s, rgb, depth_m, mask=mask)
        counts.append(slam.landmarks)
    assert 0.2 * counts[0] < counts[1] < 0.8 * counts[0] and counts[1] == counts[2]
    with pytest.raises(kinloop.UsageError, match="mask"):
        slam.process(stamp_s + 1, rgb, depth_m, mask=used[:10])

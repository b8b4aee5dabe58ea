"""Map files, pose graphs, places, calibration, viewer, conversions, and the stubs."""

import ast
import inspect
import re
import sys
import threading
import types
import urllib.request

import numpy as np
import pytest
from conftest import SOURCE

import kinloop


def test_map_file(result, program, program_run, tmp_path):
    result.save_map(tmp_path / "map.kinmap")
    program("map", "info", tmp_path / "map.kinmap")
    opened = kinloop.Map.load(tmp_path / "map.kinmap")
    np.testing.assert_allclose(opened.trajectory.poses, result.trajectory.poses, atol=1e-9)
    np.testing.assert_allclose(opened.landmarks, result.landmarks, atol=1e-5)
    assert len(opened.keyframes) == len(result.keyframes) and len(opened.sessions) == 1
    assert opened.camera == result.camera or opened.camera.fx == pytest.approx(result.camera.fx, rel=0.05)
    assert len(opened.cloud) == pytest.approx(len(result.cloud), rel=0.02)
    assert len(opened.mesh(voxel_m=0.05).triangles) > 100
    with pytest.raises(kinloop.InputError, match="nothing.kinmap"):
        kinloop.Map.load(tmp_path / "nothing.kinmap")
    with pytest.raises(kinloop.UsageError, match="requires load_map"):
        kinloop.Slam(opened.camera, localize=True)
    with pytest.raises(kinloop.InputError, match="another camera"):
        kinloop.Slam("freiburg1", load_map=tmp_path / "map.kinmap")


def test_exports_are_those_of_the_program(program, program_run, tmp_path):
    opened = kinloop.Map.load(program_run)
    opened.export_colmap(tmp_path / "python")
    program("export", program_run, "--colmap", tmp_path / "program", "-q")
    files = {p.relative_to(tmp_path / "program") for p in (tmp_path / "program").rglob("*") if p.is_file()}
    assert files
    for name in files:
        assert (tmp_path / "python" / name).read_bytes() == (tmp_path / "program" / name).read_bytes(), name
    opened.export_nerfstudio(tmp_path / "nerfstudio")
    assert (tmp_path / "nerfstudio/transforms.json").exists()


def test_continued_map_has_both_recordings(program_run, sequence, tmp_path):
    source = kinloop.open(sequence)
    slam = kinloop.Slam(source.camera, load_map=program_run)
    for _, frame in zip(range(30), source):
        slam.process(frame)
    result = slam.finish()
    assert len(result.trajectory) == 30
    result.save_map(tmp_path / "both.kinmap")
    assert len(kinloop.Map.load(tmp_path / "both.kinmap").sessions) == 2


def rotation_z(angle):
    T = np.eye(4)
    T[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
    return T


def test_pose_graph(tmp_path, program):
    side = rotation_z(1.6)
    side[0, 3] = 1.02
    graph, pose = kinloop.PoseGraph(), np.eye(4)
    for _ in range(4):
        graph.add_vertex(pose)
        pose = pose @ side
    for a, b in [(0, 1), (1, 2), (2, 3), (3, 0)]:
        graph.add_edge(a, b, side)
    graph.save(tmp_path / "square.g2o")
    before = graph.chi2()
    summary = graph.optimize()
    assert summary.converged and summary.chi2_before == before > summary.chi2_after == pytest.approx(graph.chi2())
    np.testing.assert_allclose(graph.poses[0], np.eye(4))
    np.testing.assert_array_equal(graph.edges, [[0, 1], [1, 2], [2, 3], [3, 0]])
    program("optimize", tmp_path / "square.g2o", "-o", tmp_path / "program.g2o")
    np.testing.assert_allclose(kinloop.PoseGraph.load(tmp_path / "program.g2o").poses, graph.poses, atol=1e-9)
    with pytest.raises(kinloop.UsageError, match="unknown option 'sovler'.*did you mean 'solver'"):
        graph.optimize(sovler="ceres")
    with pytest.raises(kinloop.UsageError, match=r"add_edge\(0, 9\)"):
        graph.add_edge(0, 9, side)
    with pytest.raises(kinloop.InputError, match="missing.g2o"):
        kinloop.PoseGraph.load(tmp_path / "missing.g2o")


def test_pose_graph_may_be_read_and_extended_while_it_is_optimised():
    graph, step = kinloop.PoseGraph(), rotation_z(0.1)
    step[0, 3] = 0.1
    for i in range(2000):
        graph.add_vertex(rotation_z(0.11 * i))
        if i > 0:
            graph.add_edge(i - 1, i, step)
    done, added = threading.Event(), []

    def extend():
        while not done.is_set():
            added.append(graph.add_vertex(step))
            assert len(graph.poses) == len(graph) == 2000 + len(added)

    thread = threading.Thread(target=extend)
    thread.start()
    try:
        graph.optimize()
    finally:
        done.set()
        thread.join()
    assert added and len(graph) == 2000 + len(added)
    np.testing.assert_allclose(graph.poses[-1], step, atol=1e-12)  # through a quaternion


def test_pose_graph_in_the_plane(tmp_path):
    (tmp_path / "plane.g2o").write_text(
        "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 2 0 0\nEDGE_SE2 0 1 1 0 0.5 1 0 0 1 0 1\n")
    graph = kinloop.PoseGraph.load(tmp_path / "plane.g2o")
    assert graph.poses.shape == (2, 3, 3)
    assert graph.optimize().chi2_after < 1e-12
    np.testing.assert_allclose(graph.poses[1][:2, 2], [1, 0], atol=1e-9)


def test_places(sequence, tmp_path):
    images = [frame.rgb for frame in kinloop.open(sequence)]
    index = kinloop.PlaceIndex()
    for number in range(0, 120, 10):
        index.add(number, images[number])
    assert len(index) == 12 and 30 in index
    (best, score), *rest = index.query(images[30], 3)
    assert best == 30 and score == pytest.approx(1) and rest[0][1] < score
    assert index.query(images[31], 1)[0][0] == 30
    index.remove(30)
    assert 30 not in index
    with pytest.raises(kinloop.UsageError, match="already"):
        index.add(40, images[40])
    vocabulary = kinloop.Vocabulary.train([sequence], branching=10, depth=3, iterations=3)
    again = kinloop.Vocabulary.train([sequence], branching=10, depth=3, iterations=3, threads=1)
    assert 500 < len(vocabulary) <= 1000
    vocabulary.save(tmp_path / "a.kinvoc")
    again.save(tmp_path / "b.kinvoc")
    assert (tmp_path / "a.kinvoc").read_bytes() == (tmp_path / "b.kinvoc").read_bytes()
    words = kinloop.Vocabulary.load(tmp_path / "a.kinvoc").words_of(images[0])
    assert words == vocabulary.words_of(images[0]) and sum(words.values()) == pytest.approx(1, abs=1e-5)
    assert len(kinloop.PlaceIndex(vocabulary).query(images[0])) == 0


def board_views(rng, K):
    """Views of a board of 8 x 6 corners by an ideal camera, with noise of 0.05 px."""
    board = np.stack(np.meshgrid(np.arange(8), np.arange(6)), -1).reshape(-1, 2) * 0.03
    for i in range(12):
        axis = rng.normal(size=3) * [1, 1, 0.3]
        angle, axis = 0.5, axis / np.linalg.norm(axis)
        skew = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
        R = np.eye(3) + np.sin(angle) * skew + (1 - np.cos(angle)) * skew @ skew
        centre = np.array([0.12, 0.08, 0])
        points = (np.c_[board, np.zeros(len(board))] - centre) @ R.T + [*rng.uniform(-0.1, 0.1, 2), rng.uniform(0.4, 0.6)]
        pixels = points @ K.T
        yield kinloop.BoardView(board, pixels[:, :2] / pixels[:, 2:] + rng.normal(0, 0.05, (len(board), 2)), (640, 480), f"view {i}")


def test_calibration(tmp_path):
    K = np.array([[525, 0, 322.0], [0, 527, 241], [0, 0, 1]])
    views = list(board_views(np.random.default_rng(1), K))
    calibration = kinloop.calibrate(views, distortion_terms=2)
    assert calibration.rms_px < 0.1 and len(calibration.views) == 12 and calibration.rejected == {}
    camera = calibration.camera(depth_scale=1000)
    for name, expected in [("fx", 525), ("fy", 527), ("cx", 322), ("cy", 241)]:
        assert abs(getattr(camera, name) - expected) < 5 * calibration.deviations[name]
    camera.save(tmp_path / "camera.yaml")
    with pytest.raises(kinloop.InputError, match="at least 3"):
        kinloop.calibrate(views[:2])
    with pytest.raises(kinloop.UsageError, match="unknown option 'terms'"):
        kinloop.calibrate(views, terms=2)
    with pytest.raises(kinloop.InputError):
        kinloop.calibrate(tmp_path / "nothing", "8x6", 0.03)


def test_find_board():
    squares = np.indices((7, 9)).sum(0) % 2 * 255
    image = np.full((480, 640), 255, np.uint8)
    image[60:410, 90:540] = np.kron(squares, np.ones((50, 50)))
    view = kinloop.find_board(image, "8x6", 0.03)
    assert view.pixels.shape == view.board_m.shape == (48, 2) and view.size == (640, 480)
    corners = np.stack(np.meshgrid(139.5 + 50 * np.arange(8), 109.5 + 50 * np.arange(6)), -1).reshape(-1, 2)
    assert abs(np.sort(view.pixels, axis=0) - np.sort(corners, axis=0)).max() < 0.5
    assert kinloop.find_board(np.zeros((480, 640, 3), np.uint8), "8x6", 0.03) is None
    with pytest.raises(kinloop.UsageError):
        kinloop.find_board(image, "8by6", 0.03)


def test_viewer_serves_on_loopback_and_may_be_framed_by_a_notebook(result, program_run):
    for what in (result, kinloop.Map.load(program_run), program_run, program_run / "map.ply"):
        with kinloop.view(what) as viewer:
            assert viewer.url.startswith("http://127.0.0.1:")
            assert f'<iframe src="{viewer.url}"' in viewer._repr_html_()
            with urllib.request.urlopen(viewer.url) as page:
                policy = page.headers["Content-Security-Policy"]
                assert "frame-ancestors http://localhost:*" in policy and "frame-ancestors 'none'" not in policy
        with pytest.raises(OSError):
            urllib.request.urlopen(viewer.url, timeout=5)
    with pytest.raises(kinloop.UsageError, match="view: expected"):
        kinloop.view(3)


def test_viewer_shows_the_map_of_a_run_that_goes_on(sequence):
    source = kinloop.open(sequence)
    slam = kinloop.Slam(source.camera)
    for _ in range(60):
        slam.process(next(source))
    with kinloop.view(slam) as viewer, urllib.request.urlopen(viewer.url) as page:
        assert page.status == 200
    assert slam.process(next(source)) is not None


def test_export_rerun_names_the_missing_package(program_run, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "rerun", None)
    with pytest.raises(ImportError, match="pip install rerun-sdk"):
        kinloop.Map.load(program_run).export_rerun(tmp_path / "run.rrd")
    assert not list(tmp_path.iterdir())


def test_share_writes_a_page_below_the_limit(result, program_run, tmp_path):
    page = tmp_path / "room.html"
    for what in (result, kinloop.Map.load(program_run), program_run, program_run / "map.ply"):
        kinloop.share(what, page, max_size_mb=2)
        assert 100_000 < page.stat().st_size <= 2e6
        page.unlink()
    kinloop.share(program_run, page)
    full_bytes = page.stat().st_size
    kinloop.share(program_run, page, points=10, images=False)
    assert page.stat().st_size < full_bytes


def test_share_refuses_what_it_cannot_write(result, program_run, tmp_path):
    page = tmp_path / "room.html"
    with pytest.raises(kinloop.InputError, match="map.ply: has no mesh; share the folder"):
        kinloop.share(program_run / "map.ply", page, mesh=True)
    with pytest.raises(kinloop.InputError, match="Python: has no mesh"):
        kinloop.share(result, page, mesh=True)
    for size_mb in (0, 101, float("nan")):
        with pytest.raises(kinloop.UsageError, match="max_size_mb is .*; expected 1 to 100"):
            kinloop.share(program_run, page, max_size_mb=size_mb)
    cloud = tmp_path / "room.ply"
    cloud.write_bytes((program_run / "map.ply").read_bytes())
    with pytest.raises(kinloop.UsageError, match="would overwrite"):
        kinloop.share(cloud, cloud)
    assert cloud.read_bytes() == (program_run / "map.ply").read_bytes()
    with pytest.raises(kinloop.UsageError, match="share: expected"):
        kinloop.share(3, page)


def test_a_viewer_may_be_closed_by_several_threads(program_run):
    for _ in range(5):
        viewer = kinloop.view(program_run / "map.ply")
        threads = [threading.Thread(target=viewer.close) for _ in range(4)]
        for thread in threads:
            thread.start()
        assert viewer.browsers == 0
        for thread in threads:
            thread.join()


def test_conversions_to_other_packages(result, monkeypatch):
    # Both are large: their interfaces are replaced by ones that keep what they get.
    class Kept(types.SimpleNamespace):
        def __init__(self, *values, **named):
            super().__init__(values=values, **named)

    o3d = types.SimpleNamespace(geometry=types.SimpleNamespace(PointCloud=Kept, TriangleMesh=Kept),
                                utility=types.SimpleNamespace(Vector3dVector=np.asarray, Vector3iVector=np.asarray))
    monkeypatch.setitem(sys.modules, "open3d", o3d)
    monkeypatch.setitem(sys.modules, "pandas", types.SimpleNamespace(DataFrame=Kept, Index=Kept))
    points = result.cloud.to_open3d()
    assert points.points.dtype == points.colors.dtype == np.float64 and points.colors.max() <= 1
    mesh = result.mesh(voxel_m=0.05)
    assert mesh.to_open3d().triangles.shape == mesh.triangles.shape
    frame = result.trajectory.to_pandas()
    assert list(frame.values[0]) == "tx ty tz qx qy qz qw".split()
    np.testing.assert_array_equal(frame.values[0]["ty"], result.trajectory.positions[:, 1])


def test_missing_packages_are_named(result, monkeypatch):
    monkeypatch.setitem(sys.modules, "open3d", None)
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(ImportError, match="Cloud.to_open3d requires the package open3d; install it: pip install open3d"):
        result.cloud.to_open3d()
    with pytest.raises(ImportError, match="Trajectory.to_pandas requires the package pandas"):
        result.trajectory.to_pandas()


def stub_names():
    tree = ast.parse((SOURCE / "python/kinloop/_kinloop.pyi").read_text())
    for node in tree.body:
        if isinstance(node, ast.FunctionDef):
            yield node.name
        if isinstance(node, ast.ClassDef):
            yield node.name
            yield from (f"{node.name}.{member.name}" for member in node.body if isinstance(member, ast.FunctionDef))


def public_names():
    for name in kinloop.__all__:
        yield name
        value = getattr(kinloop, name)
        if isinstance(value, type):
            yield from (f"{name}.{member}" for member in vars(value) if not member.startswith("_"))


def test_stubs_have_every_public_name_and_no_other():
    public, stubs = set(public_names()), set(stub_names())
    assert public - stubs == set()
    assert {name for name in stubs - public if not name.split(".")[-1].startswith("__")} == set()


def stub_functions():
    """(name, definition) of every function and member in the stubs; overloads several times."""
    tree = ast.parse((SOURCE / "python/kinloop/_kinloop.pyi").read_text())
    for node in tree.body:
        if isinstance(node, ast.FunctionDef):
            yield node.name, node
        if isinstance(node, ast.ClassDef):
            yield from ((f"{node.name}.{member.name}", member) for member in node.body if isinstance(member, ast.FunctionDef))


def module_member(name):
    """A function, property or static method, as its class stores it."""
    owner, _, member = name.rpartition(".")
    return vars(getattr(kinloop, owner) if owner else kinloop)[member]


def arguments_of(definition):
    """Names and defaults of a function: 'a', 'b=0', '*', 'c=None', '**'. The types are not compared."""

    def text(name, default):
        if default is None:
            return name
        value = ast.literal_eval(default)
        return f"{name}={float(value) if type(value) is int else value!r}"

    a = definition.args
    positional = [None] * (len(a.args) - len(a.defaults)) + a.defaults
    found = [text(arg.arg, default) for arg, default in zip(a.args, positional) if arg.arg != "self"]
    if a.vararg or a.kwonlyargs:
        found.append("*")
    found += [text(arg.arg, default) for arg, default in zip(a.kwonlyargs, a.kw_defaults)]
    return found + ["**"] * bool(a.kwarg)


def module_signatures(name):
    """The definitions that a TypeError lists, since far too many arguments match none."""
    function = kinloop
    for part in name.removesuffix(".__init__").split("."):
        function = getattr(function, part)
    with pytest.raises(TypeError) as error:
        function(*[object()] * 30)
    lines = re.findall(r"^ +\d+\. [^(]*(\(.*\))(?: -> .*)?$", str(error.value), re.MULTILINE)
    return [ast.parse(f"def f{arguments}: ...".replace("::", ".")).body[0] for arguments in lines]


def test_stubs_say_what_is_a_property_and_what_is_static():
    assert len(list(stub_functions())) > 100
    for name, definition in stub_functions():
        kinds = {decorator.id for decorator in definition.decorator_list} - {"overload"}
        member = module_member(name)
        actual = {kind for kind, type_ in (("property", property), ("staticmethod", staticmethod)) if isinstance(member, type_)}
        assert kinds == actual, name


def test_stubs_have_the_arguments_and_defaults_of_the_module():
    stubs = {}
    for name, definition in stub_functions():
        special = name.split(".")[-1].startswith("__") and not name.endswith("__init__")
        member = module_member(name)
        of_python = isinstance(member, types.FunctionType) and not hasattr(member, "__wrapped__")
        if not special and not isinstance(member, property) and not of_python:
            stubs.setdefault(name, []).append(arguments_of(definition))
    del stubs["Camera.__init__"]  # takes any keywords; the stub lists the keys of camera.yaml
    assert len(stubs) > 50
    for name, expected in stubs.items():
        assert [arguments_of(signature) for signature in module_signatures(name)] == expected, name


def test_functions_and_methods_have_the_signatures_of_the_stubs():
    definitions = list(stub_functions())
    names = [name for name, _ in definitions]
    assert len(names) > 100
    for name, definition in definitions:
        special = name.split(".")[-1].startswith("__") and not name.endswith("__init__")
        member = module_member(name)
        if special or isinstance(member, property) or not hasattr(getattr(member, "__func__", member), "__wrapped__"):
            continue  # not a function of the C++ module
        function = kinloop
        for part in name.split("."):
            function = getattr(function, part)
        found = list(inspect.signature(function).parameters)
        expected = [arg.arg for arg in definition.args.args + definition.args.kwonlyargs]
        expected += [arg.arg for arg in (definition.args.vararg, definition.args.kwarg) if arg]
        assert found == (["arguments", "keywords"] if names.count(name) > 1 else expected), name
    assert str(inspect.signature(kinloop.find_board)) == "(image, board, square_m, marker_m=0, name='')"
    assert list(inspect.signature(kinloop.Trajectory).parameters) == ["stamps_s", "poses"]


def test_errors_tell_types_and_shapes_not_values():
    with pytest.raises(TypeError) as error:
        kinloop.Trajectory(np.zeros(3), np.zeros((3, 4, 4)), True, depth=np.zeros((480, 640), np.uint16))
    assert "Invoked with: Trajectory, ndarray of float64, shape (3,), ndarray of float64, shape (3, 4, 4), bool, " \
           "depth: ndarray of uint16, shape (480, 640)" in str(error.value)
    assert "array(" not in str(error.value)


def test_everything_has_a_docstring():
    plain = {"mean", "median", "min", "max", "chi2_before", "chi2_after", "iterations", "converged", "solver", "name"}
    assert len(list(public_names())) > 100
    for name in public_names():
        value = kinloop
        for part in name.split("."):
            value = getattr(value, part)
        assert (value.__doc__ or "").strip() or name.split(".")[-1] in plain, name

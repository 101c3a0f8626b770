"""The wall in pictures and files for other programs; nothing is shown or followed below it."""

import numpy as np
import pytest
from calls import told
from interrupted import make
from test_pictures import uncut  # noqa: F401  (a fixture)
from test_wall_runs import SETTLING

from rodsim import open_trajectory, simulate
from rodsim.analysis.flow import flow_at, tracer_paths
from rodsim.analysis.grid import make_grid
from rodsim.analysis.replay import Replay
from rodsim.analysis.wall import piece_of_wall
from rodsim.errors import UsageError
from rodsim.plotting.camera import make_camera

matplotlib = pytest.importorskip("matplotlib")
pytestmark = pytest.mark.compiled
WALL = -0.4


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    folder = tmp_path_factory.mktemp("runs")
    short = ["time.end=0.52", "tracers=null"]
    simulate(make(folder, SETTLING, short), folder / "wall.h5")
    simulate(make(folder, SETTLING, [*short, "fluid.wall=null"]), folder / "free.h5")
    return folder


@pytest.fixture
def drawn(monkeypatch):
    """Note where walls are drawn: the heights of lines, the corners of planes, by axis."""
    from matplotlib.axes import Axes

    seen = {"lines": [], "planes": []}
    for name in ("axhline", "axvline"):
        plain = getattr(Axes, name)

        def noted(axis, place, *args, plain=plain, name=name, **options):
            seen["lines"] += [(name, place)] if place != 0.0 else []  # not the zero of a profile
            return plain(axis, place, *args, **options)

        monkeypatch.setattr(Axes, name, noted)
    fill = Axes.fill

    def noted_plane(axis, *args, **options):
        seen["planes"].append(np.array(args))
        return fill(axis, *args, **options)

    monkeypatch.setattr(Axes, "fill", noted_plane)
    return seen


@pytest.mark.parametrize(
    ("command", "options", "lines", "planes"),
    [
        ("plot", (), 0, 5),
        ("plot", ("--view", "xz", "-n", "2"), 2, 0),
        ("plot", ("--view", "zy", "--overlay", "-n", "2"), 2, 0),
        ("plot", ("--view", "xy", "-n", "2"), 0, 0),
        ("flow", (), 0, 0),
        ("flow", ("--grid", "plane:yz", "--resolution", "20"), 1, 0),
        ("flow", ("--grid", "plane:xz", "--resolution", "20", "--colour", "pressure"), 1, 0),
        ("flow", ("--grid", "-1:2:21,0.4,-1:1:21", "--arrows"), 1, 0),
        ("flow", ("--grid", "line:z"), 2, 0),
        ("flow", ("--grid", "box", "--resolution", "8"), 0, 1),
        ("flow", ("--tracers", "--grid", "-1:2:4,0.3,-1:1:5"), 0, 1),
    ],
)
def test_the_wall_is_drawn_where_there_is_one(
    command,
    options,
    lines,
    planes,
    runs,
    drawn,
    uncut,  # noqa: F811
    tmp_path,
):
    told(command, runs / "wall.h5", "-o", tmp_path / "a.png", *options, "-q")
    assert [place for _, place in drawn["lines"]] == [WALL] * lines
    assert {name for name, _ in drawn["lines"]} <= {
        "axvline" if "line:z" in options or "zy" in options else "axhline"
    }
    assert len(drawn["planes"]) == planes
    assert len(uncut) == 1
    drawn["lines"].clear(), drawn["planes"].clear()
    told(command, runs / "free.h5", "-o", tmp_path / "b.png", *options, "-q")
    assert drawn == {"lines": [], "planes": []}


def test_colours_and_stream_lines_do_not_break_on_what_is_below(runs, tmp_path, monkeypatch):
    """Once NaN was the largest speed: one colour, and no stream line."""
    from matplotlib.axes import Axes

    streams, limits = [], []
    stream, mesh = Axes.streamplot, Axes.pcolormesh
    monkeypatch.setattr(Axes, "streamplot", lambda *a, **k: streams.append(stream(*a, **k)))

    def noted(*args, **options):
        limits.append((options["norm"].vmin, options["norm"].vmax))  # the key has a mesh too
        return mesh(*args, **options)

    monkeypatch.setattr(Axes, "pcolormesh", noted)
    out = tmp_path / "a.png"
    told("flow", runs / "wall.h5", "--grid", "-1:2:21,0.4,-1:1:21", "-o", out, "-q")
    assert len(streams) == 1
    assert len(streams[0].lines.get_segments()) > 20
    assert limits[0][0] == 0.0
    assert 0.0 < limits[0][1] < 10.0


def test_movies_draw_the_wall_in_every_picture(runs, drawn, tmp_path):
    told("plot", runs / "wall.h5", "-o", tmp_path / "a.gif", "--view", "yz", "-n", "3", "-q")
    assert drawn["lines"] == [("axhline", WALL)] * 3


def test_z_points_up_beside_a_wall():
    tall = np.array([[0.0, 0.0, 0.0], [0.0, 0.3, 4.0]])
    assert make_camera("auto", tall).flat == "zy"
    assert make_camera("auto", tall, upright=True).flat == "yz"
    wide = np.array([[0.0, 0.0, 0.0], [0.2, 3.0, 0.4], [0.7, 1.0, 0.1]])  # flattest along z
    assert make_camera("3d", wide).matrix[1, 2] < 0.5
    assert make_camera("3d", wide, upright=True).matrix[1, 2] > 0.9  # cos of the tilt


def test_a_wall_far_below_is_left_out():
    points = np.array([[0.0, 0.1, 2.0], [1.5, 0.2, 2.4]])
    assert piece_of_wall(points, None) is None
    assert piece_of_wall(points, 0.4) is None
    corners = piece_of_wall(points, 0.6)
    assert corners == pytest.approx(
        np.array([[-0.15, -0.05, 0.6], [1.65, -0.05, 0.6], [1.65, 0.35, 0.6], [-0.15, 0.35, 0.6]])
    )


def test_a_grid_that_follows_the_rods_begins_on_the_wall(runs):
    with open_trajectory(runs / "wall.h5") as run:
        position = run.position[-1]
        assert run.wall == WALL
    for text in ("plane:yz", "box", "line:z"):
        free, grid = make_grid(text, position), make_grid(text, position, floor=WALL)
        assert free.z[0] < WALL == grid.z[0]
        assert grid.step == pytest.approx(free.step, rel=1e-12)
        assert free.z[-1] <= grid.z[-1] < free.z[-1] + 1.001 * grid.step[2]
    high = make_grid("box", position + 100.0, floor=WALL)
    assert (high.z == make_grid("box", position + 100.0).z).all()
    with pytest.raises(UsageError, match="below the wall"):
        make_grid("0,0,-2:-1:4", position, floor=WALL)


def test_below_the_wall_there_is_no_flow_and_on_it_none(runs):
    with open_trajectory(runs / "wall.h5") as run:
        replay = Replay(run)
        flow = flow_at(replay, 2, make_grid("-1:2:7,0.3,-1:1:11", run.position[2], floor=WALL))
    below, on = flow.grid.points[:, 2] < WALL - 1e-9, abs(flow.grid.points[:, 2] - WALL) < 1e-9
    assert (below.sum(), on.sum()) == (21, 7)
    assert np.isnan(flow.velocity[below]).all()
    assert np.isnan(flow.pressure[below]).all()
    assert np.isfinite(flow.velocity[~below]).all()
    assert np.isfinite(flow.pressure[~below]).all()
    assert abs(flow.velocity[on]).max() < 1e-14 * abs(flow.velocity[~below]).max()


def test_flows_are_exported_with_nan_below_and_paths_end_above(runs, tmp_path):
    table, paths = tmp_path / "a.npz", tmp_path / "b.npz"
    told("flow", runs / "wall.h5", "--grid", "-1:2:7,0.3,-1:1:11", "-o", table, "-q")
    with np.load(table) as flow:
        assert (np.isnan(flow["velocity"]).any(axis=(0, 1, 3)) == (flow["z"] < WALL - 1e-9)).all()
    told("flow", runs / "wall.h5", "--tracers", "--grid", "-1:2:4,0.3,-1:1:11", "-o", paths, "-q")
    with np.load(paths) as found:
        position = found["position"]
    assert position.shape == (5, 32, 3)  # of 44, twelve would start below
    assert position[..., 2].min() >= WALL
    assert np.isfinite(position).all()
    assert abs(position[-1] - position[0]).max() > 0.05
    said = told("flow", runs / "wall.h5", "--tracers", "--grid", "-1:2:4,0.3,-1:1:11", "-o", paths)
    assert "12 tracers would start below the wall" in said


def test_a_path_below_the_wall_is_nan_and_spoils_no_other(runs):
    with open_trajectory(runs / "wall.h5") as run:
        replay, seeds = Replay(run), np.array([[0.4, 0.3, 0.1], [0.4, 0.3, -0.7]])
        both, one = (tracer_paths(replay, x, 0, 3) for x in (seeds, seeds[:1]))
    assert np.isnan(both.position[1:, 1]).all()
    # The rate by which frames settle is estimated anew, from another start: 2e-8.
    assert both.position[:, 0] == pytest.approx(one.position[:, 0], abs=1e-6)
    assert np.isfinite(both.miss).all()


def test_paraview_gets_the_wall_as_a_polygon(runs, tmp_path):
    reader = pytest.importorskip("vtkmodules.vtkIOHDF").vtkHDFReader
    from vtkmodules.util.numpy_support import vtk_to_numpy

    seen = {}
    for name in ("wall", "free"):
        told("export", runs / f"{name}.h5", "-o", tmp_path / f"{name}.vtkhdf", "-q")
        source = reader()
        source.SetFileName(str(tmp_path / f"{name}.vtkhdf"))
        source.UpdateInformation()
        source.SetStep(3)
        source.Update()
        seen[name] = source.GetOutput()
    assert (seen["free"].GetNumberOfPolys(), seen["free"].GetNumberOfPoints()) == (0, 24)
    wall = seen["wall"]
    assert (wall.GetNumberOfLines(), wall.GetNumberOfPolys(), wall.GetNumberOfPoints()) == (
        2,
        1,
        28,
    )
    points = vtk_to_numpy(wall.GetPoints().GetData())
    with open_trajectory(runs / "wall.h5") as run:
        assert (points[:24] == run.position[3]).all()
        low, high = run.position.min(axis=(0, 1)), run.position.max(axis=(0, 1))
    assert (points[24:, 2] == WALL).all()
    assert (points[24:, :2].min(axis=0) < low[:2]).all()
    assert (points[24:, :2].max(axis=0) > high[:2]).all()
    radius = vtk_to_numpy(wall.GetPointData().GetArray("radius"))
    assert np.isfinite(radius).sum() == 24
    assert vtk_to_numpy(wall.GetCellData().GetArray("rod")).tolist() == [0, 1, -1]

"""Pictures and movies as users get them: whole, uncut, said; and what is in them."""

import re
import sys

import numpy as np
import pytest
from calls import command, settings, told
from drawn import faults
from scenes import CONFIGS

from rodsim import open_trajectory
from rodsim.nodes import lay_out
from rodsim.plotting.camera import VIEWS, make_camera
from rodsim.plotting.directors import chosen_points, draw_directors
from rodsim.plotting.style import nice_length, pretty_unit
from rodsim.plotting.surface import normals, ribbon, tube

matplotlib = pytest.importorskip("matplotlib")

POWER = re.compile(r"(?<=\()10[⁻⁰¹²³⁴-⁹]+ ")  # with the unit of small numbers
RING, TAIL = (str(CONFIGS / f"{name}.yaml") for name in ("closed_ring_low_twist", "flagellum"))
SETS = {
    "ring.h5": (RING, "rods.ring.shape.points=40", "time.end=2e-3", "tracers.inner.along=9"),
    "tail.h5": (TAIL, "rods.tail.shape.points=60", "time.end=4e-3"),
}


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    folder = tmp_path_factory.mktemp("runs")
    for name, (case, *sets) in SETS.items():
        command("run", case, "-q", "-o", folder / name, *settings(*sets))
    return folder


@pytest.fixture
def here(runs, here):
    """The runs, from an empty folder."""
    return runs


@pytest.fixture
def uncut(monkeypatch):
    """Look at every figure that is saved: nothing is cut, collapsed, or over something else."""
    from matplotlib.figure import Figure
    from matplotlib.text import Text

    save, seen = Figure.savefig, []

    def look_and_save(figure, *arguments, **options):
        assert faults(figure) == []
        texts = [text for text in figure.findobj(Text) if text.get_visible() and text.get_text()]
        seen.append([POWER.sub("", text.get_text()) for text in texts])
        return save(figure, *arguments, **options)

    monkeypatch.setattr(Figure, "savefig", look_and_save)
    return seen


@pytest.mark.parametrize(
    ("name", "options", "words"),
    [
        ("ring.h5", (), {"t = 0 s", "t = 0.002 s", "x", "z"}),
        ("ring.h5", ("--view", "zy", "--style", "ribbon"), {"z (µm)", "y (µm)"}),
        ("ring.h5", ("--colour", "curvature", "--at", "1e-3"), {"t = 0.001 s", "curvature (µm⁻¹)"}),
        ("ring.h5", ("--overlay", "--frames", "2"), {"time (s)"}),
        ("ring.h5", ("--directors",), {"D1", "D2", "t = 0 s"}),
        ("tail.h5", ("--directors", "--overlay", "-n", "2"), {"D1", "D2", "y (µm)"}),
        ("tail.h5", (), {"z (µm)", "y (µm)", "t = 0.004 s"}),
        ("tail.h5", ("--overlay", "--colour", "curvature"), {"curvature (µm⁻¹)"}),
        ("ring.h5", ("-w", "energy"), {"energy (g µm² s⁻²)", "time (s)", "bending"}),
        ("ring.h5", ("-w", "speed"), {"speed (µm s⁻¹)", "centroid"}),
        ("ring.h5", ("-w", "twist"), {"twist (µm⁻¹)", "s along ring (µm)"}),
        ("tail.h5", ("-w", "curvature"), {"curvature (µm⁻¹)", "s along tail (µm)", "time (s)"}),
    ],
)
def test_stills_are_uncut_and_labelled(name, options, words, here, uncut):
    assert told("plot", here / name, "-o", "a.png", *options) == "wrote a.png\n"
    assert words <= set(uncut[0])


@pytest.mark.parametrize(
    ("grid", "options", "words"),
    [
        ("plane", (), {"speed (µm s⁻¹)", "x (µm)", "y (µm)"}),
        ("plane:xz", ("--colour", "pressure", "--arrows"), {"pressure (g µm⁻¹ s⁻²)", "z (µm)"}),
        ("plane", ("--log", "--size", "86x70"), {"speed (µm s⁻¹)", "x (µm)"}),
        ("plane", ("--arrows",), {"plane z = 0 µm; arrows: direction only"}),
        ("line:z", (), {"velocity (µm s⁻¹)", "pressure (g µm⁻¹ s⁻²)", "u_x", "z (µm)"}),
        ("box", (), {"speed (µm s⁻¹)"}),
        ("plane", ("--tracers", "--resolution", "5"), {"time (s)"}),
    ],
)
def test_flows_are_uncut_and_labelled(grid, options, words, here, uncut):
    told("flow", here / "ring.h5", "--grid", grid, "-o", "f.png", *options)
    assert words <= set(uncut[0])


def test_every_format_is_what_its_name_says(here):
    heads = {"png": b"\x89PNG", "pdf": b"%PDF", "svg": b"<?xml", "gif": b"GIF89a"}
    for kind, head in heads.items():
        told("plot", here / "tail.h5", "-o", f"a.{kind}", "-n", "2")
        with open(f"a.{kind}", "rb") as stream:
            assert stream.read(len(head)) == head


def test_movies_have_every_frame(here, tmp_path):
    from PIL import Image

    imageio_ffmpeg = pytest.importorskip("imageio_ffmpeg")
    with open_trajectory(here / "tail.h5") as run:
        frames = run.frames
    said = told("plot", here / "tail.h5", "-o", "a.gif", "--fps", "10", "--dpi", "80")
    assert said.endswith("wrote a.gif\n")
    with Image.open("a.gif") as movie:
        assert movie.n_frames == frames
        assert movie.info["duration"] == 100
        shades = [np.asarray(movie.convert("L"))]
        movie.seek(frames - 1)
        shades.append(np.asarray(movie.convert("L")))
    assert (shades[0] != shades[1]).sum() > 100  # it moves
    told("plot", here / "tail.h5", "-o", "a.mp4", "--fps", "10", "--dpi", "50", "-q")
    count, seconds = imageio_ffmpeg.count_frames_and_secs("a.mp4")
    assert (count, seconds) == (frames, pytest.approx(frames / 10, abs=0.11))
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.gif", "a.mp4"]


@pytest.mark.parametrize("name", ["a.gif", "a.mp4"])
def test_an_interrupted_movie_leaves_the_earlier_one(name, here, tmp_path, monkeypatch):
    (tmp_path / name).write_text("earlier")
    from rodsim.plotting.shapes import Shapes

    draw, drawn = Shapes.draw, []

    def draw_two(shapes, axis, camera, frame):
        if len(drawn) == 2:
            raise KeyboardInterrupt
        drawn.append(frame)
        return draw(shapes, axis, camera, frame)

    monkeypatch.setattr(Shapes, "draw", draw_two)
    assert "interrupted" in told("plot", here / "tail.h5", "-o", name, code=75)
    assert [path.name for path in tmp_path.iterdir()] == [name]
    assert (tmp_path / name).read_text() == "earlier"


def test_a_replaced_picture_is_said(here, tmp_path):
    (tmp_path / "a.png").write_text("earlier")
    said = told("plot", here / "tail.h5", "-o", "a.png", "-w", "energy")
    assert said == "wrote a.png, in place of an earlier one\n"


@pytest.mark.parametrize(
    ("arguments", "code", "words"),
    [
        (("plot", "-o", "a.jpg"), 2, "a.jpg: must end in one of .png .pdf .svg .gif .mp4"),
        (("plot", "-w", "energy", "-o", "a.gif"), 2, "a.gif: must end in one of .png .pdf .svg"),
        (("plot", "-o", "ring.h5"), 2, "ring.h5: must end in"),
        (("plot", "-o", "no/a.png"), 4, "no/a.png"),
        (("plot", "-o", "a.png", "--view", "up"), 2, "view must be one of auto, 3d, xy"),
        (("plot", "-o", "a.png", "--at", "7"), 2, "t = 7: the file has frames from 0 to 0.002 s"),
        (("flow", "-o", "a.png", "--at", "-1"), 2, "frames from 0 to 0.002 s"),
        (("flow", "-o", "a.png", "--grid", "disc"), 2, "write plane, plane:yz"),
        (("flow", "-o", "a.vtkhdf"), 2, "must end in one of .png .pdf .svg .vti .csv .npz"),
        (("flow", "-o", "a.csv", "--tracers", "--at", "2e-3"), 2, "--until"),
        (("flow", "-o", "a.csv", "--tracers", "--raw"), 2, "--raw is not for --tracers"),
        (("flow", "-o", "a.csv", "--until", "1e-3"), 2, "--until is only for --tracers"),
        (("flow", "-o", "a.csv", "--tracers", "--log"), 2, "--log is not for --tracers"),
        (("flow", "-o", "a.png", "--grid", "line:z", "--log"), 2, "--log is for colours of speed"),
    ],
)
def test_what_cannot_be_drawn_is_said_in_one_line(arguments, code, words, here, tmp_path):
    command, *options = arguments
    said = told(command, here / "ring.h5", *options, code=code)
    assert words in said
    assert len(said.splitlines()) == 1
    assert list(tmp_path.iterdir()) == []


def test_what_is_not_installed_is_named(here, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    said = told("plot", here / "ring.h5", "-o", "a.png", "-w", "energy", code=2)
    assert "pip install 'rodsim[plot]'" in said


def test_cameras_are_rotations_and_look_where_they_say():
    points = np.random.default_rng(3).normal(size=(50, 3)) * (0.3, 5.0, 2.0)
    for view in VIEWS:
        matrix = make_camera(view, points).matrix
        assert matrix @ matrix.T == pytest.approx(np.eye(3), abs=1e-14)
        assert np.linalg.det(matrix) == pytest.approx(1.0)  # no mirror: handedness is seen
    seen = make_camera("zy", points).project(points)
    assert np.array_equal(seen[:, :2], points[:, [2, 1]])
    assert make_camera("auto", points * (0.0, 1.0, 1.0)).flat == "yz"
    assert make_camera("auto", points).flat == ""


def test_tubes_and_ribbons_lie_where_the_triads_say():
    s = np.linspace(0.0, 2.5, 8)
    position = np.stack([0 * s, 0 * s, s], axis=1)
    angle = 0.7 * s
    first = np.stack([np.cos(angle), np.sin(angle), 0 * s], axis=1)
    third = np.tile([0.0, 0.0, 1.0], (8, 1))
    director = np.stack([first, np.cross(third, first), third], axis=1)
    corners, stripe = tube(position, director, 0.3)
    assert np.hypot(*corners[..., :2].reshape(-1, 2).T) == pytest.approx(0.3)
    middle = corners[stripe].reshape(7, -1, 3).mean(axis=1)
    along = np.arctan2(middle[:, 1], middle[:, 0])
    assert along == pytest.approx(0.5 * (angle[1:] + angle[:-1]), abs=0.03)  # round D1
    flat = ribbon(position, director, 0.8)
    assert flat.shape == (7, 1, 4, 3)
    assert flat[0, 0, 0] == pytest.approx(position[0] - 0.4 * first[0])
    assert flat[0, 0, 2] == pytest.approx(position[1] + 0.4 * first[1])
    assert np.linalg.norm(normals(flat), axis=-1) == pytest.approx(1.0)


@pytest.mark.parametrize("view", ["3d", "xy"])
def test_arrows_lie_along_the_triads(view):
    """Seen by the camera; one that points at the viewer is a dot."""
    from matplotlib.figure import Figure

    rng = np.random.default_rng(8)
    position = rng.normal(size=(50, 3))
    director = np.linalg.qr(rng.normal(size=(50, 3, 3)))[0]
    director[7] = np.eye(3)[[2, 0, 1]]  # D1 along z
    rods = lay_out([("a", 7, False, 0.3, [1] * 6), ("b", 43, False, 0.3, [1] * 6)])
    camera = make_camera(view, position)
    axis = draw_directors(Figure().add_subplot(), camera, rods, position, director, 0.4)
    nodes = [*range(7), *(7 + chosen_points(43))]
    assert nodes[7] == 7
    assert nodes[-1] == 49
    assert len(nodes) == 7 + 16
    arrows, dots = axis.collections[::2], axis.collections[1::2]
    for i, (drawn, dot) in enumerate(zip(arrows, dots, strict=True)):
        seen = [k for k in nodes if not (view == "xy" and i == 0 and k == 7)]
        tips = (position + 0.4 * director[:, i]) @ camera.matrix.T
        assert drawn.XY + np.c_[drawn.U, drawn.V] == pytest.approx(tips[seen, :2])
        assert len(dot.get_offsets()) == len(nodes) - len(seen)


def test_units_and_lengths_as_people_write_them():
    assert pretty_unit("g um^2 s^-2") == "g µm² s⁻²"
    assert pretty_unit("kT at 298 K") == "kT at 298 K"
    assert [nice_length(x) for x in (1.0, 1.9, 2.3, 7.0, 0.04)] == pytest.approx([1, 1, 2, 5, 0.02])

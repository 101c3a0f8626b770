"""Pictures of made-up runs, looked at: nothing cut or collapsed, colours and ranges as said."""

import itertools
from pathlib import Path

import numpy as np
import pytest
from calls import command, told
from drawn import EPSILON, coil, faults, wave, write

from rodsim.output.layout import ENERGY

matplotlib = pytest.importorskip("matplotlib")

from rodsim.plotting import colours, rod, style, surface  # noqa: E402
from rodsim.plotting.camera import make_camera  # noqa: E402

TIMES = [0.0, 0.013, 0.026, 0.4]
LONG = "A title that is far too long for any picture, and longer still, to be seen in its lines"


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    folder = tmp_path_factory.mktemp("runs")
    tall = wave(plane="xz", length=180.0, points=31)
    pair = {"left": wave(), "right": wave(shift=2.5)}
    write(folder / "tall.h5", {"fibre": tall}, TIMES, LONG)
    write(folder / "pair.h5", pair, TIMES, "Two waves")
    ten = {f"flagellum_{k}": wave(points=9, shift=2.0 * k) for k in range(10)}
    write(folder / "ten.h5", ten, TIMES)
    write(folder / "coil.h5", {"coil": coil(jolt=20.0)}, TIMES)
    names = ["cell.tail", "cell.other"]
    rows = [[2.0 + k, 5.0] for k in range(4)]
    write(
        folder / "hooks.h5", {"a": coil(), "b": wave()}, TIMES, "",
        [("hook_energy", (2,), ENERGY)], {"hook_energy": names}, {"hook_energy": np.array(rows)},
    )  # fmt: skip
    return folder


@pytest.fixture
def seen(monkeypatch):
    """Look at every figure that would be saved: nothing is wrong with it."""
    from matplotlib.figure import Figure

    figures = []

    def look(figure, path, **options):
        figures.append(figure)
        assert faults(figure) == []
        Path(path).touch()

    monkeypatch.setattr(Figure, "savefig", look)
    return figures


@pytest.fixture
def here(runs, here):
    """The runs, from an empty folder."""
    return runs


def words(figure):
    from matplotlib.text import Text

    return {text.get_text() for text in figure.findobj(Text) if text.get_visible()}


# Pages ------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "options"),
    [
        ("tall", ("--view", "xz", "-n", "4")),
        ("tall", ("--view", "xz", "--overlay", "--title", LONG)),
        ("tall", ("--view", "xz", "--size", "86x90", "-n", "4")),
        ("pair", ("--size", "86x60", "-n", "3")),
        ("pair", ("--size", "17.8x9cm", "--colour", "curvature", "-n", "3")),
        ("ten", ("--colour", "rod", "--size", "3.4x3in", "-n", "4")),
        ("coil", ("--colour", "twist", "--directors", "--size", "86x80", "-n", "2")),
        ("pair", ("-w", "curvature", "--size", "86x80")),
        ("hooks", ("-w", "energy", "--size", "86x60")),
        ("pair", ("-w", "speed,elastic_energy", "--size", "86x90")),
        ("coil", ("-w", "power", "--log")),
    ],
)
def test_nothing_is_cut_or_collapsed_or_over_something_else(name, options, here, seen, recwarn):
    said = told("plot", here / f"{name}.h5", "-o", "a.png", *options)
    assert said == "wrote a.png\n"  # nor a raw warning of matplotlib
    assert [str(w.message) for w in recwarn if "layout" in str(w.message)] == []
    (figure,) = seen
    if "--size" in options:
        size = {"86x60": (86, 60), "86x80": (86, 80), "86x90": (86, 90), "17.8x9cm": (178, 90),
                "3.4x3in": (86.36, 76.2)}[options[options.index("--size") + 1]]  # fmt: skip
        assert figure.get_size_inches() * 25.4 == pytest.approx(size)


@pytest.mark.parametrize(
    ("options", "words_said"),
    [
        (("--size", "30x20"), "--size 30x20: too small for what is on it: fewer --frames"),
        (("--size", "86"), "write width and height as 86x60 (mm), 8.6x6cm or 3.4x2.4in"),
        (("--size", "86x4"), "sides must be from 10 mm to 2 m"),
        (("-w", "twist"), "twist: the rods lie in a plane, where there is none"),
        (("--colour", "twist"), "twist: the rods lie in a plane, where there is none"),
        (("--range", "1", "2"), "--range is for colours of curvature or twist"),
        (("--turn", "90"), "--turn is for a movie"),
        (("--log",), "--log is for a quantity over time"),
        (("--radius", "2", "--style", "line"), "--radius is for tubes and ribbons"),
    ],
)
def test_what_has_no_room_or_no_meaning_is_refused(options, words_said, here, tmp_path):
    said = told("plot", here / "pair.h5", "-o", "a.png", *options, code=2)
    assert words_said in said
    assert list(tmp_path.iterdir()) == []


def test_size_and_dots_are_those_asked_for(here):
    from PIL import Image

    arguments = ("-o", "a.png", "-n", "2", "--size", "86x60", "--dpi", "150")
    told("plot", here / "coil.h5", *arguments)
    with Image.open("a.png") as picture:
        assert picture.size == (507, 354)  # 86/25.4*150, 60/25.4*150


def test_the_title_is_the_cases_or_the_one_asked_for(here, seen):
    for options in ((), ("--title", "Mine"), ("--title", "")):
        told("plot", here / "pair.h5", "-o", "a.png", "-n", "1", *options)
    titles = [words(figure) & {"Two waves", "Mine"} for figure in seen]
    assert titles == [{"Two waves"}, {"Mine"}, set()]


# Colours ----------------------------------------------------------------------------------------


def test_all_colours_of_rods_stand_out_from_paper():
    maps = [colours.sequential(), colours.signed()]
    shades = [shade for m in maps for shade in m(np.linspace(0.0, 1.0, 51))]
    shades += colours.of_rods([f"{k}" for k in range(7)]).values()
    shades += colours.of_rods([f"{k}" for k in range(20)]).values()
    assert min(map(colours.contrast_with_white, shades)) > 1.9
    assert colours.contrast_with_white((1.0, 1.0, 1.0)) == pytest.approx(1.0)
    assert colours.contrast_with_white((0.0, 0.0, 0.0)) == pytest.approx(21.0)  # WCAG 2
    grey = [shade[:3] @ np.array([0.299, 0.587, 0.114]) for shade in maps[0](np.linspace(0, 1, 11))]
    assert (np.diff(grey) > 0.0).all()  # time reads in grey too


def test_rods_are_told_apart_in_colour_and_in_grey():
    shades = [np.array(c[:3]) for c in colours.of_rods(["a", "b", "c"]).values()]
    for one, other in itertools.pairwise(shades):
        assert np.abs(one - other).max() > 0.4
        light, dark = sorted(map(colours.contrast_with_white, (one, other)))
        assert dark / light > 1.3


@pytest.mark.parametrize(
    ("name", "options", "expected"),
    [
        ("pair", ("-n", "1"), {"left", "right"}),
        ("pair", ("--overlay",), {"time (s)"}),
        ("pair", ("--overlay", "--colour", "rod"), {"left", "right"}),
        ("ten", ("-n", "1", "--colour", "rod"), {"flagellum_0", "…", "flagellum_9"}),
    ],
)
def test_a_key_says_what_colours_mean_where_that_is_not_said_already(
    name, options, expected, here, seen
):
    told("plot", here / f"{name}.h5", "-o", "a.png", *options)
    keys = {"left", "right", "time (s)", "flagellum_0", "…", "flagellum_9"}
    assert words(seen[0]) & keys == expected


def test_the_first_frame_sets_no_range_where_it_is_far_off(here):
    values = np.array([[40.0, 39.0], [1.0, 2.0], [1.5, 2.5]])
    scale = colours.scale_of([values], "twist", "um^-1")
    assert (scale.low, scale.high, scale.extend) == (0.0, 2.5, "max")
    near = colours.scale_of([values / (20.0, 1.0)], "twist", "um^-1")
    values[0] = (3.0, 2.6)
    assert colours.scale_of([values], "twist", "um^-1").high == 3.0
    assert near.high == 39.0 or near.extend == "max"
    asked = colours.scale_of([values], "twist", "um^-1", (1.2, 2.0))
    assert (asked.low, asked.high, asked.extend) == (1.2, 2.0, "both")


def test_signed_quantities_have_diverging_colours_with_zero_in_the_middle():
    values = np.array([[-0.7, 0.2], [-0.3, 1.4], [-0.6, 1.3]])
    scale = colours.scale_of([values], "twist", "um^-1")
    assert (scale.low, scale.high) == (-1.4, 1.4)
    blue, grey, red = scale([-1.4, 0.0, 1.4])
    assert np.ptp(grey[:3]) < 0.02
    assert blue[2] > blue[0]
    assert red[0] > red[2]
    noise = colours.scale_of([np.array([[-1e-9, 1.4], [0.2, 1.2]])], "curvature", "um^-1")
    assert (noise.low, noise.high) == (0.0, 1.4)


def test_range_and_jolt_reach_the_picture(here, seen):
    told("plot", here / "coil.h5", "-w", "twist", "-o", "a.png")
    told("plot", here / "coil.h5", "-w", "twist", "-o", "b.png", "--range", "-3", "1")
    told(
        "plot",
        here / "coil.h5",
        "-n",
        "1",
        "--colour",
        "twist",
        "-o",
        "c.png",
        "--range",
        "0.5",
        "1",
    )
    limits = [figure.axes[0].collections[0].get_clim() for figure in seen[:2]]
    assert limits[0][0] == 0.0
    assert (
        3.0 < limits[0][1] < 4.2
    )  # 6 rad per 1.6 to 1.9 um; the first frame has ten times as much
    assert limits[1] == (-3.0, 1.0)
    assert seen[2].axes[-1].get_ylim() == (0.5, 1.0)


# Tubes ------------------------------------------------------------------------------------------


def bare(points=9):
    """A straight rod along x of 8 um, D1 along z."""
    position = np.zeros((points, 3))
    position[:, 0] = np.linspace(0.0, 8.0, points)
    return position, np.tile(np.eye(3)[[2, 1, 0]] * [[1], [-1], [1]], (points, 1, 1))


def test_tubes_are_smooth_between_points_and_go_through_them():
    u = np.linspace(0.0, 1.5 * np.pi, 13)
    circle = np.stack([2.0 * np.cos(u), 2.0 * np.sin(u), 0 * u], axis=1)
    director = np.tile(np.eye(3), (13, 1, 1))
    fine, triads = surface.refined(circle, director, 8)
    assert fine[::8] == pytest.approx(circle)
    radius = np.linalg.norm(fine[8:-8], axis=1)  # 0.02 % of a cubic; a chord falls short by 1.9 %
    assert radius == pytest.approx(2.0, rel=1e-3)
    assert np.linalg.norm(triads, axis=-1) == pytest.approx(1.0)
    v = np.linspace(0.0, 2.0 * np.pi, 16, endpoint=False)
    ring = np.stack([2.0 * np.cos(v), 2.0 * np.sin(v), 0 * v], axis=1)
    round_, _ = surface.refined(ring, np.tile(np.eye(3), (16, 1, 1)), 6, closed=True)
    assert len(round_) == 96
    assert np.linalg.norm(round_, axis=1) == pytest.approx(2.0, rel=1e-3)  # also over the seam


def test_open_tubes_end_in_half_spheres():
    position, director = bare()
    places, triads, radii = surface.capped(position, director, 0.7)
    ends = np.array([0.0, 8.0])
    corners, _ = surface.tube(places, triads, radii)
    points = corners.reshape(-1, 3)
    assert points[:, 0].min() == pytest.approx(-0.7)
    assert points[:, 0].max() == pytest.approx(8.7)
    out = points[(points[:, 0] < 0.0) | (points[:, 0] > 8.0)]
    centre = ends[(out[:, 0] > 4.0).astype(int)]
    across = np.hypot(*out[:, 1:].T)
    assert np.hypot(out[:, 0] - centre, across) == pytest.approx(0.7)


@pytest.mark.parametrize("shade", [(0.1, 0.1, 0.3, 1.0), (0.36, 0.79, 0.38, 1.0)])
def test_the_stripe_is_white_on_every_colour(shade):
    """It once changed from white to black between panels."""
    from matplotlib.figure import Figure

    position, director = bare()
    director = director[:, [0, 1, 2]]
    entry = type("Rod", (), {"first": 0, "count": 9, "closed": False})
    camera = make_camera("xy", position)  # D1 points at the viewer
    axis = rod.draw_rods(Figure().add_subplot(), camera, [entry], position, director, 0.6, [shade])
    faces = axis.collections[0].get_facecolor()[:, :3]
    ratio = faces / faces.max(axis=1, keepdims=True)
    white = np.ptp(ratio, axis=1) < 1e-9
    assert 0.1 < white.mean() < 0.5
    assert np.allclose(ratio[~white], np.array(shade[:3]) / max(shade[:3]))


def test_the_back_of_a_ribbon_is_a_darker_shade_of_its_colour():
    from matplotlib.figure import Figure

    position, director = bare()
    turned = director * np.array([1.0, 1.0, 1.0])[:, None]
    turned[:, 0], turned[:, 1] = [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]
    entry = type("Rod", (), {"first": 0, "count": 9, "closed": False})
    shade, seen = (0.8, 0.4, 0.2, 1.0), []
    for sign in (1.0, -1.0):
        triads = turned * np.array([sign, sign, 1.0])[:, None]
        camera = make_camera("xy", position)
        axis = rod.draw_rods(
            Figure().add_subplot(), camera, [entry], position, triads, 0.6, [shade], "ribbon"
        )
        seen.append(axis.collections[0].get_facecolor()[0, :3])
    light, dark = sorted(seen, key=np.sum)[::-1]
    assert dark / light == pytest.approx(0.55)
    assert light / light.max() == pytest.approx(np.array(shade[:3]) / 0.8)


@pytest.mark.parametrize(
    ("options", "radius"), [((), 0.606530660 * EPSILON), (("--radius", "0.45"), 0.45)]
)
def test_tubes_are_as_thick_as_the_fluid_takes_them_for(options, radius, here, monkeypatch):
    """exp(-1/2) epsilon for algebraic7: Olson, Lim & Cortez's blob, as docs/method.md says."""
    from rodsim.plotting.shapes import Shapes

    sizes, draw = [], Shapes.draw
    monkeypatch.setattr(Shapes, "draw", lambda s, *a: sizes.append(s.size) or draw(s, *a))
    told("plot", here / "coil.h5", "-n", "1", "-o", "a.png", *options)
    assert sizes == [pytest.approx(2.0 * radius, rel=1e-8)]


# Legends, ticks, movies -------------------------------------------------------------------------


@pytest.mark.parametrize("options", [("-w", "energy"), ("-w", "speed"), ("-w", "radius")])
def test_legends_lie_on_no_curve(options, here, seen):
    told("plot", here / "hooks.h5", "-o", "a.png", *options)
    figure = seen[0]
    legends = [axis.get_legend() for axis in figure.axes if axis.get_legend()]
    assert legends or options[1] == "radius"
    for legend in legends:
        box = legend.get_window_extent()
        assert not any(box.overlaps(axis.get_window_extent()) for axis in figure.axes)


def test_powers_of_ten_stand_with_the_unit(here, seen):
    from matplotlib.figure import Figure

    axis = Figure(layout="constrained").add_subplot()
    axis.set_ylim(0.0, 3e-5)
    style.name_values(axis, "energy", "g um^2 s^-2")
    assert axis.get_ylabel() == "energy (10⁻⁵ g µm² s⁻²)"
    axis.figure.draw_without_rendering()
    assert [t.get_text() for t in axis.get_yticklabels()][:3] == ["0.0", "0.5", "1.0"]
    assert not axis.yaxis.offsetText.get_visible()


def test_hooks_have_curves_and_columns_of_their_own(here, seen):
    told("plot", here / "hooks.h5", "-w", "hook_energy", "-o", "a.png")
    assert {"cell.tail", "cell.other"} <= words(seen[0])
    command("energy", here / "hooks.h5", "--csv", "e.csv")
    heads, *rows = (line.split(",") for line in Path("e.csv").read_text().splitlines())
    columns = dict(zip(heads, np.array(rows, float).T, strict=True))
    unit = "(g um^2 s^-2)"
    assert columns[f"cell.tail.hook {unit}"].tolist() == [2.0, 3.0, 4.0, 5.0]
    assert columns[f"cell.other.hook {unit}"].tolist() == [5.0] * 4
    assert columns[f"hook {unit}"].tolist() == [7.0, 8.0, 9.0, 10.0]


def test_movies_have_a_key_1080_lines_and_turn(here, tmp_path):
    imageio_ffmpeg = pytest.importorskip("imageio_ffmpeg")
    told("plot", here / "coil.h5", "-o", "a.mp4", "-n", "2", "--turn", "90", "-q")
    reader = imageio_ffmpeg.read_frames("a.mp4")
    assert next(reader)["size"] == (1920, 1080)
    first, second = (np.frombuffer(f, np.uint8).reshape(1080, 1920, 3) for f in reader)
    assert (np.abs(first.astype(int) - second).max(axis=2) > 60).mean() > 0.01
    said = told("plot", here / "pair.h5", "-o", "b.gif", "--turn", "9", "--view", "yz", code=2)
    assert "a view straight at yz cannot turn" in said


def test_a_scene_that_turns_is_seen_from_all_sides_at_one_scale():
    points = np.random.default_rng(5).normal(size=(30, 3)) * (3.0, 1.0, 2.0)
    camera = make_camera("3d", points)
    turned = camera.turned(90.0)
    assert turned.matrix @ turned.matrix.T == pytest.approx(np.eye(3), abs=1e-14)
    assert camera.turned(360.0).matrix == pytest.approx(camera.matrix)
    up = np.eye(3)[2]  # the next longest extent is up, and stays so
    assert (camera.matrix @ up)[1] == pytest.approx((turned.matrix @ up)[1])
    assert abs((camera.matrix @ up)[0]) < 1e-12
    assert abs((turned.matrix @ up)[0]) < 1e-12


# Maps and lines of sweeps -----------------------------------------------------------------------


def test_axes_over_two_decades_are_logarithmic_and_cells_lie_about_their_values():
    from matplotlib.figure import Figure

    from rodsim.plotting.columns import draw_columns, draw_map

    x, y = [0.1, 1.0, 10.0], [2.0, 3.0]
    z = [[1.0, 2.0, float("nan")], [4.0, 5.0, 6.0]]
    figure = Figure(figsize=(3.4, 2.6), layout="constrained")
    axis = draw_map(figure.add_subplot(), x, y, z, ("b (µm)", "n"), ("speed", "um s^-1"))
    assert faults(figure) == []
    assert (axis.get_xscale(), axis.get_yscale()) == ("log", "linear")
    mesh = axis.collections[0]
    edges = np.asarray(mesh.get_coordinates())
    assert edges[0, :, 0] == pytest.approx(10.0 ** np.array([-1.5, -0.5, 0.5, 1.5]))
    assert edges[:, 0, 1] == pytest.approx([1.5, 2.5, 3.5])
    assert mesh.get_array().mask.ravel().tolist() == [False, False, True, False, False, False]
    assert "speed (µm s⁻¹)" in words(figure)
    figure = Figure(figsize=(3.4, 3.0), layout="constrained")
    groups = ["b = 0.5 µm"] * 3 + ["b = 1 µm"] * 3
    axis = draw_columns(figure.add_subplot(), x * 2, [5.0, 6, 7, 8, 9, 10], groups, ("x", "y"))
    assert (axis.get_xscale(), axis.get_yscale()) == ("log", "linear")
    assert faults(figure) == []
    even = draw_map(
        Figure().add_subplot(), [100, 200, 400], [0.2, 0.4, 0.6], np.eye(3), ("x", "y"), ("z", "")
    )
    assert (even.get_xscale(), even.get_yscale()) == ("log", "linear")  # by one ratio; by one step
    other = draw_columns(Figure().add_subplot(), x, [5.0, 6, 7], [""] * 3, ("x", "y"), "y")
    assert (other.get_xscale(), other.get_yscale()) == ("linear", "log")


def test_keys_of_a_map_are_two_that_are_numbers_and_no_other_changes():
    from types import SimpleNamespace

    from rodsim.errors import UsageError
    from rodsim.sweep.series import axis_label, check_grid, grid, short_key

    def summary(*values, rows=()):
        runs = [SimpleNamespace(values=v) for v in values]
        units = dict.fromkeys(("parameters.b", "rods.a.strain_twist.2", "k"), "um")
        return SimpleNamespace(
            plan=SimpleNamespace(runs=runs, key_units=units), rows=dict(enumerate(rows)),
            unit=lambda column: {"speed": "um s^-1"}.get(column, "um"),
        )  # fmt: skip

    four = [{"b": b, "k": k} for k in (3, 2) for b in (0.5, 0.25)]
    rows = [four[0] | {"speed": 7.0}, four[3] | {"speed": 9.0}, four[1]]
    check_grid(summary(*four), "b", "k")
    across, up, values = grid(summary(*four, rows=rows), "b", "k", "speed")
    assert (across, up) == ([0.25, 0.5], [2, 3])
    assert np.array_equal(values, [[9.0, np.nan], [np.nan, 7.0]], equal_nan=True)
    for bad, words_said in (
        ((four, "b", "b"), "two keys"),
        ((four, "b", "speed"), "two keys of the sweep that are numbers"),
        (([v | {"k": "pi"} for v in four], "b", "k"), "that are numbers"),
        (([*four, four[0]], "b", "k"), "other keys change"),
        ((four[:2], "b", "k"), "needs two values of each"),
    ):
        with pytest.raises(UsageError, match=words_said):
            check_grid(summary(*bad[0]), *bad[1:])
    assert short_key("rods.a.strain_twist.2") == "strain_twist.2"
    assert axis_label(summary(), "rods.a.strain_twist.2") == "strain_twist.2 (µm)"
    assert axis_label(summary(), "speed") == "speed (µm s⁻¹)"


def test_stream_lines_stop_where_they_would_wind_up():
    """Around the centre of a spiral, and nowhere else."""
    from rodsim.plotting.flow import knots

    x = np.linspace(-2.0, 2.0, 61)
    right, up = np.meshgrid(x, x)
    knot = knots(-up - 0.3 * right, right - 0.3 * up)
    distance = np.hypot(right, up)
    assert knot[distance < 0.05].all()
    assert not knot[distance > 0.3].any()
    assert not knots(1.0 + 0.3 * up, 0.2 * right).any()

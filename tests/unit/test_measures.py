"""The quantities of ``rodsim measure``: formulas on known curves, and names on a written file."""

import re

import numpy as np
import outputs
import pytest
from calls import command
from scenes import ROOT

import rodsim.analysis
from rodsim.analysis.measures import MEASURES, mean
from rodsim.analysis.measuring import available, of_run, over_time, pick
from rodsim.errors import FileError, UsageError
from rodsim.output import open_trajectory
from rodsim.scene.shapes import rotation_matrix

TURN = rotation_matrix((0.3, -0.8, 0.5), 1.1)
TIME = np.array([0.0, 0.3, 0.4, 0.9, 1.3])  # uneven


def helix(turns=3.0, radius=0.7, pitch=-0.4, points=181):
    """A left-handed helix, turned and moved."""
    t = np.linspace(0.2, 0.2 + 2 * np.pi * turns, points)
    X = np.array([radius * np.cos(t), radius * np.sin(t), pitch * t / (2 * np.pi)]).T
    return X @ TURN.T + [3.0, -5.0, 0.4]


# Formulas ---------------------------------------------------------------------------------------


def test_lengths_of_known_curves():
    X = np.array([[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [3.0, 4.0, 0.0]]) * 1.3 + 0.7
    assert rodsim.analysis.length(X) == pytest.approx(1.3 * 7, rel=1e-14)
    assert rodsim.analysis.length(X, closed=True) == pytest.approx(1.3 * 12, rel=1e-14)
    assert rodsim.analysis.end_to_end(X) == pytest.approx(1.3 * 5, rel=1e-14)


def test_amplitude_of_a_wave_a_helix_and_a_line():
    z = np.linspace(0.0, 6.0, 601)
    for phase, off in ((np.pi / 2, 0.0), (0.0, 12 / (2 * np.pi * 3) ** 2)):
        wave = np.array([0 * z, 0.3 * np.sin(2 * np.pi * z / 2 + phase), z]).T @ TURN.T + 9.0
        # The long axis takes the part of sin(k z) that is linear in z, 24/(k L)^2 of its square.
        assert rodsim.analysis.amplitude(wave) == pytest.approx(0.3 * (1 - off), rel=3e-3)
    assert rodsim.analysis.amplitude(helix(turns=20, pitch=-0.9)) == pytest.approx(0.7, rel=0.01)
    ring = helix(turns=1, pitch=0.0, points=41)[:-1]
    assert rodsim.analysis.amplitude(ring) == pytest.approx(0.7, rel=1e-12)
    assert rodsim.analysis.amplitude(np.outer(z, TURN[0])) == pytest.approx(0.0, abs=1e-12)


def test_the_helix_is_that_of_the_fit():
    X = helix()
    assert rodsim.analysis.radius(X) == pytest.approx(0.7, rel=1e-9)
    assert rodsim.analysis.pitch(X) == pytest.approx(-0.4, rel=1e-9)
    assert rodsim.analysis.turns(X) == pytest.approx(3.0, rel=1e-9)


@pytest.mark.parametrize("points", [3, 4, 50])
def test_a_straight_rod_is_no_helix(points):
    line = np.outer(np.linspace(0, 3.1, points), [0.48, 0.6, 0.64]) + 0.3
    assert np.isnan(rodsim.analysis.radius(line))
    assert np.isnan([rodsim.analysis.pitch(line), rodsim.analysis.turns(line)]).all()


def test_velocity_is_exact_for_a_parabola_at_uneven_times():
    place = np.array([[0.2, -0.3, 0.4]]) * TIME[:, None] ** 2 + np.array([1.5, 0.0, -2.0])
    X = place[:, None] + np.array([[[0.0, 0.0, 0.7], [0.0, 0.0, -0.7]]])
    exact = np.outer(2 * TIME, [0.2, -0.3, 0.4])
    np.testing.assert_allclose(rodsim.analysis.velocity(TIME, X), exact, atol=1e-14)
    fast = np.linalg.norm(exact, axis=1)
    np.testing.assert_allclose(rodsim.analysis.speed(TIME, X), fast, atol=1e-14)
    assert np.isnan(rodsim.analysis.speed(TIME[:1], X[:1])).all()
    two = rodsim.analysis.velocity(TIME[:2], X[:2])
    np.testing.assert_allclose(two, np.diff(place[:2], axis=0).repeat(2, 0) / 0.3, rtol=1e-12)


def test_the_mean_is_that_of_a_line_and_leaves_out_the_start():
    values = 2.0 + 3.0 * TIME
    assert mean(TIME[1:], values[1:]) == pytest.approx(2.0 + 3.0 * 0.8, rel=1e-14)
    values[0] = 1e6
    assert mean(TIME, values) == pytest.approx(2.0 + 3.0 * 0.8, rel=1e-14)
    assert mean(TIME[:1], values[:1]) == 1e6


def test_efficiency_by_hand():
    drag = rodsim.analysis.towing_drag(20.0, 0.3, 1.7e-6)
    e = 1 / np.log(20.0 / 0.3)
    exact = 2 * np.pi * 1.7e-6 * 20 * (e * (1 + 0.307 * e) / (1 - 0.5 * e) + 0.426 * e**3)
    assert drag == pytest.approx(exact, rel=1e-14)
    found = rodsim.analysis.efficiency(np.array([3.0, 5.0]), 0.02, 20.0, 0.3, 1.7e-6)
    np.testing.assert_allclose(found, drag * np.array([9.0, 25.0]) / 0.02, rtol=1e-14)
    assert np.isnan(rodsim.analysis.towing_drag(0.5, 0.3, 1.7e-6))


# Names ------------------------------------------------------------------------------------------


def test_every_quantity_has_a_line_in_the_docs_and_a_function():
    page = (ROOT / "docs" / "measure.md").read_text(encoding="utf-8")
    table = "\n".join(line for line in page.splitlines() if line.startswith("| `"))
    assert set(re.findall(r"`(\w+)`", table)) == set(MEASURES)
    assert set(MEASURES) <= set(dir(rodsim.analysis))
    for name, measure in MEASURES.items():
        assert callable(getattr(rodsim.analysis, name))
        assert measure.about


def test_there_is_no_other_function():
    with pytest.raises(AttributeError, match="no attribute 'writh'"):
        rodsim.analysis.writh  # noqa: B018


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    """A file of six frames with random numbers: zeta, open, 4 points; alpha, closed, 5 points."""
    path = tmp_path_factory.mktemp("written") / "out.h5"
    with outputs.create(path) as writer:
        outputs.write(writer, range(6))
        writer.finish("finished", {})
    return path


@pytest.fixture
def run(path):
    with open_trajectory(path) as run:
        yield run


def test_a_name_is_of_every_rod_that_has_it(run):
    table = over_time(run, pick(run, ["radius_of_gyration", "end_to_end", "link", "net_force"]))
    assert [column.name for column in table.columns] == [
        "zeta.radius_of_gyration", "alpha.radius_of_gyration", "zeta.end_to_end", "alpha.link",
        "net_force_x", "net_force_y", "net_force_z",
    ]  # fmt: skip
    assert [column.unit for column in table.columns][2:5] == ["um", "1", "g um s^-2"]
    X = run.position
    np.testing.assert_array_equal(table.time, outputs.TIMES)
    ends = np.linalg.norm(X[:, 3] - X[:, 0], axis=1)
    np.testing.assert_allclose(table.values[:, 2], ends, rtol=1e-14)
    spread = X[:, 4:] - X[:, 4:].mean(axis=1, keepdims=True)
    gyration = np.sqrt((spread**2).sum(axis=2).mean(axis=1))
    np.testing.assert_allclose(table.values[:, 1], gyration, rtol=1e-14)
    np.testing.assert_array_equal(table.values[:, 4:], run.observable("net_force"))


def test_every_nth_frame_has_the_speeds_of_all_frames(run):
    both = [pick(run, ["alpha.speed", "power"]), pick(run, ["power"])]
    table = over_time(run, both[0])
    few = over_time(run, both[0], every=2)
    np.testing.assert_array_equal(few.values, table.values[::2])
    np.testing.assert_array_equal(few.time, outputs.TIMES[::2])
    np.testing.assert_array_equal(over_time(run, both[1], every=4).time, outputs.TIMES[::4])
    exact = rodsim.analysis.speed(run.time, run.position[:, 4:])
    np.testing.assert_allclose(table.values[:, 0], exact, rtol=1e-13)


def test_one_number_of_a_run(run):
    found = of_run(run, pick(run, ["velocity", "power", "alpha.writhe", "elastic_energy"]))
    centroid = run.position[:, :4].mean(axis=1)
    slope = np.polyfit(run.time, centroid[:, 1], 1)[0]
    assert found["zeta.velocity_y"] == pytest.approx(slope, rel=1e-12)
    power = run.observable("power")[1:, 1]
    exact = np.sum(0.5 * (power[1:] + power[:-1]) * np.diff(run.time[1:])) / np.ptp(run.time[1:])
    assert found["alpha.power"] == pytest.approx(exact, rel=1e-12)
    last = rodsim.analysis.writhe(run.position[-1, 4:])
    assert found["alpha.writhe"] == pytest.approx(last, rel=1e-14)
    parts = [run.observable(f"{part}_energy", -1)[0] for part in
             ("bending", "twisting", "shear", "stretch")]  # fmt: skip
    assert found["zeta.elastic_energy"] == pytest.approx(sum(parts), rel=1e-14)


def test_numbers_over_whole_periods(run):
    """Frames at 0, 0.3, 0.6, 0.9, 1.1, 1.7: from 0.3 on, 1.2 is the last of whole periods."""
    found = of_run(run, pick(run, ["zeta.power"]), period=0.3)
    power, time = run.observable("power")[1:, 0], run.time[1:]
    exact = np.sum(0.5 * (power[1:] + power[:-1]) * np.diff(time)) / (time[-1] - time[0])
    short = of_run(run, pick(run, ["zeta.power"]), period=0.31)
    assert set(found) == set(short) == {"zeta.power"}
    assert found["zeta.power"] != short["zeta.power"]
    with pytest.raises(UsageError, match="needs 2 periods"):
        of_run(run, pick(run, ["zeta.power"]), period=0.9)
    assert np.isfinite(exact)


@pytest.mark.parametrize(
    ("names", "rods", "error", "words"),
    [
        (["writh"], (), UsageError, "no quantity 'writh': did you mean 'writhe'"),
        (["qqqq"], (), UsageError, "there is speed, velocity"),
        (["beta.writhe"], (), UsageError, "no rod 'beta'"),
        (["writhe"], ["alfa"], UsageError, "no rod 'alfa': did you mean 'alpha'"),
        (["alpha.end_to_end"], (), UsageError, "end_to_end is of open rods, which alpha is not"),
        (["zeta.link"], (), UsageError, "link is of closed rods, which zeta is not"),
        (["gap"], (), FileError, "out.h5: no gap: the file has no gap"),
        (["no.py:f"], (), UsageError, "no.py: no such file"),
    ],
)
def test_what_cannot_be_measured_is_said(run, names, rods, error, words):
    with pytest.raises(error, match=re.escape(words)):
        pick(run, names, rods)


def test_what_a_file_lacks_is_not_listed(run):
    names = [m.name for m in available(run)]
    assert "gap" not in names
    assert {"writhe", "link", "end_to_end", "kinetic_energy"} <= set(names)


def test_the_command_lists_and_tabulates(path, tmp_path):
    listed = command("measure", path).stdout
    assert re.search(r"^ +end_to_end +um +distance of the ends.*\(open rods\)$", listed, re.M)
    assert listed.index("of each rod:") < listed.index("of the whole scene:")
    table = tmp_path / "t.csv"
    done = command("measure", path, "writhe", "--rod", "alpha", "--every", 5, "--csv", table)
    lines = done.stdout.splitlines()
    assert lines[0].split() == ["time", "alpha.writhe"]
    assert lines[1].split() == ["s"]
    assert len(lines) == 4
    assert done.stderr == f"wrote {table}\n"
    rows = table.read_text().splitlines()
    assert rows[0] == "time (s),alpha.writhe"
    assert float(rows[2].split(",")[1]) == pytest.approx(float(lines[3].split()[1]), rel=1e-6)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--csv", "a.csv"], "name what to measure"),
        (["writhe", "--csv", "a.txt"], "must end in one of .csv"),
        (["writhe", "--plot", "a.mp4"], "must end in one of .png"),
        (["writhe", "--period", "0.3", "--csv", "a.csv"], "--period gives single numbers"),
        (["power", "--period", "0.3*q"], "--period 0.3*q: "),
        (["power", "--period", "-2"], "is -2: must be > 0"),
    ],
)
def test_options_that_cannot_be_are_refused(path, arguments, words):
    assert words in command("measure", path, *arguments, code=2).stderr


OWN = '''
"""Mine."""
def height(rod):
    """highest point
    of all"""
    return rod.position[:, 2].max()
height.unit = "um"

def everything(frame):
    return frame.observable("net_force")[1] + len(frame.position)
everything.per = "scene"

def broken(rod):
    return rod.position[99]

def wrong(rod):
    return rod.observable("net_force")

def odd(rod):
    return 1
odd.per = "moon"
'''


def test_quantities_of_ones_own(path, tmp_path, monkeypatch, run):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "my.py").write_text(OWN)
    (tmp_path / "bad.py").write_text("import nothing_of_that_name")
    table = over_time(run, pick(run, ["my.py:height", "my.py:everything"]))
    assert [c.name for c in table.columns] == ["zeta.height", "alpha.height", "everything"]
    assert [c.unit for c in table.columns] == ["um", "um", ""]
    np.testing.assert_array_equal(table.values[:, 1], run.position[:, 4:, 2].max(axis=1))
    np.testing.assert_array_equal(table.values[:, 2], run.observable("net_force")[:, 1] + 9)
    shown = command(
        "measure", path, "--measure", "my.py:height", "--rod", "zeta", "--every", 5
    ).stdout
    assert shown.split()[:3] == ["time", "zeta.height", "s"]
    for text, words in {
        "my.py:heigth": "my.py has no function 'heigth': did you mean 'height'",
        "my.py:odd": "its 'per' is 'moon': must be one of scene, rod",
        "my.py:broken": "my.py:broken: failed at t = 0 of rod 'zeta': IndexError",
        "my.py:wrong": "UsageError: net_force is not of one rod; these are: bending_energy",
        "bad.py:f": "bad.py: cannot be loaded: ModuleNotFoundError",
    }.items():
        assert words in command("measure", path, text, code=2).stderr

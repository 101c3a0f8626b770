"""A stored run as Python sees it: rods by name, arrays read once, measures, tables, after close."""

import re

import numpy as np
import outputs
import pytest

import rodsim
from rodsim.errors import UsageError
from rodsim.forces.strain import strain_twist
from rodsim.output import reader


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
    with rodsim.open_trajectory(path) as run:
        yield run


def test_it_says_what_is_in_it(run):
    text = repr(run)
    assert text.startswith(f"<Trajectory {run.path}: finished, 6 of 6 frames, t = 0 to 1.7 s\n  éc")
    assert "\n  alpha: 5 points, closed, length 2.5 um\n" in text
    assert "\n  fields: position, director, velocity" in text
    assert repr(run["zeta"]) == (
        "<RodTrajectory zeta: 4 points, open, length 0.75 um, 6 frames>"
    )  # fmt: skip


def test_one_rod_has_its_own_points_and_numbers(run, path):
    assert list(run) == ["zeta", "alpha"]
    assert "alpha" in run
    assert "beta" not in run
    rod = run["alpha"]
    assert (rod.name, rod.closed, rod.points, rod.spacing, rod.length) == (
        "alpha",
        True,
        5,
        0.5,
        2.5,
    )
    np.testing.assert_allclose(rod.s, [0.0, 0.5, 1.0, 1.5, 2.0])
    with reader.open_trajectory(path) as plain:
        position, director = plain.position[:, 4:], plain.director[:, 4:]
        np.testing.assert_array_equal(rod.position, position)
        np.testing.assert_array_equal(rod.director, director)
        np.testing.assert_array_equal(rod.read("force"), plain.read("force")[:, 4:])
        np.testing.assert_array_equal(rod.observable("power"), plain.observable("power")[:, 1])
    twist = strain_twist(director, 0.5, True)
    np.testing.assert_array_equal(rod.strain, twist)
    assert rod.strain.shape == (6, 5, 3)
    assert run["zeta"].strain.shape == (6, 3, 3)


@pytest.mark.parametrize(
    ("ask", "words"),
    [
        (lambda run: run["alfa"], "no rod 'alfa': did you mean 'alpha'?"),
        (lambda run: run["q"], "no rod 'q': there is zeta, alpha"),
        (lambda run: run["zeta"].observable("net_force"), "net_force is not of one rod"),
        (lambda run: run["zeta"].read("tracers"), "tracers belong to no rod"),
        (lambda run: run["zeta"].measure("alpha.speed"), "alpha.speed is not of the rod zeta"),
        (lambda run: run["zeta"].measure("net_force"), "net_force is not of the rod zeta"),
        (lambda run: run["zeta"].measure("link"), "link is of closed rods, which zeta is not"),
        (lambda run: run.measure("sped"), "did you mean 'speed'"),
    ],
)
def test_names_that_there_are_not(run, ask, words):
    with pytest.raises(UsageError, match=re.escape(words)):
        ask(run)


def test_a_rod_that_there_is_not_is_a_key_error(run):
    with pytest.raises(KeyError) as caught:
        run["alfa"]
    assert str(caught.value).endswith("did you mean 'alpha'?")


def test_arrays_are_read_once_and_kept(run, monkeypatch):
    reads = []
    inner = reader.Trajectory._rows
    monkeypatch.setattr(reader.Trajectory, "_rows",
                        lambda *a, **more: reads.append(a[1]) or inner(*a, **more))  # fmt: skip
    for _ in range(3):
        whole, last = run.position, run.read("position", -1)
        run["zeta"].position, run.observable("power"), run.observable("power", 2)
    assert run.position is whole
    assert len(reads) == 2
    np.testing.assert_array_equal(last, whole[5])
    np.testing.assert_array_equal(run.read("position", slice(4, 0, -2)), whole[[4, 2]])
    np.testing.assert_array_equal(run.read("position", np.int64(3)), whole[3])
    for frame in (6, -7):
        with pytest.raises(IndexError):
            run.read("position", frame)


def test_what_is_kept_cannot_be_spoilt(run):
    with pytest.raises(ValueError, match="read-only"):
        run.position[0] = 0.0
    with pytest.raises(ValueError, match="read-only"):
        run["zeta"].position[0] -= 1.0
    run.position.copy()[0] = 0.0
    one = run.read("director", 2)
    one[0] = 0.0  # of one frame, not kept
    assert run.read("director", 2)[0].any()


def test_measures_have_a_column_for_each_rod(run):
    X = run.position
    speed = run.measure("speed")
    for rod, nodes in enumerate((slice(0, 4), slice(4, 9))):
        exact = rodsim.analysis.speed(run.time, X[:, nodes])
        np.testing.assert_allclose(speed[:, rod], exact, rtol=1e-13)
    np.testing.assert_array_equal(run["alpha"].measure("speed"), speed[:, 1])
    np.testing.assert_array_equal(run.measure("alpha.speed"), speed[:, 1])
    link = run.measure("link")
    assert link.shape == (6, 2)
    assert np.isnan(link[:, 0]).all()  # zeta is open
    assert np.isfinite(link[:, 1]).all()
    assert run.measure("velocity").shape == (6, 2, 3)
    assert run["zeta"].measure("velocity").shape == (6, 3)
    np.testing.assert_allclose(np.linalg.norm(run.measure("velocity"), axis=2), speed, rtol=1e-13)
    np.testing.assert_array_equal(run.measure("net_force"), run.observable("net_force"))
    np.testing.assert_array_equal(rodsim.analysis.power(run), run.observable("power"))
    np.testing.assert_array_equal(rodsim.analysis.power(run["zeta"]), run.observable("power")[:, 0])
    np.testing.assert_array_equal(rodsim.analysis.measure(run, "power", "alpha"),
                                  run.observable("power")[:, 1])  # fmt: skip


def test_after_close_what_was_read_stays_and_the_rest_is_said(path):
    run = rodsim.open_trajectory(path)
    kept = run.position
    rod = run["zeta"]
    run.close()
    run.close()
    assert run.position is kept
    assert rod.position.shape == (6, 4, 3)
    assert repr(run).endswith("\n  closed>")
    for ask in (lambda: run.director, lambda: rod.director, lambda: run.observable("power"),
                lambda: run.read("force", 2), lambda: run.fields, lambda: run.measure("speed"),
                lambda: run.unit("power"), run.checkpoint):  # fmt: skip
        with pytest.raises(UsageError, match=r"out\.h5: is closed, and this was not read before"):
            ask()


def test_as_an_xarray(run):
    pytest.importorskip("xarray")
    data = run.to_xarray(["speed", "alpha.velocity", "zeta.end_to_end", "net_force"])
    assert data.position.dims == ("time", "point", "axis")
    np.testing.assert_array_equal(data.position, run.position)
    own = data.director.where(data.rod_of_point == "alpha", drop=True).sel(triad="D3", axis="y")
    np.testing.assert_array_equal(own, run["alpha"].director[:, :, 2, 1])
    np.testing.assert_array_equal(data.power.sel(rod="alpha"), run.observable("power")[:, 1])
    np.testing.assert_array_equal(data.speed.sel(rod="zeta"), run["zeta"].measure("speed"))
    assert data["alpha.velocity"].dims == ("time", "axis")
    assert data["zeta.end_to_end"].dims == ("time",)
    assert data.net_force.dims == ("time", "axis")
    assert data.tracers.dims == ("time", "tracer", "axis")
    assert (data.power.units, data.time.units, data.speed.units) == (
        "g um^2 s^-3", "s", "um s^-1"
    )  # fmt: skip
    np.testing.assert_allclose(data.s, [0, 0.25, 0.5, 0.75, 0, 0.5, 1, 1.5, 2])
    assert data.attrs["title"] == "écoute"


def test_as_a_dataframe(run):
    pytest.importorskip("pandas")
    frame = run.to_dataframe(["alpha.speed"])
    assert frame.index.name == "time"
    np.testing.assert_array_equal(frame.index, run.time)
    np.testing.assert_array_equal(frame["alpha.power"], run.observable("power")[:, 1])
    np.testing.assert_array_equal(frame["net_torque_z"], run.observable("net_torque")[:, 2])
    np.testing.assert_array_equal(frame["alpha.speed"], run["alpha"].measure("speed"))
    assert frame.attrs["units"]["alpha.speed"] == "um s^-1"
    # Two rods: five energies, power, length each; two balances of three; one speed.
    assert frame.shape == (6, 2 * 7 + 2 * 3 + 1)


def test_without_xarray_it_says_how_to_get_it(run, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "xarray", None)
    with pytest.raises(UsageError, match=r"needs xarray: pip install 'rodsim\[table\]'"):
        run.to_xarray()

"""Quantities of real runs: the command, a sweep's columns, pictures of several runs, the end."""

import csv
import re

import numpy as np
import pytest
from calls import command
from scenes import CONFIGS

from rodsim import load_case, open_trajectory, resume, simulate
from rodsim.analysis import measuring
from rodsim.analysis.curve import length
from rodsim.analysis.swimming import swimming_velocity, towing_drag
from rodsim.errors import UsageError
from rodsim.flows.velocity import velocity
from rodsim.scene.restore import restore_scene
from rodsim.sweep.plan import Plan, Run
from rodsim.sweep.summary import Summary

pytestmark = pytest.mark.compiled
FLAGELLA = (
    "rods.left.shape.points=31", "parameters.d=3", "parameters.b=0.4", "fluid.epsilon=0.5",
    "time.end=2.3*period", "output.interval=period/12",
)  # fmt: skip
PERIOD = 2 * np.pi / 400


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Two flagella in opposite phase, ``anti.h5``, and in phase, ``phase.h5``."""
    folder = tmp_path_factory.mktemp("measured")
    for name, phi in (("anti", "pi"), ("phase", "0")):
        settings = [*FLAGELLA, f"rods.right.parameters.phi={phi}"]
        simulate(load_case(CONFIGS / "two_flagella.yaml", settings), folder / f"{name}.h5")
    return folder


@pytest.fixture
def here(folder, here):
    """The two, from an empty folder."""
    return folder


def numbers(text):
    """Return the numbers that ``--period`` prints, by name."""
    return {line.split()[0]: float(line.split()[1]) for line in text.splitlines()}


def test_speed_and_power_of_each_of_two_swimmers(here):
    names = ("speed", "power", "efficiency")
    found = numbers(command("measure", here / "anti.h5", *names, "--period", "period").stdout)
    with open_trajectory(here / "anti.h5") as run:
        for rod in run.rods:
            swim = swimming_velocity(run.time, run.position[:, rod.nodes], PERIOD)
            assert found[f"{rod.name}.speed"] == pytest.approx(np.linalg.norm(swim), rel=1e-6)
        scene = restore_scene(run)
    radius = scene.epsilon * np.exp(-0.5)
    drag = towing_drag(run.rods[0].length, radius, scene.viscosity)
    exact = drag * found["left.speed"] ** 2 / found["left.power"]
    assert found["left.efficiency"] == pytest.approx(exact, rel=1e-5)
    # Mirror images of each other swim alike; in phase they are slower and need less.
    assert found["left.speed"] == pytest.approx(found["right.speed"], rel=1e-3)
    phase = numbers(command("measure", here / "phase.h5", *names, "--period", "period").stdout)
    assert phase["left.speed"] < 0.8 * found["left.speed"]
    assert phase["left.power"] < 0.95 * found["left.power"]


def test_the_length_is_the_one_that_the_run_has_stored(here):
    with open_trajectory(here / "anti.h5") as run:
        rod = run.rods[1]
        ours = [length(X[rod.nodes]) for X in run.position]
        np.testing.assert_allclose(ours, run.observable("length")[:, 1], rtol=1e-14)


def test_towing_drag_is_that_of_the_sums_but_for_the_ends():
    """M f = 1 for points on a line: the force that tows them along it, at L/a = 41 and 82."""
    for points, beyond in ((101, 0.06), (201, 0.045)):
        spacing = 20.0 / (points - 1)
        X = np.outer(np.arange(points), [0.0, 0.0, spacing])
        force = np.zeros((points, 3))
        force[0, 2] = 1.0  # the matrix is that of one column: only distances count
        u, _ = velocity(X, X, force, np.zeros_like(X), epsilon=4 * spacing, viscosity=1.3e-3)
        gap = abs(np.subtract.outer(np.arange(points), np.arange(points)))
        total = np.linalg.solve(u[gap, 2], np.ones(points)).sum()
        drag = towing_drag(20.0, 4 * spacing * np.exp(-0.5), 1.3e-3)
        assert 0.0 < total / drag - 1.0 < beyond


# In a sweep -------------------------------------------------------------------------------------


def summary_of(paths, folder, **options):
    """Return the summary of a sweep whose runs are these outputs."""
    runs = []
    for path in paths:
        with open_trajectory(path) as output:
            run = Run(folder / path.stem, {"n": len(runs)}, output.case_data(), {})
        run.folder.mkdir()
        run.output.write_bytes(path.read_bytes())
        runs.append(run)
    return Summary(Plan(runs, {"n": ""}), **options)


def test_a_sweep_has_the_same_numbers_in_its_columns(here, tmp_path):
    paths = [here / "phase.h5", here / "anti.h5"]
    names = ("speed", "right.power", "velocity", "gap", "link", "elastic_energy")
    summary = summary_of(paths, tmp_path, period="period", measures=names)
    summary.write(tmp_path / "summary.csv")
    with open(tmp_path / "summary.csv", newline="") as stream:
        rows = list(csv.DictReader(stream))
    own = ["speed", "right.power", "velocity", "gap", "elastic_energy"]
    for row, path in zip(rows, paths, strict=True):
        found = numbers(command("measure", path, *own, "--period", "period").stdout)
        assert len(found) == 2 + 1 + 6 + 1 + 2
        for name, value in found.items():
            head = next(head for head in row if head.partition(" (")[0] == name)
            assert float(row[head]) == pytest.approx(value, rel=1e-6)
        assert row["left.link"] == ""  # of closed rods
    assert "right.power (g um^2 s^-3)" in rows[0]
    assert summary.column("elastic_energy") == "elastic_energy"  # the sweep's own
    assert summary.column("power") == "right.power"
    with pytest.raises(UsageError, match=r"column link: say which, left\.link or right\.link"):
        summary.column("link")


def test_a_sweep_over_rods_that_come_and_go(here, tmp_path):
    """A rod that only some runs have, and a run that ends within its second period."""
    alone, short = tmp_path / "alone.h5", tmp_path / "short.h5"
    for path, *more in ((alone, "rods.right=null"), (short, "time.end=1.5*period")):
        simulate(load_case(CONFIGS / "two_flagella.yaml", [*FLAGELLA, *more]), path)
    measures = ("speed", "end_to_end")
    summary = summary_of([alone, short], tmp_path, period="period", measures=measures)
    first, second = summary.rows.values()
    assert "right.speed" in summary.columns
    assert {"left.speed", "left.end_to_end"} == {k for k in first if "." in k}
    assert {"left.end_to_end", "right.end_to_end"} == {k for k in second if "." in k}


def test_what_is_no_number_is_an_empty_cell(here, tmp_path):
    (tmp_path / "my.py").write_text("def none(rod):\n    return float('nan')\n")
    summary = summary_of([here / "anti.h5"], tmp_path, measures=("my.py:none", "amplitude"))
    row = next(iter(summary.rows.values()))
    assert "left.none" in summary.columns
    assert {"left.amplitude", "right.amplitude"} == {key for key in row if "." in key}


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("writh", "no quantity 'writh': did you mean 'writhe'"),
        ("lft.speed", "--measure lft.speed: no rod 'lft': did you mean 'left'"),
        ("no.py:f", "no.py: no such file"),
    ],
)
def test_a_wrong_name_shows_before_the_runs(here, name, words):
    done = command("sweep", CONFIGS / "two_flagella.yaml", "--set", "parameters.d=[2, 3]",
                "--measure", f"gap,{name}", "--list", code=2)  # fmt: skip
    assert words in done.stderr


def test_a_function_that_fails_does_not_stop_a_sweep(here, tmp_path):
    (tmp_path / "my.py").write_text("def third(rod):\n    return rod.position[3**9]\n")
    summary = summary_of([here / "anti.h5"], tmp_path, measures=("my.py:third",))
    row = next(iter(summary.rows.values()))
    assert row["message"].startswith("my.py:third: failed at t = 0.0361")
    assert row["status"] == "finished"


# Pictures ---------------------------------------------------------------------------------------


@pytest.fixture
def figures(monkeypatch):
    """Every figure that is saved, all of which lies inside it."""
    pytest.importorskip("matplotlib")
    from matplotlib.figure import Figure

    save, seen = Figure.savefig, []

    def look_and_save(figure, *arguments, **options):
        figure.draw_without_rendering()
        low, high = figure.get_tightbbox().get_points()
        assert (low > -0.01).all()
        assert (high < figure.get_size_inches() + 0.01).all()
        seen.append(figure)
        save(figure, *arguments, **options)

    monkeypatch.setattr(Figure, "savefig", look_and_save)
    return seen


def labels(axis, notes=False):
    """The names of curves, or what the legend notes beside them."""
    found = axis.get_legend_handles_labels()[1]
    return [text for text in found if ("the start" in text) == notes]


def test_several_runs_in_one_picture(here, figures):
    command("plot", here / "anti.h5", here / "phase.h5", "-w", "left.power,energy", "-o", "p.png")
    power, energy = figures[0].axes
    assert labels(power) == ["anti", "phase"]
    assert labels(energy) == ["anti left", "anti right", "phase left", "phase right"]
    assert power.get_ylabel() == "power (g µm² s⁻³)"
    assert energy.get_xlabel() == "time (s)"
    with open_trajectory(here / "phase.h5") as run:
        drawn = power.lines[1].get_xydata()
        stored = run.observable("power")[:, 0]
        np.testing.assert_array_equal(drawn, np.column_stack([run.time, stored]))
    # The jolt at t = 0 is said and not shown: what follows fills the panel.
    later, high = stored[1:], power.get_ylim()[1]
    assert later.max() < high < 10 * later.max()
    assert f"at the start: {stored[0]:.3g}" in labels(power, notes=True)[0]
    assert labels(power, notes=True)[0] in [t.get_text() for t in power.get_legend().get_texts()]


def test_runs_are_named_by_what_is_not_common_in_their_paths(here, figures, tmp_path):
    for name in ("b=1", "b=2"):
        (tmp_path / "sweep" / name).mkdir(parents=True)
        (tmp_path / "sweep" / name / "out.h5").write_bytes((here / "anti.h5").read_bytes())
    command("plot", "sweep/b=1/out.h5", "sweep/b=2/out.h5", "-w", "left.amplitude", "-o", "p.png")
    assert labels(figures[0].axes[0]) == ["b=1", "b=2"]


def test_one_run_has_a_curve_for_each_rod(here, figures):
    command("measure", here / "anti.h5", "velocity", "gap", "--plot", "p.png")
    velocity, gap = figures[0].axes
    assert labels(velocity) == [f"{rod} {c}" for rod in ("left", "right") for c in "xyz"]
    assert len({(line.get_color(), line.get_linestyle()) for line in velocity.lines}) == 6
    assert labels(gap) == []


@pytest.mark.parametrize(
    ("what", "files", "words"),
    [
        ("shapes", 2, "-w shapes: is a picture of one run, alone"),
        ("writhe,curvature", 1, "-w curvature: is a picture of one run, alone"),
        ("wriths", 1, "no quantity 'wriths': did you mean 'writhe'"),
    ],
)
def test_pictures_that_cannot_be_are_refused(here, what, files, words):
    assert words in command("plot", *[here / "anti.h5", here / "phase.h5"][:files], "-w", what,
                         "-o", "p.png", code=2).stderr  # fmt: skip


def test_the_same_run_twice_and_other_units_are_refused(here, tmp_path):
    twice = command(
        "plot", here / "anti.h5", here / "anti.h5", "-w", "power", "-o", "p.png", code=2
    )
    assert "is given twice" in twice.stderr
    simulate(load_case(CONFIGS / "two_flagella.yaml",
                       [*FLAGELLA, "time.end=period/12", "units.length=mm"]), "mm.h5")  # fmt: skip
    other = command("plot", here / "anti.h5", "mm.h5", "-w", "amplitude", "-o", "p.png", code=2)
    assert "mm.h5: is in other units than" in other.stderr


# Energies, info, the end ------------------------------------------------------------------------


def test_the_csv_of_energies_has_every_rod(here, tmp_path):
    command("energy", here / "anti.h5", "--csv", "e.csv", "--kT", "298")
    with open("e.csv", newline="") as stream:
        row = list(csv.DictReader(stream))[7]
    with open_trajectory(here / "anti.h5") as run:
        bending = run.observable("bending_energy", 7) / 4.11433e-6  # kT, g um^2 s^-2
    assert float(row["right.bending (kT at 298 K)"]) == pytest.approx(bending[1], rel=1e-5)
    assert float(row["bending (kT at 298 K)"]) == pytest.approx(bending.sum(), rel=1e-5)


def test_info_says_what_the_case_was(here):
    lines = command("info", here / "anti.h5").stdout.splitlines()
    assert lines[3] == "Two flagella in opposite phase"
    assert lines[4].startswith("fluid: viscosity 1e-06 g um^-1 s^-1 (1 mPa s), algebraic7, epsilon")
    assert lines[6].endswith("; bending 0.035, twisting 0.035 g um^3 s^-2; shear 0.8, stretch 0.8 "
                             "g um s^-2")  # fmt: skip
    assert re.match(r"time: to 0\.0361\d+ s by rkc, tolerance 0\.0001$", lines[7])


BOW = {
    "fluid": {"viscosity": 1.3e-6, "epsilon": 0.3},
    "rods": {
        "bow": {
            "shape": {"kind": "sine", "amplitude": 0.3, "wavelength": 4.0, "points": 21,
                      "length": 4.2},
            "moduli": {"bending": 3.5e-3, "twisting": 2.5e-3, "shear": 0.7, "stretch": 0.9},
        }
    },
    "time": {"end": 0.7},
    "output": {"interval": 2.0e-3},
}  # fmt: skip


def test_a_run_until_still_ends_where_nothing_moves(tmp_path):
    from rodsim.case import case_from_mapping

    case = case_from_mapping(BOW)
    summary = simulate(case, tmp_path / "out.h5", until="still")
    with open_trajectory(tmp_path / "out.h5") as run:
        assert (run.status, summary.status) == ("finished", "finished")
        assert 8 < run.frames < len(run.planned) / 2
        ends = np.append(np.flatnonzero(np.diff(run.steps)), run.frames - 1)[-4:]
        X, time = run.position[ends], run.time[ends]
        fast = np.linalg.norm(np.diff(X, axis=0), axis=2).max(axis=1) / np.diff(time)
        assert fast[2] * 0.7 <= 1e-4 * 4.2 < fast[1] * 0.7  # the step before was not still
        bend = run.observable("bending_energy")[:, 0]
        assert bend[-1] < 1e-6 * bend[0]
    assert summary.endings[-1].startswith("nothing moves any more: fastest point")
    assert "nothing moves any more" in command("info", tmp_path / "out.h5", "--check").stdout
    whole = simulate(case, tmp_path / "whole.h5")
    assert resume(tmp_path / "out.h5").frames == whole.frames
    ended = []
    for name in ("out.h5", "whole.h5"):
        with open_trajectory(tmp_path / name) as run:
            ended.append(run.position)
    np.testing.assert_array_equal(*ended)


def test_a_run_until_still_that_is_stopped_ends_at_the_same_frame(tmp_path):
    from rodsim.case import case_from_mapping
    from rodsim.errors import StoppedError

    case, asked = case_from_mapping(BOW), iter([""] * 9 + ["me"])
    whole = simulate(case, tmp_path / "whole.h5", until="still")
    with pytest.raises(StoppedError):
        simulate(case, tmp_path / "out.h5", until="still", stop=lambda: next(asked))
    assert resume(tmp_path / "out.h5", until="still").frames == whole.frames


def test_what_is_driven_is_never_still(tmp_path):
    done = command(
        "run", CONFIGS / "flagellum.yaml", "--until", "still", "-o", tmp_path / "x", code=2
    )
    assert "the scene is driven, so it never comes to rest" in done.stderr
    assert not (tmp_path / "x").exists()
    with pytest.raises(UsageError, match="until 'stil'"):
        simulate(load_case(CONFIGS / "open_rod.yaml"), tmp_path / "x", until="stil")


SWIMMER = {
    "fluid": {"viscosity": 0.7, "epsilon": 0.5},
    "bodies": {
        "cell": {"shape": {"kind": "sphere", "radius": 1.5, "points": 20, "origin": [0.2, 0, -1.5]}}
    },
    "rods": {
        "tail": {
            "shape": {"kind": "straight", "points": 7, "length": 3.0, "origin": [0.2, 0, 0]},
            "moduli": {"bending": 1.3, "twisting": 1.2, "shear": 120.0, "stretch": 130.0},
            "strain_twist": [0.5, 0.2, 0.3],
            "start": {"hold": "clamped", "to": "cell", "motor": {"rate": 0.7}},
        }
    },
    "time": {"end": 0.9, "tolerance": 1e-4},
    "output": {"interval": 0.1},
}


def test_bodies_and_motors_are_measured(tmp_path):
    """By the places in the file: slope along the mean axis, drag U^2/P, of the frames after 0.3."""
    simulate(load_case(SWIMMER), tmp_path / "swimmer.h5")
    names = ("body_speed", "swimming_speed", "propulsion", "motor_torque", "motor_rate")
    with open_trajectory(tmp_path / "swimmer.h5") as run:
        picked = measuring.pick(run, names)
        found = measuring.of_run(run, picked, 0.3)
        t, x = run.time[3:], run.of_bodies("position")[3:, 0]
        w, q1, q2, q3 = run.of_bodies("orientation")[3:, 0].T
        z = np.array([2 * (q1 * q3 + w * q2), 2 * (q2 * q3 - w * q1), 1 - 2 * (q1**2 + q2**2)])
        axis = z.mean(axis=1) / np.linalg.norm(z.mean(axis=1))
        slope = np.polyfit(t, x, 1)[0]
        assert found["cell.body_speed"] == pytest.approx(np.linalg.norm(slope), rel=1e-12)
        assert found["cell.swimming_speed"] == pytest.approx(slope @ axis, rel=1e-12)
        work = run.observable("motor_work")
        power = (work[-1] - work[3]) / (t[-1] - t[0])
        drag = run.body("cell")["resistance"][2, 2]
        assert found["cell.propulsion"] == pytest.approx(drag * (slope @ axis) ** 2 / power)
        assert found["tail.start.motor_rate"] == pytest.approx(0.7, rel=1e-9)
        assert found["tail.start.motor_torque"] * 0.7 == pytest.approx(power, rel=5e-2)

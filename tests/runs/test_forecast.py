"""What a run will cost, said before it: evaluations, frames, disk; what sets the fastest rate."""

import numpy as np
import pytest
from calls import command
from scenes import CONFIGS, load

from rodsim import open_trajectory, simulate
from rodsim.commands.costs import span
from rodsim.integrators.fastest_rate import FastestRate
from rodsim.run.forecast import forecast
from rodsim.run.machine import Machine
from rodsim.run.stiffest import stiffest
from rodsim.scene.build import build_scene
from rodsim.scene.moduli import with_moduli
from rodsim.scene.system import RodSystem

pytestmark = pytest.mark.compiled


def machine_of(case):
    return Machine(case, build_scene(case), False)


@pytest.mark.parametrize(
    ("config", "changes", "within"),
    [
        ("open_rod", (), 1.3),
        ("sedimenting_fibre", (), 1.3),
        pytest.param("fibre_settling_on_wall", (), 1.5, marks=pytest.mark.long),
        ("tethered_pair", ("time.tolerance=1e-6",), 1.5),
        pytest.param("plasmid", (), 1.5, marks=pytest.mark.long),
        ("two_flagella", ("rods.left.shape.points=31", "time.tolerance=1e-6"), 1.5),
    ],
)
def test_evaluations_are_those_of_the_run(config, changes, within, tmp_path):
    """``within``: a little more than measured (docs/choosing.md); the page promises a factor 2."""
    case = load(config, *changes)
    said = forecast(machine_of(case))
    simulate(case, tmp_path / "out.h5", notify=lambda text: None)
    with open_trajectory(tmp_path / "out.h5") as run:
        made, frames = run.runtime["evaluations"], run.frames
    assert made > 1.5 * 300 or config == "open_rod"  # not all of them are in the first steps
    assert made / within < said.evaluations < made * within
    assert said.frames == frames
    size = (tmp_path / "out.h5").stat().st_size
    assert size <= said.disk < 1.1 * size + 6e4  # what is reserved, and partly given back
    assert said.threads >= 1
    assert said.memory > 5e7  # Python with its libraries


def test_fixed_steps_are_counted(tmp_path):
    fixed = ("time.integrator=rk4", "time.step=2e-6", "time.end=1e-3", "output.interval=1e-4")
    case = load("open_rod", *fixed)
    said = forecast(machine_of(case))
    simulate(case, tmp_path / "out.h5", notify=lambda text: None)
    with open_trajectory(tmp_path / "out.h5") as run:
        followed = run.runtime["evaluations"] - said.evaluations  # estimates of the fastest rate
        assert 0 <= followed <= 0.01 * said.evaluations
    assert sum(count for _, count in said.made + said.ahead) == 500


def test_a_run_that_is_over_within_the_first_steps_is_known_exactly(tmp_path):
    case = load("open_rod", "time.end=1e-5")
    said = forecast(machine_of(case))
    simulate(case, tmp_path / "out.h5", notify=lambda text: None)
    with open_trajectory(tmp_path / "out.h5") as run:
        assert said.evaluations == run.runtime["evaluations"]
    assert said.ahead == []


def rate_of(scene):
    return FastestRate(RodSystem(scene)).estimate(scene.initial, tolerance=1e-6)


@pytest.mark.parametrize(
    ("changes", "names"),
    [
        (("rods.rod.moduli.stretch=30",), ("stretch",)),
        (("rods.rod.moduli.shear=30",), ("shear",)),
        (("rods.rod.moduli.bending=30",), ("bending",)),
        (("rods.rod.moduli.twisting=30",), ("twisting",)),
        ((), ("shear", "stretch")),
    ],
)
def test_what_sets_the_fastest_rate_is_named(changes, names, tmp_path):
    """Against the rate of the case with a quarter of them written into it."""
    few = "rods.rod.shape.points=31"
    case = load("open_rod", few, *changes)
    scene = build_scene(case)
    found = stiffest(scene, rate_of(scene))
    assert found.names == names
    moduli = case.rods["rod"].moduli
    softer = [f"rods.rod.moduli.{key}={0.25 * getattr(moduli, key)!r}" for key in names]
    again = build_scene(load("open_rod", few, *changes, *softer))
    assert found.rate == pytest.approx(rate_of(again), rel=0.01)
    assert found.rate < 0.9 * rate_of(scene)


def test_moduli_along_a_rod_are_made_softer_as_well():
    few = "rods.rod.shape.points=31"
    wave = "rods.rod.moduli.bending='{}*(2 + sin(s))'"
    scene, quarter = (build_scene(load("open_rod", few, wave.format(a))) for a in (4e-2, 1e-2))
    factors = np.array([0.25, 0.25, 1.0, 1.0, 1.0, 1.0])
    assert rate_of(with_moduli(scene, factors)) == pytest.approx(rate_of(quarter), rel=1e-9)
    assert rate_of(scene) > 1.1 * rate_of(quarter)


def test_a_scene_that_no_modulus_makes_stiff():
    case = load("tethered_pair", "tethers.top.stiffness=1e4")
    scene = build_scene(case)
    assert stiffest(scene, rate_of(scene)).names == ()
    stiff = "--set", "tethers.top.stiffness=1e4"
    said = command("info", CONFIGS / "tethered_pair.yaml", *stiff).stdout
    assert "no modulus sets the fastest rate" in said


@pytest.mark.parametrize("words", [("info",), ("run", "--dry-run")])
def test_the_commands_say_it(words):
    case = CONFIGS / "open_rod.yaml"
    said = command(*words, case).stdout
    assert "run: about " in said
    assert "evaluations of" in said
    assert ", 101 frames" in said
    assert "; memory about " in said
    assert (
        "shear and stretch set the fastest rate: a quarter of them would leave 0.25 of it" in said
    )
    fixed = ("--set", "time.integrator=euler", "--set", "time.step=1e-6")
    assert "the longest stable step be 4 times as long" in command(*words, case, *fixed).stdout
    assert "on 1 thread, " in command("run", "--dry-run", "--threads", 1, case).stdout


@pytest.mark.parametrize(
    ("seconds", "text"),
    [(3e-5, "0.03 ms"), (0.0123, "12 ms"), (1.44, "1400 ms"), (1.6, "1.6 s"), (89, "89 s"),
     (1080, "18 minutes"), (6e3, "1.7 hours"), (1e6, "12 days")],
)  # fmt: skip
def test_times_as_they_are_read(seconds, text):
    assert span(seconds) == text

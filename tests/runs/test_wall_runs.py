"""A plane wall as users meet it: refused, warned of, named, resumed, drawn, exported."""

import numpy as np
import pytest
from calls import call
from contents import differences
from interrupted import after, make, run_with_copies

from rodsim import open_trajectory, resume, simulate
from rodsim.errors import DivergedError, StoppedError

pytestmark = pytest.mark.compiled

SETTLING = """
title: settling
fluid: {viscosity: 1.3, epsilon: 0.23, wall: {z: -0.4}}
rods:
  low:
    shape: {kind: straight, points: 13, spacing: 0.21, origin: [0.3, 0.1, 0.2],
            rotate: {axis: [0, 1, 0], degrees: 83}}
    moduli: {bending: 0.36, twisting: 0.29, shear: 21, stretch: 17}
    loads: {weight: {along: all, force: [0, 0, -3.1]}}
  high:
    shape: {kind: straight, points: 11, spacing: 0.21, origin: [0.3, 1.2, 1.1],
            rotate: {axis: [1, 0, 0], degrees: 71}}
    moduli: {bending: 0.36, twisting: 0.29, shear: 21, stretch: 17}
    strain_twist: ["0.7*sin(3*t)", 0.2, 0.1]
tracers:
  here: [[0.3, 0.4, 0.5], [0.7, 0.2, -0.4]]
time: {end: 2.6, tolerance: 1.0e-4}
output: {interval: 0.13}
"""


@pytest.fixture(scope="module")
def settled(tmp_path_factory):
    """A run of the scene, with a copy of its file after every step."""
    folder = tmp_path_factory.mktemp("settled")
    return run_with_copies(make(folder, SETTLING), folder)[:2]


def write(folder, text=SETTLING):
    (folder / "case.yaml").write_text(text)
    return str(folder / "case.yaml")


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (["fluid.wall.z=0.2"], ["rods.low.shape", "point 0 is at z = 0.2:", "the wall, z = 0.2"]),
        (
            ["fluid.wall.z=3"],
            ["rods.low.shape", "rods.high.shape", "is at z = 1.1: must", "tracers"],
        ),
        (["tracers.here=[[0.3, 0.4, -0.41]]"], ["tracers", "z = -0.41, below the wall, z = -0.4"]),
        (["fluid.flow=['1.7*z', 0, 0]"], ["fluid.flow", "on the wall, z = -0.4, at t = 0: must"]),
    ],
)
@pytest.mark.parametrize("command", ["validate", "run", "info"])
def test_what_is_not_above_the_wall_is_refused(command, changes, words, tmp_path):
    options = [part for change in changes for part in ("--set", change)]
    output = ["-o", str(tmp_path / "out.h5")] if command == "run" else []
    done = call(command, write(tmp_path), *options, *output)
    assert done.exit_code == 2
    for word in words:
        assert word in done.stderr
    assert not (tmp_path / "out.h5").exists()


def test_a_tracer_on_the_wall_is_taken_and_stays(settled):
    with open_trajectory(settled[0]) as run:
        assert run.tracers[:, 1] == pytest.approx(np.tile([0.7, 0.2, -0.4], (21, 1)), abs=1e-15)
        assert abs(run.tracers[-1, 0] - run.tracers[0, 0]).max() > 0.01


def test_rounding_takes_no_tracer_through_the_wall(tmp_path):
    case = make(tmp_path, SETTLING, [
        "tracers.here=[[0.7, 0.2, -0.4000000000001]]", "time.end=0.26"])  # fmt: skip
    simulate(case, tmp_path / "out.h5")
    with open_trajectory(tmp_path / "out.h5") as run:
        assert run.tracers[-1, 0] == pytest.approx([0.7, 0.2, -0.4], abs=1e-11)


@pytest.mark.parametrize("command", ["validate", "run", "info"])
def test_closer_than_epsilon_is_warned_of_once(command, tmp_path):
    output = ["-o", str(tmp_path / "out.h5"), "-q"] if command == "run" else []
    change = ["--set", "fluid.wall.z=0.1", "--set", "tracers=null", "--set", "time.end=0.01"]
    done = call(command, write(tmp_path), *change, "--set", "output.interval=0.01", *output)
    assert done.exit_code == 0, done.stderr
    said = [line for line in done.output.splitlines() if "closer than epsilon" in line]
    (line,) = said
    assert "rods.low.shape = " in line
    assert "point 0 is 0.1 above the wall" in line
    assert "is about 0.61 epsilon" in line
    assert "case.yaml:6" in line
    assert "high" not in line


def test_no_warning_where_all_is_farther_than_epsilon(tmp_path):
    done = call("validate", write(tmp_path))
    assert done.exit_code == 0
    assert "warning:" not in done.output


def test_info_says_where_the_wall_is(settled, tmp_path):
    said = call("info", write(tmp_path)).stdout
    assert (
        "wall: z = -0.4 um, without slip; lowest: point 0 of rod low, 0.6 um = 2.609 epsilon"
        in said
    )
    assert "wall: z = -0.4 um, without slip" in call("info", str(settled[0])).stdout
    free = SETTLING.replace(", wall: {z: -0.4}", "")
    assert "wall" not in call("info", write(tmp_path, free)).stdout


HEAVY = ["output.interval=0.026", "time.end=0.26", "rods.low.loads.weight.force=[0,0,-1e3]"]


@pytest.mark.parametrize(
    ("method", "words"),
    [
        ("euler", ["rod 'low', point", "not above the wall, z = -0.4", "halve time.step"]),
        ("rk4", ["rod 'low', point", "goes from z = ", "to the wall, z = -0.4, or beyond"]),
    ],
)
def test_a_fixed_step_to_the_wall_stops_by_name(method, words, tmp_path):
    case = write(tmp_path)
    time = f"time={{integrator: {method}, step: 0.026, end: 0.26}}"
    options = [part for change in (time, HEAVY[0], HEAVY[2]) for part in ("--set", change)]
    done = call("run", case, "-o", str(tmp_path / "out.h5"), *options, "--force")
    assert done.exit_code == 3
    for word in words:
        assert word in done.stderr
    with open_trajectory(tmp_path / "out.h5") as run:
        assert run.status == "diverged"
        assert np.isfinite(run.position).all()
        assert run.position[..., 2].min() > -0.4


def test_a_tracer_that_a_fixed_step_takes_through_the_wall_is_named(tmp_path):
    """Far too long a step, while the rods are slow enough to stay above."""
    text = SETTLING.replace("[0.7, 0.2, -0.4]", "[0.9, 0.1, -0.33]")
    case = make(tmp_path, text, [
        "time={integrator: euler, step: 2.5, end: 5}", "output.interval=2.5",
        "rods.low.loads.weight.force=[0,0,-0.1]", "rods.high.strain_twist=[0,0,0]",
        "rods.low.moduli={bending: 1e-4, twisting: 1e-4, shear: 1e-3, stretch: 1e-3}",
        "fluid.flow=['0', 'z+0.4', '0']",
    ])  # fmt: skip
    with pytest.raises(DivergedError, match="tracer"):
        simulate(case, tmp_path / "out.h5", force=True)


def test_rkc_is_not_stopped_by_the_wall(tmp_path):
    """The same weight at which fixed steps stop: its steps are made as small as they must be."""
    simulate(make(tmp_path, SETTLING, HEAVY), tmp_path / "out.h5")
    with open_trajectory(tmp_path / "out.h5") as run:
        assert run.status == "finished"
        assert -0.4 < run.position[-1, :, 2].min() < -0.2


def test_a_run_that_goes_on_has_the_same_bits_with_any_threads(settled, tmp_path):
    path, killed = settled
    copy = tmp_path / "out.h5"
    for number, threads in ((0, 2), (len(killed) // 2, 1), (len(killed) - 2, 2)):
        copy.write_bytes(killed[number].read_bytes())
        with open_trajectory(copy) as run:
            assert run.status == "running"
        resume(copy, threads=threads)
        assert differences(copy, path) == []


@pytest.mark.parametrize("threads", [1, 2])
def test_threads_change_no_bit(threads, settled, tmp_path):
    case = make(tmp_path, SETTLING)
    with pytest.raises(StoppedError):
        simulate(case, tmp_path / "out.h5", threads=threads, stop=after(5))
    resume(tmp_path / "out.h5", threads=3 - threads)
    assert differences(tmp_path / "out.h5", settled[0]) == []


def test_the_energy_balance_holds_at_the_wall(tmp_path):
    """dE = work of the loads - what the fluid dissipates, but for terms of order ds^2."""
    still = ["rods.high.strain_twist=[0.7, 0.2, 0.1]", "time.tolerance=1e-5"]
    simulate(make(tmp_path, SETTLING, still), tmp_path / "out.h5")
    with open_trajectory(tmp_path / "out.h5") as run:
        seen = {name: run.observable(name) for name in run.observables}
    parts = [f"{part}_energy" for part in ("bending", "twisting", "shear", "stretch")]
    energy = sum(seen[name].sum(axis=1) for name in parts)
    balance = energy - energy[0] - seen["external_work"] + seen["dissipated"]
    assert seen["loads_work"][-1] > 3.0
    assert abs(balance).max() < 0.01 * seen["loads_work"][-1]

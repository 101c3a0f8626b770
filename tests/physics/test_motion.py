"""What whole runs must obey: energies, symmetries, the relaxed helix."""

import numba
import numpy as np
import pytest
from scenes import difference, final_state, fixed, last, system_of

from rodsim.analysis.helix import fit_helix, triad_turns
from rodsim.case import load_case
from rodsim.forces.elastic import ENERGIES
from rodsim.integrators.make import make_integrator
from rodsim.scene.build import build_scene
from rodsim.scene.shapes import rotation_matrix
from rodsim.scene.system import RodSystem

SMALL_OPEN = ("open_rod", "rods.rod.shape.points=24", "fluid.epsilon.spacings=3")


def history(config, *overrides):
    """Observables at the start and after every step, and the times."""
    case, system = system_of(config, *overrides)
    times, seen = [0.0], [system.observe(system.scene.initial)[1]]
    for step in make_integrator(case.time, system).steps(system.scene.initial, case.time.end):
        times.append(step.end.time)
        seen.append(system.observe(step.end)[1])
    return np.array(times), {name: np.array([s[name] for s in seen]) for name in seen[0]}


def total(observables):
    return sum(observables[name] for name in ENERGIES).sum(axis=1)


@pytest.mark.compiled
@pytest.mark.parametrize("config", ["open_rod", "open_rod_half_twist", "closed_ring"])
def test_total_energy_of_a_passive_rod_falls_monotonically(config):
    _, seen = history(config)
    energy = total(seen)
    assert (np.diff(energy) < 0).all()
    assert (seen["power"] > 0).all()


@pytest.mark.compiled
def test_power_is_the_rate_at_which_the_energy_falls():
    """-dE/dt = sum (g.u + m.w), up to the O(ds^2) of the torque (31): 3 % at ds = 1/13 radius."""
    times, seen = history("open_rod", "time.end=1e-3", "time.tolerance=1e-6")
    lost = -np.diff(total(seen)) / np.diff(times)
    power = seen["power"].sum(axis=1)
    later = times[:-1] > 2e-4
    assert lost[later] == pytest.approx(0.5 * (power[1:] + power[:-1])[later], rel=0.03)


@pytest.mark.compiled
def test_kinetic_energy_drops_then_rises_to_its_maximum_at_0_6_ms_then_falls():
    times, seen = history("open_rod", "time.tolerance=1e-6")
    kinetic = seen["kinetic_energy"][:, 0]
    start = kinetic[np.searchsorted(times, 1e-4)]
    assert start < 0.9 * kinetic[0]
    top = np.argmax(np.where(times > 1e-4, kinetic, 0.0))
    assert times[top] == pytest.approx(6e-4, abs=5e-5)
    assert kinetic[top] > 1.5 * start
    assert (np.diff(kinetic[top:]) < 0).all()


def test_kinetic_energy_is_that_of_a_tube_of_fluid():
    """K = 1/2 rho pi eps^2 sum |u|^2 ds, from the velocities of the same state."""
    _, system = system_of(*SMALL_OPEN, "fluid.density=3.7e-12")
    fields, seen = system.observe(system.scene.initial)
    tube = 3.7e-12 * np.pi * system.scene.epsilon**2 * system.scene.rods.spacing[0]
    expected = 0.5 * tube * np.sum(fields["velocity"] ** 2)
    assert seen["kinetic_energy"] == pytest.approx([expected], rel=1e-12)


@pytest.mark.compiled
@pytest.mark.parametrize(
    ("config", "twist", "turns"),
    [("open_rod_half_twist", np.pi / 2, 1.91), ("open_rod", np.pi, 3.19)],
)
def test_relaxed_open_rod_is_the_helix_of_its_curvature_and_twist(config, twist, turns):
    """At 60 ms: radius and pitch of (kappa, tau), and both ways to count turns.

    The discrete helix without energy is exact: theta = 2 asin(K ds/2) per segment.
    """
    state, system, _ = final_state(config, "time.end=0.06")
    helix = fit_helix(state.position.T)
    kappa, ds = 1.3, system.scene.rods.spacing[0]
    K = np.hypot(kappa, twist)
    theta = 2 * np.arcsin(K * ds / 2)
    # A part in a thousand of the energy is left at 60 ms: 1 % on radius and pitch.
    assert helix.radius == pytest.approx(ds * kappa / K / (2 * np.sin(theta / 2)), rel=0.01)
    assert helix.pitch == pytest.approx(ds * twist / K * 2 * np.pi / theta, rel=0.01)
    assert helix.turns == pytest.approx(turns, abs=0.02)
    assert helix.turns == pytest.approx(75 * theta / (2 * np.pi), rel=0.01)
    assert triad_turns(state.director.transpose(2, 0, 1)) == pytest.approx(
        twist * 75 * ds / (2 * np.pi), rel=0.01
    )


def test_fit_of_an_exact_helix_left_and_right_handed():
    angle = np.linspace(0.3, 9.1, 57)
    turn = rotation_matrix((0.4, -1.0, 0.3), 0.8)
    for pitch in (0.7, -0.7):
        points = np.array([0.35 * np.cos(angle), 0.35 * np.sin(angle), pitch * angle / 2 / np.pi])
        helix = fit_helix((turn @ points).T + np.array([1.0, 2.0, -3.0]))
        assert helix.radius == pytest.approx(0.35, rel=1e-10)
        assert helix.pitch == pytest.approx(pitch, rel=1e-10)
        assert helix.turns == pytest.approx(8.8 / 2 / np.pi, rel=1e-10)


def test_viscosity_and_step_doubled_is_the_same_run_bit_for_bit():
    runs = [
        final_state(*SMALL_OPEN, f"fluid.viscosity={k * 1.3e-6!r}", f"time.end={k * 2e-5!r}",
                    f"output.interval={k * 2e-5!r}", *fixed("euler", k * 1e-6))[0]
        for k in (1, 2)
    ]  # fmt: skip
    assert difference(*runs) == (0.0, 0.0)


def test_lengths_doubled_is_the_same_run_bit_for_bit():
    """Lengths x 2, moduli a x 16 and b x 4, rates unchanged: powers of two lose nothing."""
    same = ("time.end=2e-5", "output.interval=2e-5", *fixed("rk4", 2e-6))
    small = final_state(*SMALL_OPEN, *same)[0]
    large = final_state(
        *SMALL_OPEN, *same, "rods.rod.shape.spacing=0.15707963267948966",
        "rods.rod.moduli.bending=0.056", "rods.rod.moduli.twisting=0.056",
        "rods.rod.moduli.shear=3.2", "rods.rod.moduli.stretch=3.2",
        "rods.rod.strain_twist=[0.65, 0, 1.5707963267948966]")[0]  # fmt: skip
    assert np.array_equal(large.position, 2 * small.position)
    assert np.array_equal(large.director, small.director)


def test_a_turned_and_moved_scene_moves_alike():
    same = ("time.end=4e-5", "output.interval=4e-5", *fixed("rk4", 2e-6))
    plain = final_state(*SMALL_OPEN, *same)[0]
    moved = final_state(
        *SMALL_OPEN, *same, "rods.rod.shape.origin=[3, -2, 5]",
        "rods.rod.shape.rotate={axis: [0.2, 1.1, -0.7], degrees: 77}")[0]  # fmt: skip
    turn = rotation_matrix((0.2, 1.1, -0.7), np.radians(77))
    expected = turn @ plain.position + np.array([[3.0], [-2.0], [5.0]])
    # 80 evaluations, positions of size 6, force differences of 1e-16 b/ds times h/(mu eps).
    assert moved.position == pytest.approx(expected, abs=1e-11)
    assert moved.director == pytest.approx(
        np.einsum("ab,ibk->iak", turn, plain.director), abs=1e-11
    )


def test_a_planar_run_is_the_spatial_run():
    scene = ("flagellum", "rods.tail.shape.points=40", "time.end=4e-4")
    flat = final_state(*scene)[0]
    full, system, _ = final_state(*scene, "plane=null")
    assert not system.scene.planar
    # Rounding decides nothing here: the same steps are taken, so the runs agree far below 1e-4.
    assert max(difference(flat, full)) < 1e-9
    assert not flat.position[0].any()
    assert np.array_equal(flat.director[0], np.array([[1.0], [0], [0]]).repeat(40, axis=1))


@pytest.mark.compiled
def test_a_run_with_two_threads_has_the_bits_of_one_thread():
    states = []
    for threads in (1, min(2, numba.config.NUMBA_NUM_THREADS)):
        numba.set_num_threads(threads)
        states.append(final_state("closed_ring", "time.end=2e-3")[0])
    numba.set_num_threads(numba.config.NUMBA_NUM_THREADS)
    assert difference(*states) == (0.0, 0.0)


def test_tracers_ride_with_the_flow_and_never_change_the_rods():
    scene = ("closed_ring_low_twist", "rods.ring.shape.points=40", "time.end=1e-3")
    small = ("tracers.inner.along=5", "tracers.outer.along=3")
    with_markers, system, _ = final_state(*scene, *small)
    without = final_state(*scene, "tracers=null")[0]
    assert difference(with_markers, without) == (0.0, 0.0)
    assert with_markers.tracer.shape == (3, 64)
    moved = with_markers.tracer - system.scene.initial.tracer
    assert 1e-3 < np.linalg.norm(moved, axis=0).max() < 1.0


def test_a_tracer_on_a_point_of_a_rod_moves_with_it():
    case = ("open_rod", "rods.rod.shape.points=20", "time.end=2e-4", "time.tolerance=1e-6")
    place = 7 * 0.07853981633974483 * (1 + 1e-4)
    state, _, _ = final_state(*case, f"tracers={{at: [[0, 0, {place!r}]]}}")
    # Both are the same equation by the same method; positions differ by rounding at the start.
    assert state.tracer[:, 0] == pytest.approx(state.position[:, 7], abs=1e-10)


def test_two_rods_feel_each_other_and_swapping_their_names_changes_nothing(tmp_path):
    def run(order, gap):
        rods = {"left": (0.0, 9), "right": (gap, 7)}
        text = "fluid: {viscosity: 1.3e-6, epsilon: 0.3}\nrods:\n"
        for name in order:
            x, points = rods[name]
            text += (
                f"  {name}:\n"
                f"    shape: {{kind: straight, points: {points}, spacing: 0.11,"
                f" origin: [{x}, 0, 0]}}\n"
                "    moduli: {bending: 3e-3, twisting: 2e-3, shear: 0.7, stretch: 0.9}\n"
                "    strain_twist: [0.9, 0, 0.4]\n"
            )
        path = tmp_path / "two.yaml"
        path.write_text(text + "time: {end: 1e-4, integrator: rk4, step: 1e-6}\n")
        case = load_case(path)
        system = RodSystem(build_scene(case))
        steps = make_integrator(case.time, system).steps(system.scene.initial, case.time.end)
        step = last(steps)
        first = system.scene.rods.first
        return {
            name: step.end.position[:, first[r] :][:, : rods[name][1]]
            for r, name in enumerate(order)
        }

    near = run(("left", "right"), 0.5)
    swapped = run(("right", "left"), 0.5)
    far = run(("left", "right"), 1e5)
    for name in ("left", "right"):
        assert swapped[name] == pytest.approx(near[name], abs=1e-10)  # order of the sums
    felt = abs(near["left"] - far["left"]).max()
    assert felt > 1e-4  # half a micrometre apart, they do
    alone = run(("left",), 0.0)["left"]
    # A Stokeslet decays as 1/r: at 1e5 it moves what moved 0.1 by about 1e-6 of that.
    assert far["left"] == pytest.approx(alone, abs=1e-6)

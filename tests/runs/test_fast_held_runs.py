"""Fast sums above a wall, and beside bodies, motors, hooks and held ends."""

import numpy as np
import pytest
from contents import differences
from interrupted import make, run_with_copies
from scenes import system_from

from rodsim import open_trajectory, resume, simulate
from rodsim.analysis.replay import Replay
from rodsim.integrators.limits import stability
from rodsim.integrators.make import make_integrator

pytestmark = [pytest.mark.compiled, pytest.mark.long]

MODULI = "{bending: 3.5e-3, twisting: 2.5e-3, shear: 0.7, stretch: 0.9}"
AT_WALL = f"""
fluid: {{viscosity: 1.3e-6, epsilon: 0.3, sums: {{accuracy: 1.0e-5}}, wall: {{z: -1.6}}}}
rods:
  coil:
    shape: {{kind: helix, radius: 0.9, pitch: 1.7, points: 180, length: 18,
            rotate: {{axis: [0, 1, 0], degrees: 85}}}}
    moduli: {MODULI}
    strain_twist: [0.4, 0, "0.3 + 0.2*sin(300*t)"]
    start: {{hold: clamped}}
  ring:
    shape: {{kind: ring, radius: 1.7, points: 110, origin: [0.2, 3.1, -0.3]}}
    strain_twist: [0.5, 0.1, 0]
    moduli: {MODULI}
tracers:
  tube: {{kind: tube, rod: ring, radius: 0.4, around: 4, along: 25}}
  wall: [[0.3, 0.2, -1.6]]
time: {{end: 2.0e-3, tolerance: 1.0e-4}}
output: {{interval: 5.0e-4}}
"""
SWIMMER = f"""
fluid: {{viscosity: 1.3e-6, epsilon: 0.2, sums: {{accuracy: 1.0e-5}}}}
bodies:
  cell:
    shape: {{kind: sphere, radius: 0.6, points: 30, origin: [0.2, 0.1, -0.3]}}
    force: [0, "2.0e-6*sin(700*t)", 0]
rods:
  tail:
    shape: {{kind: helix, radius: 0.4, pitch: -2.1, points: 150, length: 15, taper: 0.3,
            origin: [0.2, 0.1, -0.9]}}
    moduli: {MODULI}
    strain_twist: natural
    start:
      hold: clamped
      to: cell
      motor: {{rate: "2*pi*90*min(t/4e-4, 1)"}}
      hook: {{bending: 3.0e-3, twisting: 2.0e-3}}
tracers:
  here: [[0.9, 1.4, 0.5], [0.9, 0.2, -2.1]]
time: {{end: 6.0e-4, tolerance: 1.0e-4}}
output: {{interval: 2.0e-4}}
"""


@pytest.fixture(scope="module", params=[AT_WALL, SWIMMER], ids=["wall", "swimmer"])
def whole(request, tmp_path_factory):
    """A scene and its run, with a copy of the file after every step."""
    folder = tmp_path_factory.mktemp("whole")
    return request.param, *run_with_copies(make(folder, request.param), folder)[:2]


def test_a_run_goes_on_with_the_same_bits(whole):
    _, path, copies = whole
    for copy in copies[:: max(1, len(copies) // 3)]:
        resume(copy)
        assert differences(path, copy) == []


@pytest.fixture(scope="module")
def exact(whole, tmp_path_factory):
    """The same run by exact sums."""
    folder = tmp_path_factory.mktemp("exact")
    simulate(make(folder, whole[0], ["fluid.sums=null"]), folder / "out.h5")
    return folder / "out.h5"


def test_it_ends_where_the_exact_run_ends(whole, exact):
    with open_trajectory(whole[1]) as run, open_trajectory(exact) as other:
        assert 0.0 < run.observable("sum_error").max() <= 1e-5
        moved = abs(other.position[-1] - other.position[0]).max()
        # 1e-5 of the way, but for what the motion makes of it.
        assert 0.0 < abs(run.position[-1] - other.position[-1]).max() < 3e-5 * moved
        assert abs(run.tracers[-1] - other.tracers[-1]).max() < 3e-5 * moved
        for name in ("motor_torque", "motor_rate", "body_velocity", "anchor_impulse"):
            if name in other.observables:
                ours, theirs = run.observable(name), other.observable(name)
                assert ours == pytest.approx(theirs, abs=1e-4 * abs(theirs).max()), name


def test_flow_around_it_is_that_of_exact_sums(whole, exact):
    points, found = np.array([[0.4, 1.3, 0.2], [0.7, 2.2, 0.3], [0.9, -1.1, -1.9]]), []
    for path in (whole[1], exact):
        with open_trajectory(path) as run:
            sources = Replay(run).sources(0)
            found.append(np.vstack([sources.velocity(points.T).T, sources.pressure(points.T)]))
    below = points[2] < -1.6 if whole[0] is AT_WALL else np.zeros(3, dtype=bool)
    assert np.array_equal(np.isnan(found), np.broadcast_to(below, (2, 4, 3)))
    (u, *p), (v, *q) = (np.split(each[:, ~below], [3]) for each in found)
    assert 0.0 < np.linalg.norm(u - v) <= 1e-5 * np.linalg.norm(v)
    assert np.array_equal(p, q)


def jacobian_of(data):
    """Return d(dy/dt)/dy of a scene at rest, by differences."""
    _, system = system_from(data)
    rest, n, step = system.scene.initial, system.rod_size, 1e-6
    columns = np.empty((n, n))
    for k in range(n):
        rates = []
        for sign in (step, -step):
            y = system.zeros()
            y[k] = sign / system.weights[k]
            rates.append(system.rate(0.0, rest, y, system.zeros()))
        columns[:, k] = system.weights * (rates[0] - rates[1])[:n] / (2 * step)
    return columns


def coil_at_wall(accuracy, points=90, **fluid):
    """A coil free of stress above a wall, 1.4 epsilon at its lowest."""
    return {
        "fluid": {"viscosity": 1.3, "epsilon": 0.7, "sums": {"accuracy": accuracy},
                  "wall": {"z": -2.5}, **fluid},
        "rods": {"coil": {
            "shape": {"kind": "helix", "radius": 1.5, "pitch": 2.0, "points": points,
                      "length": 0.1 * points, "rotate": {"axis": [0, 1, 0], "degrees": 90}},
            "strain_twist": "natural",
            "moduli": {"bending": 0.36, "twisting": 0.29, "shear": 21.0, "stretch": 17.0},
        }},
        "time": {"end": 1.0},
    }  # fmt: skip


@pytest.mark.parametrize("accuracy", [1e-2, 1e-3])
@pytest.mark.parametrize("held", [False, True])
def test_no_mode_of_a_rod_at_rest_grows(accuracy, held):
    scene = coil_at_wall(accuracy)
    if held:
        scene["rods"]["coil"]["start"] = {"hold": "clamped"}
    values = np.linalg.eigvals(jacobian_of(scene))
    # Rounding over the step of the difference: 1e-16/1e-6, times the condition of the vectors.
    assert values.real.max() < 1e-6 * abs(values).max()
    # Of a symmetric mobility and a symmetric stiffness they are real; with held ends that are moved
    # by the fast sum, as all others are, 3e-5 of the largest is not.
    assert abs(values.imag).max() < 1e-6 * abs(values).max()


@pytest.mark.parametrize("accuracy", [1e-3, 1e-5])
def test_the_energy_of_a_smooth_rod_near_a_wall_never_rises(accuracy):
    scene = coil_at_wall(accuracy, 600, epsilon=0.5)
    scene["rods"]["coil"]["perturb"] = {"amplitude": 3e-6, "seed": 2, "modes": 40}
    scene["time"] |= {"integrator": "euler", "step": 1e-2}
    case, system = system_from(scene)
    size = 0.88 * stability(system).largest_steps["euler"]
    integrator = make_integrator(case.time.model_copy(update={"step": size}), system)
    energies = []
    for step in integrator.steps(system.scene.initial, 200 * size):
        _, seen = system.observe(step.end, np.zeros((6, 600)))
        energies.append(sum(seen[f"{e}_energy"].sum() for e in ("bending", "twisting", "shear")))
        energies[-1] += seen["stretch_energy"].sum()
    assert energies[-1] < 0.9 * energies[0]
    assert (np.diff(energies) < 0.0).all()

"""Fast sums as users meet them: refused, warned of, told, resumed with the same bits."""

import csv

import numpy as np
import pytest
from calls import call
from contents import differences
from interrupted import make, run_with_copies
from scenes import system_from

from rodsim import open_trajectory, resume, simulate
from rodsim.compiled.parts import FLOW
from rodsim.errors import CaseError
from rodsim.integrators.make import make_integrator
from rodsim.scene.build import build_scene

MODULI = "{bending: 3.5e-3, twisting: 2.5e-3, shear: 0.7, stretch: 0.9}"
SCENE = f"""
fluid: {{viscosity: 1.3e-6, epsilon: 0.3, sums: {{accuracy: 1.0e-5}}}}
rods:
  coil:
    shape: {{kind: helix, radius: 0.9, pitch: 1.7, points: 230, length: 23}}
    moduli: {MODULI}
    strain_twist: [0.4, 0, "0.3 + 0.2*sin(300*t)"]
  ring:
    shape: {{kind: ring, radius: 1.7, points: 110, origin: [0.2, 3.1, 0.3]}}
    strain_twist: [0.5, 0.1, 0]
    moduli: {MODULI}
tracers:
  tube: {{kind: tube, rod: ring, radius: 0.4, around: 4, along: 25}}
time: {{end: 4.0e-3, tolerance: 1.0e-4}}
output: {{interval: 5.0e-4}}
"""
ENERGIES = ("bending", "twisting", "shear", "stretch")


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """A run, with a copy of its file after every step."""
    folder = tmp_path_factory.mktemp("whole")
    return run_with_copies(make(folder, SCENE), folder)[:2]


@pytest.mark.compiled
def test_a_run_goes_on_with_the_same_bits(whole):
    path, copies = whole
    for copy in copies[:: max(1, len(copies) // 4)]:
        resume(copy)
        assert differences(path, copy) == []


@pytest.mark.compiled
def test_the_error_is_stored_and_told(whole):
    with open_trajectory(whole[0]) as run:
        errors = run.observable("sum_error")
        assert errors.shape == (9, 2)
        assert 0.0 < errors.max() <= 1e-5
        assert 0.0 < run.observable("tracer_sum_error").max() <= 1e-5
    told = call("info", str(whole[0])).stdout
    u, w = errors.max(axis=0)
    assert f"fast sums: error of u up to {u:.2g}, of w {w:.2g}; 1e-05 asked\n" in told


@pytest.mark.compiled
def test_it_ends_where_the_exact_run_ends(whole, tmp_path):
    exact = tmp_path / "exact.h5"
    simulate(make(tmp_path, SCENE, ["fluid.sums=null"]), exact)
    with open_trajectory(whole[0]) as run, open_trajectory(exact) as other:
        assert "sum_error" not in other.observables
        moved = abs(other.position[-1] - other.position[0]).max()
        # 1e-5 of the way, but for what the motion makes of it.
        assert abs(run.position[-1] - other.position[-1]).max() < 3e-5 * moved
        assert abs(run.tracers[-1] - other.tracers[-1]).max() < 3e-5 * moved


@pytest.mark.compiled
def test_info_says_what_sums_would_cost(tmp_path):
    (tmp_path / "case.yaml").write_text(SCENE)
    told = call("info", str(tmp_path / "case.yaml")).stdout
    assert "sums: fast; an evaluation takes about" in told
    assert "by exact sums (1.2e+05 pairs)" in told
    assert (
        "sums:" not in call("info", str(tmp_path / "case.yaml"), "--set", "fluid.sums=null").stdout
    )


@pytest.mark.compiled
def test_info_says_it_of_a_wall_and_a_held_end_too(tmp_path):
    (tmp_path / "case.yaml").write_text(SCENE)
    more = "--set", "fluid.wall={z: -4}", "--set", "rods.coil.start={hold: clamped}"
    told = call("info", str(tmp_path / "case.yaml"), *more).stdout
    assert "sums: fast; an evaluation takes about" in told


def test_the_parts_are_those_of_the_fluid_and_held_points_are_exact(tmp_path):
    clamped = ["rods.coil.end={hold: clamped}", "fluid.blob=algebraic9"]
    for change, home, exact, held in (
        ([], "spatial_7", "free:spatial_7", []),
        (["fluid.wall={z: -4}"], "wall_spatial_7", "wall:spatial_7", []),
        (clamped, "spatial_9", "free:spatial_9", [229]),
    ):
        scene = build_scene(make(tmp_path, SCENE, change))
        (part,) = (part for part in scene.parts.of(FLOW) if part.name == "fluid")
        assert part.kernel == f"rodsim.flows.fast.parts:{home}"
        assert part.prepare.__self__._held == held
        assert set(part.needs) == {"rodsim.flows.by_threads:share_out", f"rodsim.flows.{exact}"}


def test_an_accuracy_that_limits_the_run_is_warned_of(tmp_path):
    assert make(tmp_path, SCENE).warnings == ()
    (warning,) = make(tmp_path, SCENE, ["fluid.sums.accuracy=2e-5"]).warnings
    assert str(warning).endswith(
        "fluid.sums.accuracy = 2e-05: is more than a tenth of time.tolerance = 0.0001, and may be "
        "what limits the run: use 1e-05 or less"
    )
    fixed = ["time.integrator=euler", "time.step=1e-6", "fluid.sums.accuracy=2e-3"]
    assert not [w for w in make(tmp_path, SCENE, fixed).warnings if "sums" in w.key]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ("fluid.sums.accuracy=0.5", "fluid.sums.accuracy"),
        ("fluid.sums={}", "fluid.sums.accuracy"),
    ],
)
def test_what_cannot_be_is_refused(tmp_path, change, words):
    with pytest.raises(CaseError, match=words):
        make(tmp_path, SCENE, [change])


def smooth_coil(accuracy):
    """A long coil, free of stress but for a smooth and small disturbance."""
    return {
        "fluid": {"viscosity": 1.3, "epsilon": 0.5, "sums": {"accuracy": accuracy}},
        "rods": {"coil": {
            "shape": {"kind": "helix", "radius": 1.9, "pitch": 2.6, "points": 900, "length": 90},
            "strain_twist": "natural",
            "moduli": {"bending": 0.36, "twisting": 0.29, "shear": 21.0, "stretch": 17.0},
            "perturb": {"amplitude": 3e-6, "seed": 2, "modes": 40},
        }},
        "time": {"end": 1.0, "integrator": "euler", "step": 1e-2},
    }  # fmt: skip


@pytest.mark.compiled
@pytest.mark.parametrize("accuracy", [1e-2, 1e-3])
def test_no_mode_of_a_rod_at_rest_grows(accuracy):
    """Eigenvalues of the whole Jacobian; without the mobility that is added the largest is 1e-3."""
    scene = smooth_coil(accuracy)
    del scene["rods"]["coil"]["perturb"], scene["time"]
    scene["rods"]["coil"]["shape"] |= {"radius": 1.5, "pitch": 2.0, "points": 90, "length": 9}
    _, system = system_from(
        scene | {"fluid": scene["fluid"] | {"epsilon": 0.7}, "time": {"end": 1}}
    )
    rest, n, step = system.scene.initial, system.rod_size, 1e-6
    jacobian = np.empty((n, n))
    for k in range(n):
        rates = []
        for sign in (step, -step):
            y = system.zeros()
            y[k] = sign / system.weights[k]
            rates.append(system.rate(0.0, rest, y, system.zeros()))
        jacobian[:, k] = system.weights * (rates[0] - rates[1]) / (2 * step)
    values = np.linalg.eigvals(jacobian)
    # Rounding over the step of the difference: 1e-16/1e-6, times the condition of the vectors.
    assert values.real.max() < 1e-6 * abs(values).max()


@pytest.mark.compiled
@pytest.mark.long
@pytest.mark.parametrize("accuracy", [1e-3, 1e-5])
def test_the_energy_of_a_smooth_rod_near_rest_never_rises(accuracy):
    """A mobility that is not positive in the stiffest modes would let them grow.

    Noise would hide it: rough arcs are never far.
    """
    case, system = system_from(smooth_coil(accuracy))
    from rodsim.integrators.limits import stability

    size = 0.88 * stability(system).largest_steps["euler"]
    integrator = make_integrator(case.time.model_copy(update={"step": size}), system)
    energies, state = [], system.scene.initial
    for step in integrator.steps(state, 300 * size):
        _, seen = system.observe(step.end, np.zeros((6, 900)))
        energies.append(sum(seen[f"{name}_energy"].sum() for name in ENERGIES))
    assert energies[-1] < 0.9 * energies[0]
    assert (np.diff(energies) < 0.0).all()


@pytest.mark.compiled
@pytest.mark.long
def test_converge_tells_what_the_accuracy_costs_in_error(tmp_path):
    (tmp_path / "case.yaml").write_text(SCENE)
    where = str(tmp_path / "report")
    short = ("--set", "time.end=1e-3", "--set", "tracers=null")
    done = call("converge", str(tmp_path / "case.yaml"), "--in", "accuracy", "-o", where, *short)
    assert done.exit_code == 0, done.stderr
    with open(f"{where}.csv", newline="") as stream:
        rows = [r for r in csv.DictReader(stream) if r["section"] == "accuracy"]
    errors = [float(row["rms_error"]) for row in rows[:-1]]
    assert [float(row["value"]) for row in rows] == [10.0**-k for k in range(2, 9)] + [0.0]
    # Seven decades of accuracy; each is better than asked by a factor of its own.
    assert errors[-1] < 1e-4 * errors[0]
    assert rows[-1]["rms_error"] == ""

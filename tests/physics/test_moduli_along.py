"""Rods of moduli that vary along s, and rods at rest as they are built."""

import numpy as np
import pytest
from contents import differences

from rodsim import load_case, resume, simulate
from rodsim.errors import StoppedError
from rodsim.forces.elastic import ENERGIES
from rodsim.scene.build import build_scene
from rodsim.scene.evaluation import loads_of
from rodsim.scene.observe import Observer
from rodsim.scene.state import State

UNIFORM = "{bending: [3.1e-3, 4.7e-3], twisting: 2.3e-3, shear: [0.83, 0.71], stretch: 1.3}"
TAPERED = (
    '{bending: ["3.1e-3*(1.3 - 0.4*s)", "4.7e-3*exp(-s)"], twisting: "2.3e-3*(1 + s**2)", '
    'shear: ["0.83 + 0.1*s", 0.71], stretch: "1.3 - 0.3*s"}'
)
CASE = """
fluid: {{viscosity: 1.3e-6, epsilon: 0.31}}
rods:
  tail:
    shape: {shape}
    moduli: {moduli}
    strain_twist: {twist}
time: {{end: 3.0e-3, tolerance: 1.0e-5}}
output: {{interval: 5.0e-4}}
"""
HELIX = "{kind: helix, radius: 0.4, pitch: 1.1, points: 23, length: 2.2}"
SINE = "{kind: sine, amplitude: 0.3, wavelength: 2.1, phase: 0.4, points: 21, length: 2.3}"


def make(folder, moduli=TAPERED, shape=HELIX, twist="[0.9, 0.3, -0.7]"):
    (folder / "case.yaml").write_text(CASE.format(moduli=moduli, shape=shape, twist=twist))
    return load_case(folder / "case.yaml")


def energy(scene, state):
    seen = Observer(scene)(state, np.zeros((6, scene.rods.points)))[1]
    return float(sum(seen[name].sum() for name in ENERGIES))


def test_moduli_that_are_constant_give_the_loads_of_constants(tmp_path):
    """Expressions that happen to be constant along s go through the other kernel: same bits."""
    plain = build_scene(make(tmp_path, UNIFORM))
    other = build_scene(make(tmp_path, UNIFORM.replace("2.3e-3", '"2.3e-3 + 0*s"')))
    assert plain.along is None
    assert other.along is not None
    assert np.array_equal(loads_of(plain, plain.initial), loads_of(other, other.initial))
    assert energy(plain, plain.initial) == energy(other, other.initial)


def test_forces_are_the_gradient_of_the_energy(tmp_path):
    """g = -dE/dX on the rod is exact at any ds (docs/method.md); central differences of 1e-5 err
    by rounding, 1e-16 E/1e-5, and by h^2: E is quadratic in X at fixed triads, so not at all."""
    scene = build_scene(make(tmp_path))
    state, h = scene.initial, 1e-5
    force = loads_of(scene, state)[:3]
    for k in (0, 7, 22):
        for c in range(3):
            ends = []
            for sign in (1, -1):
                position = state.position.copy()
                position[c, k] += sign * h
                ends.append(energy(scene, State(0.0, position, state.director, state.tracer)))
            slope = (ends[0] - ends[1]) / (2 * h)
            assert force[c, k] == pytest.approx(-slope, abs=1e-8 * abs(force).max())


def test_the_energy_of_a_tapered_rod_is_the_integral_of_its_bending(tmp_path):
    """A helix of constant curvature and torsion against Omega = (0.9, 0.3, -0.7): the midpoint rule
    and the discrete strain 2 sin(theta/2)/ds err by O(ds^2), a quarter at half the spacing."""
    rise = 1.1 / (2 * np.pi)
    kappa, tau = 0.4 / (0.4**2 + rise**2), rise / (0.4**2 + rise**2)
    s = np.linspace(0, 2.2, 20001)
    density = 3.1e-3 * (1.3 - 0.4 * s) * (kappa - 0.9) ** 2 + 4.7e-3 * np.exp(-s) * 0.3**2
    exact = {
        "bending_energy": 0.5 * np.trapezoid(density, s),
        "twisting_energy": 0.5 * np.trapezoid(2.3e-3 * (1 + s**2) * (tau + 0.7) ** 2, s),
    }
    errors = []
    for points in (23, 45):
        shape = HELIX.replace("points: 23", f"points: {points}")
        scene = build_scene(make(tmp_path, shape=shape))
        seen = Observer(scene)(scene.initial, np.zeros((6, points)))[1]
        errors.append([seen[name][0] - value for name, value in exact.items()])
    coarse, fine = np.abs(errors)
    assert coarse / fine == pytest.approx([4.0, 4.0], rel=0.05)
    assert (fine < 5e-3 * np.array(list(exact.values()))).all()


@pytest.mark.parametrize("shape", [HELIX, SINE])
@pytest.mark.parametrize("moduli", [UNIFORM, TAPERED])
def test_a_natural_rod_is_free_of_stress(tmp_path, shape, moduli):
    scene = build_scene(make(tmp_path, moduli, shape, "natural"))
    stiff = 1.3 * 2.2  # stretch times length: strains of rounding, 1e-16, squared
    assert energy(scene, scene.initial) < 1e-28 * stiff
    # F = b times a strain of rounding of positions near 2, over ds
    assert abs(loads_of(scene, scene.initial)[:3]).max() < 1e-13


@pytest.mark.compiled
def test_a_natural_tapered_rod_goes_on_with_the_same_bits(tmp_path):
    case = make(tmp_path, TAPERED, SINE, '["natural_1 + 0.5*sin(900*t)", "natural_2", "natural_3"]')
    simulate(case, tmp_path / "whole.h5")
    made = [0]

    def stop():
        made[0] += 1
        return "the test" if made[0] == 9 else ""

    with pytest.raises(StoppedError):
        simulate(case, tmp_path / "out.h5", stop=stop)
    resume(tmp_path / "out.h5")
    assert differences(tmp_path / "out.h5", tmp_path / "whole.h5") == []

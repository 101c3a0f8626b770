"""The fastest rate against the eigenvalues of the whole Jacobian, where they lie close together."""

import numpy as np
import pytest

from rodsim.case import case_from_mapping
from rodsim.integrators.fastest_rate import FastestRate
from rodsim.integrators.limits import stability
from rodsim.scene.build import build_scene
from rodsim.scene.system import RodSystem


def system_of(points, spacings, blob, omega=0.1):
    """A rod whose fastest mode lies 3 to 10 % above a pair of equal ones."""
    shape = {"kind": "straight", "points": points, "spacing": 0.08, "perturbation": 1e-4}
    moduli = {"bending": 3.5e-3, "twisting": 3.5e-3, "shear": 0.8, "stretch": 0.8}
    rod = {"shape": shape, "moduli": moduli, "strain_twist": [omega, 0.0, omega]}
    fluid = {"viscosity": 1e-6, "epsilon": {"spacings": spacings}, "blob": blob}
    case = {"fluid": fluid, "rods": {"tail": rod}, "time": {"end": 1e-3}}
    return RodSystem(build_scene(case_from_mapping(case)))


def largest_eigenvalue(system):
    """Return the spectral radius of the Jacobian, column by column by central differences."""
    state, n, step = system.scene.initial, system.rod_size, 1e-6
    columns, scale = [], 1.0 / system.weights[:n]
    for k in range(n):
        y = system.zeros()
        y[k] = step * scale[k]
        ahead, behind = (system.rate(0.0, state, s * y, system.zeros())[:n] for s in (1, -1))
        columns.append((ahead - behind) / (2.0 * step * scale))
    return np.abs(np.linalg.eigvals(np.array(columns).T)).max()


HARD = [
    (16, 5.027, "algebraic9"),
    (16, 5.584, "algebraic9"),
    (20, 3.5, "algebraic9"),
    (21, 4.57, "algebraic7"),
    (20, 4.18, "algebraic7"),
]


@pytest.mark.compiled
@pytest.mark.parametrize(("points", "spacings", "blob"), HARD)
def test_the_fastest_rate_is_that_of_the_jacobian(points, spacings, blob):
    """Power iteration is 3.5 to 9 % low here. 60 random rods: 0.1 % low at worst, at first 3 %."""
    system = system_of(points, spacings, blob)
    exact = largest_eigenvalue(system)
    assert stability(system).rate == pytest.approx(exact, rel=5e-3)
    first = FastestRate(system)
    state = system.scene.initial
    rate = system.rate(0.0, state, system.zeros(), system.zeros())
    for _ in range(3):  # what rkc goes by, with 10 % more: the first estimate, then refreshed
        assert first.estimate(state, rate) == pytest.approx(exact, rel=0.03)

"""A tapered cantilever with a load at its tip, against a quadrature of its bending and shear."""

import numpy as np
import pytest
from scenes import last

from rodsim.case import case_from_mapping
from rodsim.integrators.make import make_integrator
from rodsim.scene.build import build_scene
from rodsim.scene.system import RodSystem

LENGTH, POINTS, FORCE = 5.0, 26, 7.0e-4
BENDING, SHEAR = "1.3*(1 - 0.14*s)", "40*(1 - 0.1*s)"
CASE = {
    "fluid": {"viscosity": 0.02, "epsilon": 0.4},
    "rods": {
        "beam": {
            "shape": {"kind": "straight", "points": POINTS, "length": LENGTH},
            "moduli": {"bending": BENDING, "twisting": 0.9, "shear": SHEAR, "stretch": 50.0},
            "start": {"hold": "clamped"},
            "loads": {"tip": {"at": "end", "force": [0.0, FORCE, 0.0]}},
        }
    },
    "time": {"end": 60.0, "tolerance": 1e-6},
}


def deflection(s):
    """y(s) = F int_0^s (s - x)(L - x)/a(x) dx + F int_0^s dx/b(x), small deflections."""
    x, weights = np.polynomial.legendre.leggauss(30)
    x, weights = 0.5 * s * (x + 1.0), 0.5 * s * weights
    bending, shear = 1.3 * (1.0 - 0.14 * x), 40.0 * (1.0 - 0.1 * x)
    return FORCE * (weights @ ((s - x) * (LENGTH - x) / bending + 1.0 / shear))


@pytest.mark.compiled
def test_deflection_is_that_of_the_quadrature():
    """Within 0.3 %: slopes are (3/L) y = 1.5 %, so 1e-4 by the small angle, and the half weight
    of the last segment's curvature makes O(ds^2), 0.2 %. Without the taper it is 28 % less."""
    case = case_from_mapping(CASE)
    system = RodSystem(build_scene(case))
    end = last(make_integrator(case.time, system).steps(system.scene.initial, case.time.end)).end
    for point in (POINTS // 2, POINTS - 1):
        expected = deflection(point * LENGTH / (POINTS - 1))
        assert abs(end.position[1, point] / expected - 1.0) < 3e-3
    _, seen = system.observe(end)
    np.testing.assert_allclose(seen["anchor_force"][0], [0.0, -FORCE, 0.0], atol=1e-7)
    np.testing.assert_allclose(seen["anchor_torque"][0], [FORCE * LENGTH, 0, 0], rtol=1e-3)

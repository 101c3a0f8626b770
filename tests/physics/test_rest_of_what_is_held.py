"""States at rest of rods that are held, and of rods in contact."""

from math import pi

import numpy as np
import pytest

pytest.importorskip("scipy")

from rodsim.case import case_from_mapping
from rodsim.errors import UsageError
from rodsim.forces.near import repulsion_stiffness
from rodsim.rest.solve import find_rest
from rodsim.rest.start import at_time, start_from_case
from rodsim.scene.build import build_scene
from rodsim.scene.evaluation import loads_of
from rodsim.scene.state import State

MODULI = {"bending": 1.3, "twisting": 0.9, "shear": 52.0, "stretch": 52.0}


def column(load, hold="clamped", points=31, length=6.0):
    rod = {
        "shape": {"kind": "straight", "points": points, "length": length},
        "moduli": MODULI,
        "start": {"hold": hold},
        "loads": {"tip": {"at": "end", "force": [0.0, 0.0, -load * 1.3 / length**2]}},
    }
    case = {"fluid": {"viscosity": 0.3, "epsilon": 0.5}, "rods": {"column": rod},
            "time": {"end": 2.0}}  # fmt: skip
    return build_scene(case_from_mapping(case))


@pytest.mark.compiled
@pytest.mark.parametrize(("load", "growing"), [(0.98 * pi**2 / 4, 0), (1.02 * pi**2 / 4, 2)])
def test_euler_buckling_of_a_clamped_column(load, growing):
    """pi^2/4 = 2.4674; shear and stretch lower it by F/b = 0.2 % here, the lattice by 0.1 %.

    Two growing modes, one for each direction across the column."""
    found = find_rest(column(load), saddle=True)
    assert found.failure == ""
    assert found.growing == growing


def test_stiffness_of_contact_is_that_of_its_loads():
    """Central differences of step 1e-6: errors of h^2 and of rounding/h, both about 1e-10."""
    rod = {"moduli": MODULI, "shape": {"kind": "straight", "points": 9, "length": 2.3}}
    turned = {**rod["shape"], "rotate": {"axis": [1, 0.2, 0], "degrees": 70},
              "origin": [0.31, 0.9, 0.7]}  # fmt: skip
    case = {
        "fluid": {"viscosity": 0.3, "epsilon": 0.6}, "contact": {},
        "rods": {"one": rod, "two": {**rod, "shape": turned}}, "time": {"end": 2.0},
    }  # fmt: skip
    scene = build_scene(case_from_mapping(case))
    part = next(part for part in scene.parts if part.name == "contact")
    n, X = scene.rods.points, scene.initial.position
    found = np.zeros((n, 3, n, 3))
    for i, j, block in zip(*repulsion_stiffness(X, scene.rods, part.fixed), strict=True):
        found[i, :, j] += block
    assert abs(found).max() > 1.0
    alone = build_scene(case_from_mapping({**case, "contact": None}))

    def loads(position):
        state = State(0.0, position, scene.initial.director, scene.initial.tracer)
        return (loads_of(scene, state) - loads_of(alone, state))[:3]

    for k, c in ((2, 0), (5, 1), (12, 2)):
        step = np.zeros_like(X)
        step[c, k] = 1e-6
        slope = -(loads(X + step) - loads(X - step)) / 2e-6
        np.testing.assert_allclose(found[:, :, k, c].T, slope, atol=1e-7)


def test_held_ends_are_where_they_are_at_the_time_that_is_looked_at():
    """Here a clamp moves: at rest at a time it is there, and what moves asks for a time."""
    rod = {
        "shape": {"kind": "straight", "points": 9, "length": 2.3},
        "moduli": MODULI,
        "start": {"hold": "clamped", "move": {"displace": [0.0, "0.3*t", 0.0]}},
        "end": {"hold": "clamped", "move": {"turn": ["0.2*t", 0.0, 0.0]}},
    }
    case = case_from_mapping({
        "fluid": {"viscosity": 0.3, "epsilon": 0.6}, "rods": {"beam": rod}, "time": {"end": 5.0},
    })  # fmt: skip
    with pytest.raises(UsageError, match="depends on time: say with --at"):
        at_time(start_from_case(case), None)
    built = build_scene(case).initial
    start = start_from_case(case)
    found = at_time(start, 2.0).scene.initial
    assert found.position[:, 0] == pytest.approx(built.position[:, 0] + [0.0, 0.6, 0.0], abs=1e-15)
    # D3 turns from z by the angle 0.4 about x, towards -y
    assert found.director[2, :, -1] == pytest.approx([0, -np.sin(0.4), np.cos(0.4)], abs=1e-14)
    assert np.array_equal(found.position[:, 1:-1], built.position[:, 1:-1])
    assert found.time == 2.0
    assert np.array_equal(start.scene.initial.position, built.position)  # what it came from stays
    at_first = at_time(start, 0.0).scene.initial
    assert np.array_equal(at_first.position, built.position)

"""What is refused of bodies and what they hold, by name; what is warned of when it happens."""

from copy import deepcopy
from dataclasses import replace

import numpy as np
import pytest

from rodsim.blocks.distance import distance
from rodsim.case import case_from_mapping
from rodsim.errors import CaseError
from rodsim.scene.build import build_scene
from rodsim.scene.clearance import deepest_point

CASE = {
    "fluid": {"viscosity": 0.3, "epsilon": 0.4},
    "bodies": {"cell": {"shape": {"kind": "sphere", "radius": 0.7, "points": 20}}},
    "rods": {
        "tail": {
            "shape": {"kind": "straight", "points": 7, "length": 1.2, "origin": [0, 0, 0.7]},
            "moduli": {"bending": 1.3, "twisting": 0.9, "shear": 52.0, "stretch": 51.0},
            "start": {"hold": "clamped", "to": "cell"},
        }
    },
    "time": {"end": 2.0},
}


def scene_with(**changes):
    """Build the scene with other values, keys joined by two underscores."""
    data = deepcopy(CASE)
    for path, value in changes.items():
        *above, key = path.split("__")
        place = data
        for name in above:
            place = place[name]
        place[key] = value
    return build_scene(case_from_mapping(data))


SECOND = {"kind": "spheroid", "length": 1.8, "radius": 0.5, "points": 20, "origin": [0, 0.8, 0]}


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"rods__tail__shape__origin": [0, 0, 0.2], "rods__tail__start__gap": True},
         "point 1 lies 0.3 inside body 'cell'"),
        ({"rods__tail__shape__origin": [0, 0, 1.2]}, "is 0.5 from the surface of 'cell'"),
        ({"bodies__other": {"shape": SECOND}}, "overlaps body 'cell'"),
        ({"fluid__wall": {"z": -0.6}}, "is at z = -0.6[0-9]*: must be above the wall, z = -0.6"),
        ({"rods__tail__start__to": "cel"}, "no such body: did you mean 'cell'"),
        ({"plane": "yz"}, "a planar scene has no bodies"),
    ],
)  # fmt: skip
def test_what_is_refused(changes, said):
    with pytest.raises(CaseError, match=said):
        scene_with(**changes)


@pytest.mark.parametrize("z", [0.4, 1.05])
def test_a_held_point_may_lie_within_epsilon_of_the_surface(z):
    origin = {"rods__tail__shape__origin": [0, 0, z], "rods__tail__shape__points": 3}
    assert scene_with(**origin).bodies[0].name == "cell"


def test_the_deepest_point_of_a_run_is_found_where_the_body_has_gone():
    scene = scene_with()
    assert deepest_point(scene, scene.initial) == (0.0, -1, None)
    position = scene.initial.position.copy()
    position[:, scene.bodies[0].node] += [0.05, 0.0, 0.6]
    depth, point, body = deepest_point(scene, replace(scene.initial, position=position))
    assert (point, body.name) == (1, "cell")  # z = 0.9; the held one, z = 0.7, does not count
    assert depth == pytest.approx(0.7 - np.hypot(0.05, 0.3), rel=1e-12)


@pytest.mark.parametrize(
    ("shape", "points", "expected"),
    [
        ({"kind": "sphere", "radius": 0.7}, [[0.3, 0.4, 1.2]], [0.6]),
        ({"kind": "spherocylinder", "length": 2.6, "radius": 0.5},
         [[0.3, 0.4, 0.6], [0.0, 0.0, 1.5], [0.1, 0, -0.2]], [0.0, 0.2, -0.4]),
        ({"kind": "spheroid", "length": 2.6, "radius": 0.5},
         [[0.3, 0.4, 0.0], [0.0, 0.0, -1.301], [0.501, 0, 0], [0, 0, 0]], [0, 1e-3, 1e-3, -0.5]),
    ],
)  # fmt: skip
def test_distances_from_surfaces(shape, points, expected):
    """Exact; of the spheroid to first order, so 1e-3 to the square of it over a curvature radius,
    (b^2/a = 0.19): 5e-6."""
    kind = type("Shape", (), shape)
    found = distance(kind, None, np.array(points).T)
    np.testing.assert_allclose(found, expected, atol=6e-6)

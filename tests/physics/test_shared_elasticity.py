"""The loads of very many points, which threads share out: the same bits as one after another."""

import numba
import numpy as np
import pytest

from rodsim.case import case_from_mapping
from rodsim.forces import elasticity, shared_elasticity
from rodsim.forces.elastic import MANY
from rodsim.forces.shared_elasticity import RUN
from rodsim.nodes import lay_out
from rodsim.scene.build import build_scene

MODULI = np.array([3.1e-3, 4.7e-3, 2.3e-3, 0.83, 0.71, 1.3])  # nothing equal, nothing 1
NAMES = "bending", "twisting", "shear", "stretch"
KINDS = {
    "a ring over the ends of runs": [(2 * RUN + 3, True, 0.13)],
    "a ring whose last point begins a run": [(RUN + 1, True, 0.13), (7, False, 0.2)],
    "one that ends with a run, and others": [
        (RUN, False, 0.13),
        (5, True, 0.4),
        (RUN, True, 0.2),
    ],
    "rods cut by the end of a run": [(RUN - 1, True, 0.13), (9, False, 0.3)],
}


@pytest.mark.parametrize("kinds", KINDS.values(), ids=KINDS)
@pytest.mark.parametrize("varying", [False, True], ids=["uniform", "varying"])
def test_threads_leave_no_trace(kinds, varying):
    rods = lay_out((f"rod{i}", *kind, MODULI) for i, kind in enumerate(kinds))
    n, rng = rods.points, np.random.default_rng(5)
    X = np.cumsum(rng.normal(size=(3, n)), axis=1)
    D = np.linalg.qr(rng.normal(size=(3, 3)))[0][:, :, None] + 0.05 * rng.normal(size=(3, 3, n))
    omega, along = rng.normal(size=(3, n)), rng.uniform(0.3, 0.7, (9, n) if varying else (0, 0))
    name = "_varying_loads" if varying else "_uniform_loads"
    expected = rng.normal(size=(6, n))  # loads are added to what is there
    start = expected.copy()
    getattr(elasticity, name)(X, D, omega, rods.tables, along, expected)
    assert np.isfinite(expected).all()
    assert (expected != start).all()
    for threads in {1, numba.config.NUMBA_NUM_THREADS}:
        numba.set_num_threads(threads)
        loads = start.copy()
        getattr(shared_elasticity, name)(X, D, omega, rods.tables, along, loads)
        assert np.array_equal(loads, expected), f"on {threads} threads"


@pytest.mark.parametrize("moduli", ["1.3e-2", "1.3e-2*(1 + s/7)"], ids=["uniform", "varying"])
@pytest.mark.parametrize("points", [MANY - 1, MANY])
def test_a_scene_of_many_points_lists_the_threads_part(points, moduli):
    shape = {"kind": "straight", "points": points, "length": 5.3}
    rod = {"shape": shape, "moduli": dict(zip(NAMES, (moduli, 2.3e-2, 0.8, 0.83), strict=True))}
    fluid = {"viscosity": 0.7, "epsilon": {"spacings": 4}}
    case = case_from_mapping({"fluid": fluid, "rods": {"rod": rod}, "time": {"end": 0.1}})
    (elastic,) = [part for part in build_scene(case).parts if part.name == "elastic"]
    room = "shared_elasticity" if points >= MANY else "elasticity"
    kind = "varying" if "s" in moduli else "elastic"
    assert elastic.kernel == f"rodsim.forces.{room}:{kind}_loads"

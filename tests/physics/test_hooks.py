"""A rod that hangs on a hook, at rest under loads: angles by the moments over the stiffnesses."""

import numpy as np
import pytest
from acting import changed
from scenes import end_of, system_from

from rodsim.integrators.limits import stability

LENGTH, BENDING, TWIST, SHEAR, HOOK, HOOK_TWIST = 2.0, 0.5, 0.4, 300.0, 0.3, 0.2
HUNG = {
    "fluid": {"viscosity": 1.3, "epsilon": 0.2},
    "rods": {"rod": {"shape": {"kind": "straight", "points": 21, "length": LENGTH},
                     "moduli": {"bending": BENDING, "twisting": TWIST, "shear": SHEAR,
                                "stretch": SHEAR},
                     "start": {"hold": "clamped", "hook": {"bending": HOOK,
                                                           "twisting": HOOK_TWIST}}}},
    "time": {"end": 2000.0, "tolerance": 1e-7},
}  # fmt: skip


def at_rest(**tip):
    state, system = end_of(changed(HUNG, {"rods.rod.loads": {"tip": {"at": "end", **tip}}}))
    return state, system.observe(state)[1]


@pytest.mark.compiled
def test_a_force_bends_the_hook_and_the_rod():
    """y = F L^2/k + F L^3/(3 A) + F L/b at the tip; seen: 0.02 % off, the points' O(ds^2)."""
    force = 1e-3
    state, seen = at_rest(force=[0, force, 0])
    hook = force * LENGTH**2 / HOOK
    rod = force * LENGTH**3 / (3 * BENDING) + force * LENGTH / SHEAR
    assert state.position[1, -1] == pytest.approx(hook + rod, rel=1e-3)
    assert seen["hook_energy"] == pytest.approx([0.5 * (force * LENGTH) ** 2 / HOOK], rel=1e-3)
    assert seen["anchor_force"][0] == pytest.approx([0, -force, 0], abs=1e-3 * force)
    assert seen["anchor_torque"][0] == pytest.approx([force * LENGTH, 0, 0], abs=2e-6)


@pytest.mark.compiled
def test_a_torque_twists_the_hook_and_the_rod():
    """The last triad is turned by T/k_t + T L/C."""
    torque = 0.02
    state, seen = at_rest(torque=[0, 0, torque])
    turn = np.arctan2(state.director[0, 1], state.director[0, 0])
    assert turn[0] == pytest.approx(torque / HOOK_TWIST, rel=1e-4)
    assert turn[-1] == pytest.approx(torque / HOOK_TWIST + torque * LENGTH / TWIST, rel=1e-3)
    assert seen["hook_energy"] == pytest.approx([0.5 * torque**2 / HOOK_TWIST], rel=1e-3)
    assert seen["anchor_torque"][0] == pytest.approx([0, 0, -torque], abs=1e-4 * torque)


@pytest.mark.compiled
def test_a_hook_that_keeps_twist_lets_none_through():
    tip = {"at": "end", "torque": [0, 0, 0.02]}
    words = {"rods.rod.start.hook.twisting": "stiff", "rods.rod.loads": {"tip": tip}}
    stiff = changed(HUNG, {**words, "time.end": 60.0})
    state, _ = end_of(stiff)
    turn = np.arctan2(state.director[0, 1], state.director[0, 0])
    assert turn[0] == pytest.approx(0.0, abs=1e-12)
    assert turn[-1] == pytest.approx(0.02 * LENGTH / TWIST, rel=1e-3)


def test_a_soft_hook_does_not_raise_the_fastest_rate():
    """Up to the stiffness of a segment, A/ds; 50 times that does."""
    held = {"rods.rod.shape.points": 13, "fluid.epsilon": 0.33, "rods.rod.start.hook": None}
    rates = {}
    for times in (None, 1.0, 50.0):
        hook = times and {"bending": times * BENDING / (LENGTH / 12)}
        case = changed(HUNG, {**held, "rods.rod.start.hook": hook})
        rates[times] = stability(system_from(case)[1]).rate
    assert rates[1.0] < 1.05 * rates[None]
    assert rates[50.0] > 1.5 * rates[None]

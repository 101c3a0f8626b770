"""The fast sums as parts; ``fixed`` as of :mod:`rodsim.flows.fast.packed`."""

import numpy as np

from rodsim.compiled.kernels import part
from rodsim.flows.blobs import ALGEBRAIC7, ALGEBRAIC9
from rodsim.flows.fast.held import move_held, velocities_of_held
from rodsim.flows.fast.packed import EPSILON, WALL
from rodsim.flows.fast.sums import (
    FLOW_7,
    FLOW_9,
    PLANAR_7,
    PLANAR_9,
    SPATIAL_7,
    SPATIAL_9,
    TURNING_7,
    TURNING_9,
    WALL_FLOW_7,
    WALL_FLOW_9,
    WALL_PLANAR_7,
    WALL_PLANAR_9,
    WALL_SPATIAL_7,
    WALL_SPATIAL_9,
    WALL_TURNING_7,
    WALL_TURNING_9,
)
from rodsim.flows.parts import drop_below, touches

_SUMS = {  # by whether there is a wall, and whether the scene is planar
    (False, False): (SPATIAL_7, SPATIAL_9),
    (False, True): (PLANAR_7, PLANAR_9),
    (True, False): (WALL_SPATIAL_7, WALL_SPATIAL_9),
    (True, True): (WALL_PLANAR_7, WALL_PLANAR_9),
}
_GROUPS = {  # by whether there is a wall, and whether w is wanted
    (False, False): (FLOW_7, FLOW_9),
    (False, True): (TURNING_7, TURNING_9),
    (True, False): (WALL_FLOW_7, WALL_FLOW_9),
    (True, True): (WALL_TURNING_7, WALL_TURNING_9),
}
# No sample. Not a plain False: Numba would compile the sum once more, for that value alone.
WHOLE = np.bool_(False)


def sum_kernel(blob, planar=False, walled=False):
    """Return ``kernel(fixed, points, loads, sampled, out)`` at the sources themselves."""
    return _SUMS[walled, planar][blob == ALGEBRAIC9]


def group_kernel(blob, angular=False, walled=False):
    """Return ``kernel(fixed, targets, points, loads, sampled, out)``, with w where asked for."""
    return _GROUPS[walled, angular][blob == ALGEBRAIC9]


def _free_rods(blob, planar):
    """Make the part that moves rods in free fluid."""
    seven = blob == ALGEBRAIC7

    @part
    def move_rods(row, fixed, rods, state, loads, velocities):
        points, out = state[0], velocities[0]
        before = velocities_of_held(fixed, out)
        if planar:
            if seven:
                PLANAR_7(fixed, points, loads, WHOLE, out)
            else:
                PLANAR_9(fixed, points, loads, WHOLE, out)
        elif seven:
            SPATIAL_7(fixed, points, loads, WHOLE, out)
        else:
            SPATIAL_9(fixed, points, loads, WHOLE, out)
        move_held(fixed, points, loads, before, out)

    return move_rods


def _rods_at_wall(blob, planar):
    """Make the part that moves rods above a wall."""
    seven = blob == ALGEBRAIC7

    @part
    def move_rods(row, fixed, rods, state, loads, velocities):
        points, out = state[0], velocities[0]
        before = velocities_of_held(fixed, out)
        if touches(points, fixed[WALL]):
            out[:] = np.nan  # no fluid there: the step is rejected
            return
        if planar:
            if seven:
                WALL_PLANAR_7(fixed, points, loads, WHOLE, out)
            else:
                WALL_PLANAR_9(fixed, points, loads, WHOLE, out)
        elif seven:
            WALL_SPATIAL_7(fixed, points, loads, WHOLE, out)
        else:
            WALL_SPATIAL_9(fixed, points, loads, WHOLE, out)
        move_held(fixed, points, loads, before, out)

    return move_rods


def _free_tracers(blob):
    """Make the part that moves tracers in free fluid."""
    seven = blob == ALGEBRAIC7

    @part
    def move_tracers(row, fixed, rods, state, loads, velocities):
        if seven:
            FLOW_7(fixed, state[2], state[0], loads, WHOLE, velocities[1])
        else:
            FLOW_9(fixed, state[2], state[0], loads, WHOLE, velocities[1])

    return move_tracers


def _tracers_at_wall(blob):
    """Make the part that moves tracers above a wall."""
    seven = blob == ALGEBRAIC7

    @part
    def move_tracers(row, fixed, rods, state, loads, velocities):
        if seven:
            WALL_FLOW_7(fixed, state[2], state[0], loads, WHOLE, velocities[1])
        else:
            WALL_FLOW_9(fixed, state[2], state[0], loads, WHOLE, velocities[1])
        drop_below(state[2], fixed[WALL], fixed[EPSILON], velocities[1])

    return move_tracers


spatial_7, spatial_9 = (_free_rods(blob, False) for blob in (ALGEBRAIC7, ALGEBRAIC9))
planar_7, planar_9 = (_free_rods(blob, True) for blob in (ALGEBRAIC7, ALGEBRAIC9))
tracers_7, tracers_9 = (_free_tracers(blob) for blob in (ALGEBRAIC7, ALGEBRAIC9))
wall_spatial_7, wall_spatial_9 = (_rods_at_wall(blob, False) for blob in (ALGEBRAIC7, ALGEBRAIC9))
wall_planar_7, wall_planar_9 = (_rods_at_wall(blob, True) for blob in (ALGEBRAIC7, ALGEBRAIC9))
wall_tracers_7, wall_tracers_9 = (_tracers_at_wall(blob) for blob in (ALGEBRAIC7, ALGEBRAIC9))

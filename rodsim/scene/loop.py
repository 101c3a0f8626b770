"""The one evaluation of all scenes: the sum of its parts, at increments from a state.

Nothing here knows what acts in a scene: parts are called by their addresses, without a Python call
in between.
"""

import numpy as np

from rodsim.compiled.flags import (
    INT_MAT,
    MAT,
    RODS,
    STATE,
    TRIADS,
    VEC,
    call_part,
    inline,
    kernel,
)
from rodsim.compiled.kernels import evaluation
from rodsim.compiled.rotations import displace, rotation_vector_rate
from rodsim.scene.calls import (
    ACCOUNT,
    ADDRESS,
    DRIVEN,
    FIXED,
    FIXED_END,
    GAUGES,
    IS_FLOW,
    ROW,
    ROW_END,
)

CALLS = f"{INT_MAT}, {VEC}"  # scene.calls.Calls: table, numbers


@inline
def to_increments(y, velocities):
    """Turn velocities at increments ``y`` into dy/dt, in place: w becomes d theta/dt.

    What comes after the rods' 6 N numbers must have been cut off both vectors.
    """
    n = y.size // 6
    rotation_vector_rate(y[3 * n :].reshape(3, n), velocities[3 * n :].reshape(3, n))


@inline
def _clear(array):
    for c in range(array.shape[0]):
        for k in range(np.uint64(array.shape[1])):
            array[c, k] = 0.0


@inline
def _add(share, total):
    for c in range(total.shape[0]):
        for k in range(np.uint64(total.shape[1])):
            total[c, k] += share[c, k]


@inline
def _product(a, b):
    """Return sum (g.u + m.w)."""
    total = 0.0
    for c in range(a.shape[0]):
        for k in range(np.uint64(a.shape[1])):
            total += a[c, k] * b[c, k]
    return total


@kernel(f"void({CALLS}, {VEC}, {RODS}, {STATE}, {MAT}, UniTuple({MAT}, 2), {TRIADS})")
def evaluate(table, numbers, driven, rods, state, loads, velocities, own):
    """Let every part of a list add to the loads (6, N) and to the velocities (6, N), (3, P).

    driven : the driven rows at the time of the state. own (Q, 6, N): of each of the Q parts whose
    work is counted, its own loads, or the velocities of the rods that are its own.
    """
    for k in range(table.shape[0]):
        row = (driven if table[k, DRIVEN] else numbers)[table[k, ROW] : table[k, ROW_END]]
        constants, account = numbers[table[k, FIXED] : table[k, FIXED_END]], table[k, ACCOUNT]
        address = table[k, ADDRESS]
        if account < 0:
            call_part(address, row, constants, rods, state, loads, velocities)
            continue
        mine = own[account]
        _clear(mine)
        if table[k, IS_FLOW]:
            call_part(address, row, constants, rods, state, loads, (mine, velocities[1]))
            _add(mine, velocities[0])
        else:
            call_part(address, row, constants, rods, state, mine, velocities)
            _add(mine, loads)


@inline
def powers(table, numbers, loads, velocities, own, out):
    """Write the power of each account, what the fluid dissipates, all gauges: (Q + 1 + G,).

    Of a force P = sum (g.u + m.w) with its own loads; of a flow u_inf, w_inf
    P = -sum (g.u_inf + m.w_inf) with all loads. dissipated = sum (g.u + m.w) + the P of all flows,
    so that the elastic energy follows dE/dt = sum P - dissipated, to O(ds^2).
    """
    dissipated = _product(loads, velocities)
    for k in range(table.shape[0]):
        account = table[k, ACCOUNT]
        if account < 0:
            continue
        if table[k, IS_FLOW]:
            out[account] = -_product(loads, own[account])
            dissipated += out[account]
        else:
            out[account] = _product(own[account], velocities)
    place = own.shape[0]
    out[place] = dissipated
    for k in range(table.shape[0]):
        for i in range(table[k, FIXED_END] - table[k, GAUGES], table[k, FIXED_END]):
            place += 1
            out[place] = numbers[i]


@evaluation
def velocities_at(table, numbers, driven, rods, base, work, y, out):
    """Write the velocities (u, w, u at the tracers, powers of the ledger) into ``out``.

    They are those at the increments ``y`` from the state ``base``, which is left displaced by them
    in ``work``. driven : the driven rows at its time.
    """
    state, loads, own = work
    n, markers = loads.shape[1], state[2].shape[1]
    rods_end, tracers_end = 6 * n, 6 * n + 3 * markers
    displace(base, y[:tracers_end], state)
    _clear(loads)
    for i in range(np.uint64(out.size)):
        out[i] = 0.0
    velocities = out[:rods_end].reshape(6, n), out[rods_end:tracers_end].reshape(3, markers)
    evaluate(table, numbers, driven, rods, state, loads, velocities, own)
    if out.size > tracers_end:
        powers(table, numbers, loads, velocities[0], own, out[tracers_end:])

"""Velocity, angular velocity and pressure of the fluid from point forces and torques.

For notebooks and tests: arrays are (n, 3), one row per point. A run calls the kernels of
``free.py`` on its own (3, n) arrays.
"""

import numpy as np

from rodsim.compiled.threads import computing
from rodsim.errors import UsageError
from rodsim.flows.blobs import BLOBS
from rodsim.flows.free import pressure_kernel, velocity_kernel

__all__ = ["BLOBS", "pressure", "pressure_kernel", "velocity", "velocity_kernel"]


def velocity(
    targets, sources, forces, torques, epsilon, viscosity, *, blob="algebraic7", angular=True
):
    """Return linear and angular velocity at ``targets``, eqs. (32), (33), (61), (66).

    Parameters
    ----------
    targets : (T, 3) array, length. Any points, also the sources themselves.
    sources : (N, 3) array, length. Where the forces and torques act.
    forces, torques : (N, 3) arrays. Point force (mass length time^-2) and point torque
        (mass length^2 time^-2) that the sources exert on the fluid.
    epsilon : float > 0, length. Blob size.
    viscosity : float > 0, mass length^-1 time^-1.
    blob : ``"algebraic7"``, eq. (12), or ``"algebraic9"``, eq. (13).
    angular : with False the second sum is not computed and None returned for it.

    Returns
    -------
    linear : (T, 3) array, length/time; angular : (T, 3) array, 1/time, half the vorticity.

    Raises
    ------
    UsageError : a shape, the blob's name, epsilon or viscosity cannot be used.
    """
    targets, sources, loads = _arrays(targets, sources, forces, torques)
    kernel = velocity_kernel(_blob(blob), False, bool(angular))
    out = np.zeros((6 if angular else 3, targets.shape[1]))
    fluid = _positive(epsilon, "epsilon"), _positive(viscosity, "viscosity")
    with computing():
        kernel(targets, sources, loads, *fluid, out)
    return out[:3].T.copy(), (out[3:].T.copy() if angular else None)


def pressure(targets, sources, forces, epsilon, *, blob="algebraic7"):
    """Return the pressure (T,) at ``targets``, p = sum (g.r) Q, eq. (62); torques add nothing.

    Arguments as in :func:`velocity`; units mass length^-1 time^-2, zero far away.
    """
    targets, sources, loads = _arrays(targets, sources, forces, np.zeros_like(forces, dtype=float))
    out = np.empty(targets.shape[1])
    kernel, epsilon = pressure_kernel(_blob(blob)), _positive(epsilon, "epsilon")
    with computing():
        kernel(targets, sources, loads, epsilon, out)
    return out


def _arrays(targets, sources, forces, torques):
    arrays = [np.atleast_2d(np.asarray(a, float)) for a in (targets, sources, forces, torques)]
    if any(a.ndim != 2 or a.shape[1] != 3 for a in arrays):
        raise UsageError("targets, sources, forces and torques must be arrays of shape (n, 3)")
    if len({len(a) for a in arrays[1:]}) != 1:
        raise UsageError("sources, forces and torques must have the same number of rows")
    targets, sources, forces, torques = (np.ascontiguousarray(a.T) for a in arrays)
    return targets, sources, np.concatenate([forces, torques])


def _blob(name):
    if name not in BLOBS:
        raise UsageError(f"blob must be one of {', '.join(BLOBS)}, not {name!r}")
    return BLOBS[name]


def _positive(value, name):
    if not value > 0.0:
        raise UsageError(f"{name} must be > 0, not {value}")
    return float(value)

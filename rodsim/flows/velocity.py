"""Velocity, angular velocity and pressure of the fluid from point forces and torques.

For notebooks and tests: arrays are (n, 3), one row per point. A run calls the kernels of
``free.py`` and ``wall.py`` on its own (3, n) arrays.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rodsim.compiled.constants import DEVICES, GPU
from rodsim.compiled.threads import computing
from rodsim.errors import UsageError
from rodsim.flows.blobs import BLOBS
from rodsim.flows.by_threads import pressure_kernel, velocity_kernel

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

__all__ = ["BLOBS", "pressure", "pressure_kernel", "velocity", "velocity_kernel"]


def velocity(
    targets: ArrayLike,
    sources: ArrayLike,
    forces: ArrayLike,
    torques: ArrayLike,
    epsilon: float,
    viscosity: float,
    *,
    blob: str = "algebraic7",
    angular: bool = True,
    wall: float | None = None,
    accuracy: float | None = None,
    rods: ArrayLike | None = None,
    device: str = "cpu",
) -> tuple[np.ndarray, np.ndarray | None]:
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
    wall : float, length, or None. Height z of a plane wall without slip; the fluid is above it,
        where all sources must be. Formulas: ``flows/images.py``.
    accuracy : float, 1e-12 to 0.1, or None. With it the sums are fast instead of exact, to this
        relative error, root mean square over the targets: for sources along curves, one after
        another, thousands of them (docs/large.md).
    rods : how many of the sources each curve has, in order; by default all are one curve.
    device : ``"cpu"``, or ``"gpu"`` for exact sums on an NVIDIA card (docs/large.md).

    Returns
    -------
    linear : (T, 3) array, length/time; angular : (T, 3) array, 1/time, half the vorticity.
        NaN for targets below the wall, where there is no fluid.

    Raises
    ------
    UsageError : a shape, the blob's name, epsilon, viscosity, the wall's height, the accuracy,
        the numbers of sources or the device cannot be used; a source is at the wall or below it;
        the accuracy cannot be reached.
    """
    targets, sources, loads = _arrays(targets, sources, forces, torques)
    fluid = _positive(epsilon, "epsilon"), _positive(viscosity, "viscosity")
    _blob(blob)
    if device not in DEVICES:
        raise UsageError(f"device must be one of {', '.join(DEVICES)}, not {device!r}")
    if device == GPU and accuracy is not None:
        raise UsageError("fast sums are for the CPU: leave out accuracy, or device='gpu'")
    if accuracy is not None:
        out = _fast(targets, sources, loads, fluid, blob, bool(angular), wall, accuracy, rods)
        return out[:3].T.copy(), (out[3:].T.copy() if angular else None)
    if rods is not None:
        raise UsageError("rods is for the fast sums: give accuracy too")
    height = _height(wall, sources)
    out = np.zeros((6 if angular else 3, targets.shape[1]))
    if device == GPU:
        from rodsim.flows.card.device import add_on_card

        choice = wall is not None, blob, bool(angular)
        add_on_card(*choice, targets, sources, loads, *fluid, height, out)
    else:
        kernel = velocity_kernel(_blob(blob), False, bool(angular), wall is not None)
        with computing():
            kernel(targets, sources, loads, *fluid, height, out)
    out[:, _below(targets, wall)] = np.nan
    return out[:3].T.copy(), (out[3:].T.copy() if angular else None)


def pressure(
    targets: ArrayLike,
    sources: ArrayLike,
    forces: ArrayLike,
    epsilon: float,
    *,
    blob: str = "algebraic7",
    wall: float | None = None,
    torques: ArrayLike | None = None,
) -> np.ndarray:
    """Return the pressure (T,) at ``targets``, p = sum (g.r) Q, eq. (62).

    Torques add nothing in free space. At a wall they do: there ``torques`` must be given. Other
    arguments as in :func:`velocity`; units mass length^-1 time^-2, zero far away.
    """
    if torques is None and wall is not None:
        raise UsageError(
            "at a wall torques make pressure too: give torques=..., zeros where there are none"
        )
    torques = np.zeros_like(forces, dtype=float) if torques is None else torques
    targets, sources, loads = _arrays(targets, sources, forces, torques)
    height = _height(wall, sources)
    out = np.zeros(targets.shape[1])
    kernel = pressure_kernel(_blob(blob), wall is not None)
    epsilon = _positive(epsilon, "epsilon")
    with computing():
        kernel(targets, sources, loads, epsilon, height, out)
    out[_below(targets, wall)] = np.nan
    return out


def _fast(targets, sources, loads, fluid, blob, angular, wall, accuracy, rods):
    """Return the fast sums (6, T), or (3, T) without w."""
    if not 1e-12 <= accuracy <= 0.1:
        raise UsageError(f"accuracy must be between 1e-12 and 0.1, not {accuracy}")
    counts = np.atleast_1d(sources.shape[1] if rods is None else rods).astype(int)
    if counts.min() < 1 or counts.sum() != sources.shape[1]:
        raise UsageError(f"rods must be numbers of sources that add up to {sources.shape[1]}")
    if not np.isfinite(sources).all():
        raise UsageError("sources must be finite for a fast sum")
    from rodsim.flows.fast.plan import GroupSum, rod_sum

    own = angular and np.array_equal(targets, sources)
    _height(wall, sources)
    out = np.zeros((6 if angular else 3, targets.shape[1]))
    with computing():
        if own:
            fast = rod_sum(sources, counts, accuracy, *fluid, blob, wall_height=wall)
            fast.kernel(fast.prepare(sources, loads), sources, loads, False, out)
        else:
            fast = GroupSum(counts, accuracy, *fluid, blob, angular, wall)
            tables = fast.prepare(targets, sources, loads)
            fast.kernel(tables, targets, sources, loads, False, out)
    if fast.error.max() > accuracy:
        raise UsageError(
            f"accuracy {accuracy:g} cannot be reached here, only {fast.error.max():.2g}: leave it "
            "out, for exact sums"
        )
    out[:, _below(targets, wall)] = np.nan
    return out


def _height(wall, sources):
    """Return the height of a wall below all sources; where there is none it is not used."""
    if wall is None:
        return 0.0
    height = float(wall)
    if not np.isfinite(height):
        raise UsageError(f"wall must be a height z or None, not {wall}")
    low = np.flatnonzero(sources[2] <= height)
    if low.size:
        z = sources[2, low[0]]
        raise UsageError(
            f"source {low[0]} is at z = {z:g}: sources must be above the wall z = {height:g}"
        )
    return height


def _below(targets, wall):
    """Return which targets are below the wall, or an empty slice where there is none."""
    return slice(0) if wall is None else targets[2] < wall


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

"""Where a scene is looked at from. The projection is parallel: lengths can be read off."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rodsim.errors import UsageError

AXES = "xyz"
TURN, TILT = np.radians(15.0), np.radians(25.0)  # of the three-dimensional view
VIEWS = ("auto", "3d", "xy", "yx", "xz", "zx", "yz", "zy")


@dataclass(frozen=True)
class Camera:
    """A parallel projection: rows of ``matrix`` (3, 3) point right, up and towards the viewer.

    ``flat``: the letters of the axes that point right and up, or "" for a tilted view.
    """

    matrix: np.ndarray
    flat: str = ""

    def project(self, position: np.ndarray) -> np.ndarray:
        """Return right, up and depth (..., 3) of positions (..., 3); larger depth is nearer."""
        return position @ self.matrix.T

    def turned(self, degrees: float) -> Camera:
        """Return a tilted camera after the scene has turned about what is upright in it."""
        about = _tilt() @ _turn(np.radians(degrees)) @ _tilt().T
        return Camera(about @ self.matrix)


def make_camera(view: str, position: np.ndarray, upright=False) -> Camera:
    """Return the camera for positions (..., 3).

    ``xy`` and the like look straight at that plane, the first axis to the right; ``3d`` has the
    longest extent to the right, the next one up, and is turned a little; ``auto`` is ``3d``, or
    straight at the plane that everything lies in. ``upright``: z points up wherever it is seen.
    """
    if view not in VIEWS:
        raise UsageError(f"view must be one of {', '.join(VIEWS)}, not {view!r}")
    points = position.reshape(-1, 3)
    extent = np.ptp(points, axis=0)
    order = np.argsort(-extent, kind="stable")
    if view == "auto" and extent[order[2]] <= 1e-9 * extent[order[0]] < extent[order[1]]:
        view = AXES[order[0]] + AXES[order[1]]
        view = view[::-1] if upright and view[0] == "z" else view
    if upright:
        order = [*(axis for axis in order if axis != 2), 2]
        order = [order[0], 2, order[1]]
    if view in ("auto", "3d"):
        return Camera(_tilted() @ _frame(order[0], order[1]))
    return Camera(_frame(AXES.index(view[0]), AXES.index(view[1])), view)


def _frame(right, up):
    """Return the right-handed frame with these axes to the right and up."""
    axes = np.eye(3)
    return np.array([axes[right], axes[up], np.cross(axes[right], axes[up])])


def _tilted():
    """Look from the right and from above."""
    return _tilt() @ _turn(TURN)


def _tilt():
    cos, sin = np.cos(TILT), np.sin(TILT)
    return np.array([[1, 0, 0], [0, cos, -sin], [0, sin, cos]])


def _turn(angle):
    cos, sin = np.cos(angle), np.sin(angle)
    return np.array([[cos, 0, -sin], [0, 1, 0], [sin, 0, cos]])

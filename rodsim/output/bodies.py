"""What an output says of rigid bodies, and of the rotors of their motors."""

from __future__ import annotations

import numpy as np

from rodsim.errors import FileError
from rodsim.output import layout


class OfBodies:
    """The part of :class:`rodsim.output.reader.Trajectory` that reads bodies."""

    @property
    def bodies(self) -> list[str]:
        """Names of the rigid bodies, in order."""
        if "bodies" not in self._file.names("/"):
            return []
        get = self._file.attribute
        return sorted(
            self._file.names("bodies"), key=lambda name: get(f"bodies/{name}", "index", int)
        )

    def of_bodies(self, name: str, frames=slice(None)) -> np.ndarray:
        """Return a quantity of all bodies, or less T: (T, B, 3), orientation (T, B, 4).

        ``name``: position, orientation (quaternion w, x, y, z), velocity, angular_velocity.
        """
        if not self.bodies or name not in layout.OF_BODIES:
            known = ", ".join(layout.OF_BODIES) if self.bodies else "no bodies"
            raise FileError(f"{self.path}: has no {name} of bodies; it has {known}")
        width = 4 if name == "orientation" else 3
        shape = (len(self.bodies), width)
        return self._values(f"{layout.BODIES}/{name}", shape, frames)

    def surfaces(self, frames=slice(None)) -> np.ndarray:
        """Return the points (T, S, 3) of the surfaces of all bodies; S is 0 without bodies."""
        if not self.stores(layout.SURFACES):
            return np.zeros((self.frames, 0, 3))[frames]
        return self._values(layout.SURFACES, (None, 3), frames)

    @property
    def triangles(self) -> np.ndarray:
        """Corners (F, 3) of the triangles between the points of ``surfaces``."""
        found, first = [np.zeros((0, 3), dtype=np.int64)], 0
        for kept in map(self.body, self.bodies):
            found.append(kept["triangles"] + first)
            first += len(kept["skin"])
        return np.concatenate(found)

    def of_rotors(self, frames=slice(None)) -> np.ndarray:
        """Return position and orientation (T, K, 7) of the rotors of hooks; K is 0 without."""
        if "rotors" not in self._file.names("particles"):
            return np.zeros((self.frames, 0, 7))[frames]
        return self._values(f"{layout.ROTORS}/place", None, frames)

    def body(self, name: str) -> dict[str, np.ndarray]:
        """Return what never changes of a body: points, normals, resistance, ... by name."""
        where = f"bodies/{name}"
        names = self._file.names(where)
        return {key: self._file.array(f"{where}/{key}", "fi", None) for key in names}

    def surface(self, body: str) -> np.ndarray | None:
        """Return the points (n, 3) of a body as its file had them, None where there was none."""
        return self.body(body).get("points_read") if body in self.bodies else None

"""What all shapes share: a turn, a place, a spacing."""

from __future__ import annotations

from pydantic import Field

from rodsim.case.fields import Direction, Model, Number, Vector, quantity


class Rotate(Model):
    """A turn about an axis through the origin, before the shape is moved to its place."""

    axis: Direction = Field(description="direction of the axis, of any length but 0")
    degrees: Number = quantity("degrees", "angle, right-handed about the axis")


class Placed(Model):
    """What all shapes share."""

    rotate: Rotate | None = Field(None, description="turn about the origin, done first")
    origin: Vector = quantity("length", "then the shape is moved by this", default=(0.0, 0.0, 0.0))

    @property
    def is_closed(self) -> bool:
        """Whether the last point is joined to the first."""
        return False

    @property
    def ds(self) -> float | None:
        """Arc length between neighbouring points, or None where only a file knows it."""
        return self.length / (self.points - 1)

    @property
    def segments(self) -> int | None:
        """Number of segments, or None where only a file knows it."""
        return self.points if self.is_closed else self.points - 1


class FromFile(Placed):
    """What shapes that need a file share: what is known only once it is read."""

    @property
    def ds(self) -> None:
        """Not known before the file is read."""
        return None

    @property
    def segments(self) -> None:
        """Not known before the file is read."""
        return None

"""What a quantity is measured of: a rod, a body, a motor, the whole scene; and how it is seen."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from rodsim.analysis.strain import strain_twist
from rodsim.analysis.swimmers import BodyFrame, MotorFrame, motors_of, motors_of_case
from rodsim.errors import UsageError
from rodsim.nodes import Rod
from rodsim.output.layout import PER_ROD


class Frame:
    """A frame of a run, each array read when it is first asked for: what scenes are measured by.

    Attributes: ``run``, ``number`` and ``time`` of the frame. ``kept`` : observables over all
    frames, by name, which the frames of a run share.
    """

    def __init__(self, run, number: int, kept: dict | None = None):
        self.run, self.number, self.time = run, number, float(run.time[number])
        self._kept = {} if kept is None else kept

    @cached_property
    def position(self) -> np.ndarray:
        """Positions of all points, (N, 3)."""
        return self.run.read("position", self.number)

    @cached_property
    def director(self) -> np.ndarray:
        """Triads of all points, (N, 3, 3): [point, i] is D^(i+1)."""
        return self.run.read("director", self.number)

    def observable(self, name: str):
        """Return a stored observable: one number, or an array."""
        if name not in self._kept:
            self._kept[name] = self.run.observable(name)
        return self._kept[name][self.number]


class RodFrame:
    """A rod at one frame of a run: what rods are measured by.

    Attributes: ``name``; ``closed``; ``spacing`` and ``length`` of the unstressed rod; ``time``.
    """

    def __init__(self, frame: Frame, rod: Rod):
        self._frame, self._rod, self.time = frame, rod, frame.time
        self.name, self.closed = rod.name, rod.closed
        self.spacing, self.length = rod.spacing, rod.length

    @property
    def position(self) -> np.ndarray:
        """Positions of its points, (M, 3)."""
        return self._frame.position[self._rod.nodes]

    @property
    def director(self) -> np.ndarray:
        """Triads of its points, (M, 3, 3): [point, i] is D^(i+1)."""
        return self._frame.director[self._rod.nodes]

    @property
    def strain(self) -> np.ndarray:
        """Strain twist of its segments, (S, 3): curvatures about D^1 and D^2, twist, 1/length."""
        return strain_twist(self.director, self.spacing, self.closed)

    def observable(self, name: str) -> float:
        """Return its own value of what every rod has; raises UsageError for others."""
        if name not in PER_ROD:
            raise UsageError(f"{name} is not of one rod; these are: {', '.join(PER_ROD)}")
        return self._frame.observable(name)[self._frame.run.rods.index(self._rod)]


@dataclass(frozen=True)
class Kind:
    """A kind of subject.

    of_run : from an open run to its subjects by name. of_case : from a resolved case as plain data
    to their names. at : from a :class:`Frame` and a subject to what its measures are given.
    """

    of_run: Callable
    of_case: Callable
    at: Callable


KINDS = {
    "scene": Kind(lambda run: {"": None}, lambda case: [""], lambda frame, _: frame),
    "rod": Kind(lambda run: {rod.name: rod for rod in run.rods}, lambda c: [*c["rods"]], RodFrame),
    "body": Kind(
        lambda run: {name: name for name in run.bodies}, lambda c: [*c.get("bodies", ())], BodyFrame
    ),
    "motor": Kind(lambda run: {name: name for name in motors_of(run)}, motors_of_case, MotorFrame),
}

"""How close the rods of a run come to each other and to themselves: measured at frames, said once.

Without contact nothing but the fluid keeps rods apart. In the model they never cross, but below
their thickness it says nothing true of rods that touch, and errors of time and space can carry them
through.
"""

import math
import sys
import warnings

from rodsim.run.ending import gap_sentence
from rodsim.scene.at_wall import mirror_gap
from rodsim.scene.clearance import deepest_point
from rodsim.scene.gap import closest_pair
from rodsim.scene.neighbours import any_pair_counts, diameter, excluded


class Gap:
    """Measures the gap of a scene, keeps the smallest, warns the first time it is too small.

    ``notify`` is called with the text of that warning.
    """

    def __init__(self, scene, units: dict):
        self.scene, self.units, self.notify = scene, units, warnings.warn
        self.diameter = diameter(scene)
        self.smallest, self.time = math.inf, math.nan
        rods = scene.rods
        self._rods = rods.first, rods.count, rods.closed, excluded(scene)
        self._any, self._inside = any_pair_counts(scene), False
        apart = scene.parts.apart
        self._beside = apart.beside if apart else None

    def measure(self, state) -> dict:
        """Return the observable ``gap`` of a frame, length; nothing where no two points count."""
        self._look_into_bodies(state)
        if not self._any:
            return {}
        distance, first, second = closest_pair(state.position, *self._rods)
        distance = min(distance, sys.float_info.max)  # of rods so far apart that squares overflow
        who = self._pair
        if self.scene.wall is not None:
            mirrored, rod, point = mirror_gap(self.scene, state.position)
            if mirrored < distance:
                distance, first, second, who = mirrored, rod, point, self._at_wall
        below = distance < self.diameter <= self.smallest
        if below and not self._kept_apart(who, first, second):
            self.notify(self._warning(who(first, second), distance, state.time))
        if self._beside is not None:
            distance = min(distance, self._beside(state))
        if distance < self.smallest:
            self.smallest, self.time = distance, state.time
        return {"gap": distance}

    def _look_into_bodies(self, state):
        """Warn once where a rod has come into a body: nothing but the fluid keeps it out."""
        if self._inside or not self.scene.bodies:
            return
        depth, point, body = deepest_point(self.scene, state)
        if depth > 0.0:
            self._inside = True
            rod, k = self.scene.rods.locate(point)
            length, unit = self.units["length"], self.units["time"]
            self.notify(
                f"point {k} of rod '{rod}' is {depth:.3g} {length} inside body '{body.name}' at "
                f"t = {state.time:.6g} {unit}: the flow there means nothing (docs/bodies.md)"
            )

    def resume(self, run, frames: int) -> None:
        """Go on after the first frames of a stored run: what was said is not said again."""
        gaps = run.observable("gap", slice(0, frames)) if "gap" in run.observables else ()
        if len(gaps):
            frame = int(gaps.argmin())
            self.smallest, self.time = float(gaps[frame]), float(run.time[frame])

    def sentence(self) -> str:
        """Return how small it got, or an empty text."""
        return gap_sentence(self.smallest, self.time, self.diameter, self.units)

    def _kept_apart(self, who, first, second):
        """Tell whether contact keeps apart what comes near: then it is no news that it touches."""
        apart, locate = self.scene.parts.apart, self.scene.rods.locate
        if apart is None:
            return False
        return apart.itself or who == self._at_wall or locate(first)[0] != locate(second)[0]

    def _at_wall(self, rod, point):
        return f"rod '{rod}' comes closer to the wall than its radius: its point {point} and image"

    def _pair(self, first, second):
        (rod, i), (other, j) = (self.scene.rods.locate(point) for point in (first, second))
        return (
            f"rod '{rod}' comes closer to itself than it is thick: its points {i} and {j}"
            if rod == other
            else f"rods '{rod}' and '{other}' come closer than they are thick: points {i} and {j}"
        )

    def _warning(self, who, distance, time):
        length, unit = self.units["length"], self.units["time"]
        return (
            f"{who} are {distance:.3g} {length} apart at t = {time:.6g} {unit}; to the fluid a rod "
            f"is {self.diameter:.3g} {length} thick. Nothing but the fluid keeps them apart, and "
            "below that the model does not hold for rods that touch: contact: {}, docs/contact.md"
        )

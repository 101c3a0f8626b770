"""What is seen of a run's rods: from where, how thick, in which colours."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rodsim.analysis.strain import bend, is_flat, strain_twist
from rodsim.errors import FileError, UsageError
from rodsim.plotting import colours
from rodsim.plotting.camera import make_camera
from rodsim.plotting.directors import COLOURS as OF_DIRECTORS
from rodsim.plotting.rod import KINDS
from rodsim.plotting.shapes import Shapes

THICKNESS = 0.03  # of the length of the longest rod, where a file does not say how thick rods are
THINNEST = 0.006  # likewise, that can be seen
ARROW = 0.06  # likewise, of D^1 and D^2
MOST_NAMES = len(colours.RODS)  # rods that are told apart unless something else is asked for
UNTWISTED = 1e-6  # radians between two ends: what rounding leaves


@dataclass(frozen=True)
class Look:
    """How a run is to be drawn.

    view, kind : see ``make_camera``, ``draw_rods``; no kind means what suits the view.
    colour : time, rod, curvature or twist; "" for rod where some can be told apart, else time.
    radius : of tubes, a length; None for that of the cylinder that moves the fluid as a rod does.
    limits : lowest and highest value of colours, or None. overlay : all frames on one axis.
    """

    view: str = "auto"
    kind: str | None = None
    colour: str = ""
    directors: bool = False
    radius: float | None = None
    limits: tuple[float, float] | None = None
    overlay: bool = False

    def of(self, run, chosen):
        """Return the camera, the shapes and what their colours mean, of some frames of a run."""
        position = np.array([run.read("position", frame) for frame in chosen])
        surfaces, triangles = surfaces_of(run, chosen)
        seen = position if surfaces is None else np.concatenate([position, surfaces], axis=1)
        camera = make_camera(self.view, seen, upright=run.wall is not None)
        kind = self._kind(run, camera)
        director = None
        if kind != "line" or self.directors:
            director = np.array([run.read("director", frame) for frame in chosen])
        painted, key = self._colours(run, chosen)
        if self.directors:
            key = (key if isinstance(key, dict) else {}) | OF_DIRECTORS
        tracers = np.zeros((len(chosen), 0, 3))
        if "tracers" in run.fields:
            tracers = np.array([run.read("tracers", frame) for frame in chosen])
        shapes = Shapes(
            run.time[chosen], position, director, run.rods, painted, tracers, run.units,
            thickness(run, self.radius), kind, run.wall, self.directors * ARROW * longest(run),
            surfaces, triangles, _modes(run, chosen),
        )  # fmt: skip
        return camera, shapes, key

    def _kind(self, run, camera):
        line = camera.flat and self.radius is None
        line = line or self.directors or "director" not in run.fields
        kind = self.kind or ("line" if line else "tube")
        if kind not in KINDS:
            raise UsageError(f"style must be one of {', '.join(KINDS)}, not {kind!r}")
        return kind

    def _colours(self, run, chosen):
        """Return the colours of each frame and rod, and what they mean where that is to be said."""
        few = 1 < len(run.rods) <= MOST_NAMES and not (self.overlay or self.directors)
        colour = self.colour or ("rod" if few else "time")
        if colour == "rod":
            of_rods = colours.of_rods(run.rods.names)
            return [list(of_rods.values())] * len(chosen), _named(of_rods)
        if colour == "time":
            time, unit = run.time[chosen], run.units["time"]
            scale = colours.Scale(colours.sequential(), time.min(), time.max(), "time", unit)
            shown = scale if self.overlay and time.max() > time.min() else None
            return [[scale(t)] * len(run.rods) for t in time], shown
        values = along(run, colour, chosen)
        scale = colours.scale_of(values, colour, f"{run.units['length']}^-1", self.limits)
        painted = [scale(value) for value in values]
        return [[of_rod[frame] for of_rod in painted] for frame in range(len(chosen))], scale


def _modes(run, chosen):
    """Return what frames of ``rodsim stability`` are called, whose times count modes, else None."""
    if "mode_stiffness" not in run.observables:
        return None
    return tuple(f"mode {time:.0f}" if time else "at rest" for time in run.time[chosen])


def _named(of_rods):
    """Return what is said of the colours of rods: all, or of many the first and the last."""
    if len(of_rods) <= MOST_NAMES:
        return of_rods
    first, *_, last = of_rods.items()
    return dict([first, ("…", "none"), last])


def longest(run) -> float:
    """Return the length of the longest rod."""
    return max(rod.spacing * rod.count for rod in run.rods)


def thickness(run, radius: float | None = None) -> float:
    """Return how thick rods are drawn, a length: as the fluid takes them for, or as is asked for.

    Never thinner than can be seen, unless that is asked for.
    """
    if radius is not None:
        return 2.0 * radius
    from rodsim.export.run import tube_radius  # reads the case: only what draws rods waits for it

    try:
        return max(2.0 * tube_radius(run), THINNEST * longest(run))
    except FileError:  # of a damaged case: shapes can be seen all the same
        return THICKNESS * longest(run)


def surfaces_of(run, frames):
    """Return the surfaces of bodies (F, S, 3) in some frames and their triangles, or None, None."""
    if not run.bodies:
        return None, None
    return np.array([run.surfaces(frame) for frame in frames]), run.triangles


def along(run, quantity, frames):
    """Return the curvature or twist of the segments of each rod in some frames, (F, S) each.

    Curvature has a sign only where all rods of all frames lie in a plane. UsageError for the twist
    of rods that have none, such as those of a planar scene.
    """
    triads, strains = np.array([run.read("director", frame) for frame in frames]), []
    for rod in run.rods:
        nodes = triads[:, rod.first : rod.first + rod.count]
        strains.append(strain_twist(nodes, rod.spacing, rod.closed))
    flat = all(is_flat(strain) for strain in strains)
    if quantity == "twist":
        twists = [strain[..., 2] for strain in strains]
        _refuse_none(run, twists, flat)
        return twists
    return [strain[..., 0] if flat else bend(strain) for strain in strains]


def _refuse_none(run, twists, flat):
    lengths = [rod.spacing * rod.count for rod in run.rods]
    most = max(np.abs(t).max() * length for t, length in zip(twists, lengths, strict=True))
    if most < UNTWISTED:
        why = "the rods lie in a plane, where there is none" if flat else "there is none"
        raise UsageError(
            f"{run.path}: twist: {why} (less than {UNTWISTED:g} rad from end to end): see curvature"
        )

"""The registry of quantities: each once, with name, unit, a line, and what it needs of a file.

``rodsim measure``, the columns of a sweep, curves over time and ``run.measure`` all know these
names, and no other list of them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from rodsim.analysis.curve import amplitude, end_to_end, length, radius_of_gyration
from rodsim.analysis.helix import pitch, radius, turns
from rodsim.analysis.swimmers import (
    froude,
    froude_of_run,
    place,
    place_and_work,
    swimming_speed,
    swimming_speed_of_run,
)
from rodsim.analysis.swimming import efficiency, mean_rate, rate
from rodsim.analysis.topology import link, twist, writhe
from rodsim.forces.elastic import ENERGIES
from rodsim.output import layout
from rodsim.units import unit_text

NONE, LENGTH, VELOCITY = (0, 0, 0), layout.LENGTH, (0, 1, -1)


@dataclass(frozen=True)
class Measure:
    """A quantity.

    name; about : a line, with its formula. per : the kind of subject it is of, a key of
    ``subjects.KINDS``. unit : exponents of (mass, length, time), or the unit itself.
    frame : what it is at one frame, a number or several, from what ``KINDS[per].at`` gives.
    series : where that is not all, from (time (T,), values (T, ...), subject, run) to (T,) or
    (T, len(components)). number : one value for a whole run, from the same arguments; left out, it
    is the value at the last frame. whole : in words, what that is.
    components : names of the numbers of a vector. rods : ``open`` or ``closed`` where it is of
    these alone. needs : fields and observables that a file must have.
    """

    name: str
    about: str
    per: str
    unit: tuple[int, int, int] | str
    frame: Callable
    series: Callable | None = None
    number: Callable | None = None
    whole: str = "at the end"
    components: tuple[str, ...] = ()
    rods: str = ""
    needs: tuple[str, ...] = ()

    def unit_in(self, units: dict) -> str:
        """Return its unit, in a case's names of units."""
        return self.unit if isinstance(self.unit, str) else unit_text(self.unit, units)

    def lacks(self, run) -> str:
        """Return what a file would need to have for it, or an empty text."""
        missing = [n for n in self.needs if n not in run.fields and n not in run.observables]
        return f"the file has no {', '.join(missing)}" if missing else ""

    def fits(self, subject) -> bool:
        """Tell whether a subject has it: some are of open rods alone, some of closed ones."""
        return not self.rods or subject.closed == (self.rods == "closed")


def mean(time, values, *_):
    """Return the mean over time, without the first frame of a run, whose start is a jolt."""
    if len(time) > 1 and time[0] == 0.0:
        time, values = time[1:], values[1:]
    if len(time) == 1:
        return values[0]
    middles = 0.5 * (values[1:] + values[:-1])
    return np.sum(middles * np.diff(time)) / (time[-1] - time[0])


def _centroid(place):
    return place.position.mean(axis=0)


def _fluid(run, rod):
    """Return length of a rod, its radius to the fluid, and the viscosity."""
    from rodsim.scene.restore import restore_case, stored_diameter  # of this measure alone

    case = restore_case(run)
    return rod.length, 0.5 * stored_diameter(run, case), case.fluid.viscosity


def _efficiency(time, values, rod, run):
    fast = np.linalg.norm(rate(time, values[:, :3]), axis=1)
    return efficiency(fast, values[:, 3], *_fluid(run, rod))


def _efficiency_of_run(time, values, rod, run):
    fast = np.linalg.norm(mean_rate(time, values[:, :3]))
    return efficiency(fast, mean(time, values[:, 3]), *_fluid(run, rod))


def _speed_of_run(time, values, *_):
    return np.linalg.norm(mean_rate(time, values))


def _geometry(name, about, unit, function, rods="", needs=()):
    return Measure(name, about, "rod", unit, function, rods=rods, needs=needs)


def _stored(name, about, per, unit, **more):
    more = {"needs": (name,), **more}
    return Measure(name, about, per, unit, lambda at: at.observable(name), **more)


ALL = (
    Measure(
        "speed", "of the centroid, |d/dt mean X|", "rod", VELOCITY, _centroid,
        lambda time, values, *_: np.linalg.norm(rate(time, values), axis=1),
        _speed_of_run, "slope of a straight line",
    ),
    Measure(
        "velocity", "of the centroid, d/dt mean X", "rod", VELOCITY, _centroid,
        lambda time, values, *_: rate(time, values),
        lambda time, values, *_: mean_rate(time, values), "slope of a straight line",
        components=tuple("xyz"),
    ),
    _geometry("end_to_end", "distance of the ends, |X_M - X_1|", LENGTH,
              lambda rod: end_to_end(rod.position), "open"),
    _geometry("radius_of_gyration", "sqrt(mean |X - mean X|^2)", LENGTH,
              lambda rod: radius_of_gyration(rod.position)),
    _geometry("length", "of the centreline, sum |X_(k+1) - X_k|", LENGTH,
              lambda rod: length(rod.position, rod.closed)),
    _geometry("amplitude", "about the long axis, sqrt(2) rms across it", LENGTH,
              lambda rod: amplitude(rod.position)),
    _geometry("writhe", "Gauss's double integral over the centreline, Wr", NONE,
              lambda rod: writhe(rod.position, rod.closed)),
    _geometry("twist", "turns of D1 about the centreline, Tw", NONE,
              lambda rod: twist(rod.position, rod.director, rod.closed),
              needs=("director",)),
    _geometry("link", "linking number, Tw + Wr", NONE,
              lambda rod: link(rod.position, rod.director), "closed", ("director",)),
    _geometry("radius", "of the fitted helix", LENGTH,
              lambda rod: radius(rod.position), "open"),
    _geometry("pitch", "of the fitted helix, length per turn; > 0 right-handed", LENGTH,
              lambda rod: pitch(rod.position), "open"),
    _geometry("turns", "of the fitted helix", NONE,
              lambda rod: turns(rod.position), "open"),
    _stored("power", "of the rod on the fluid, sum (g.u + m.w)", "rod", layout.PER_ROD["power"],
            number=mean, whole="mean over time"),
    Measure(
        "efficiency", "drag of the straight rod * speed^2/power", "rod", NONE,
        lambda rod: np.append(_centroid(rod), rod.observable("power")), _efficiency,
        _efficiency_of_run, "of the means of speed and power", rods="open", needs=("power",),
    ),
    Measure("elastic_energy", "bending + twisting + shear + stretch energy", "rod", layout.ENERGY,
            lambda rod: sum(rod.observable(name) for name in ENERGIES)),
    *(_stored(name, f"{name.removesuffix('_energy')} part of the elastic energy", "rod",
              layout.ENERGY) for name in ENERGIES),
    _stored("kinetic_energy", "1/2 rho pi eps^2 sum |u|^2 ds; of cases with a density", "rod",
            layout.ENERGY, number=mean, whole="mean over time"),
    Measure(
        "body_speed", "of its centre, |d/dt X|", "body", VELOCITY, lambda body: body.position,
        lambda time, values, *_: np.linalg.norm(rate(time, values), axis=1),
        _speed_of_run, "slope of a straight line",
    ),
    Measure(
        "swimming_speed", "along the axis of its path, the mean of its own z axis", "body",
        VELOCITY, place, swimming_speed, swimming_speed_of_run,
        "slope of a straight line",
    ),
    Measure(
        "body_spin", "its angular velocity", "body", (0, 0, -1), lambda body: body.spin,
        number=mean, whole="mean over time", components=tuple("xyz"),
    ),
    Measure(
        "propulsion", "Froude: drag of the body * swimming speed^2/power of all motors", "body",
        NONE, place_and_work, froude, froude_of_run,
        "of the means of speed and power", needs=("motor_work",),
    ),
    *(_stored(f"motor_{name}", about, "motor", unit, number=mean, whole="mean over time")
      for name, about, unit in (
          ("rate", "of the end relative to its holder", (0, 0, -1)),
          ("torque", "on the end, about the axis", layout.ENERGY),
      )),
    _stored("gap", "smallest distance of points that are no neighbours", "scene", LENGTH,
            number=lambda time, values, *_: values.min(), whole="smallest"),
    *(_stored(name, f"{name.partition('_')[2]} of all rods on the fluid", "scene", unit,
              components=tuple("xyz")) for name, unit in layout.BALANCES.items()),
)  # fmt: skip
MEASURES = {measure.name: measure for measure in ALL}


def others(run) -> dict[str, Measure]:
    """Return a measure for each observable of a file that has none of its own: those of parts."""
    names = (name for name in run.observables if name not in MEASURES)
    return {name: _other(run, name) for name in names}


def _other(run, name):
    shape = run.observable(name, slice(0, 0)).shape[1:]
    if len(shape) > 1:
        return _stored(name, "as stored", "scene", run.unit(name))
    vector = shape == (3,) and name.endswith(("_force", "_torque"))
    rows = run.labels(name) or [str(i) for n in shape for i in range(n)]
    components = tuple("xyz") if vector else tuple(rows)
    return _stored(name, "as stored", "scene", run.unit(name), components=components)

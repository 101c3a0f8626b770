"""A small output file of two rods, one open and one closed, in which all numbers are distinct."""

import numpy as np

from rodsim.nodes import Rod, Rods
from rodsim.output import CaseText, Plan, TrajectoryWriter
from rodsim.output.layout import FIELDS

RODS = Rods(
    (
        Rod("zeta", 0, 4, False, 0.25, (3.5, 3.6, 3.7, 0.8, 0.9, 0.7)),
        Rod("alpha", 4, 5, True, 0.5, (2.5, 2.6, 2.7, 0.5, 0.6, 0.4)),
    )
)
TIMES = np.array([0.0, 0.3, 0.6, 0.9, 1.1, 1.7])
POINTS, TRACERS, UNITS = 9, 7, {"length": "um", "mass": "g", "time": "s"}
CASE = CaseText("title: écoute\n", '{"title": "écoute"}', ["time.end=1.7", "rods.zeta.points=4"])


STATE = {"X": np.zeros((3, 9)), "time": 0.0, "step": 0}


def make_plan(**options):
    settings = {
        "case": CASE,
        "rods": RODS,
        "times": TIMES,
        "tracers": TRACERS,
        "fields": tuple(FIELDS),
        "units": UNITS,
        "density": True,
        "checkpoint": STATE,
    }
    return Plan(**settings | options)


def create(path, overwrite=False, **options):
    return TrajectoryWriter.create(path, make_plan(**options), overwrite)


def frame(index):
    """Return fields and observables of a frame, all numbers of all frames distinct."""
    random = np.random.default_rng(index)
    fields = {name: random.normal(size=(3, POINTS)) for name in FIELDS}
    fields["director"] = random.normal(size=(3, 3, POINTS))
    fields["tracers"] = random.normal(size=(3, TRACERS))
    parts = ("bending", "twisting", "shear", "stretch", "kinetic")
    names = [*(f"{part}_energy" for part in parts), "power", "length"]
    observables = {name: random.normal(size=len(RODS)) for name in names}
    return fields, observables | {
        name: random.normal(size=3) for name in ("net_force", "net_torque")
    }


def write(writer, frames):
    for index in frames:
        writer.write_frame(index, 10 * index + 2, *frame(index))

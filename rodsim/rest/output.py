"""States at rest, and modes, as frames of an output of the usual kind."""

from __future__ import annotations

from dataclasses import replace
from time import perf_counter

import numpy as np

from rodsim.analysis.topology import twist, writhe
from rodsim.output import TrajectoryWriter
from rodsim.run.gap import Gap
from rodsim.run.recorder import plan_output
from rodsim.scene.observe import Observer

NUMBER, STIFFNESS, RATE = (0, 0, 0), (1, 0, -2), (0, 0, -1)
LEDGER = ("external_work", "dissipated")  # of a motion, which there is none of
MOST_LINKED = 2000  # points of a rod, whose writhe is summed over all pairs
UNKNOWN = -1.0  # modes that were not counted


def write_states(path, start, states, times, series, status, cost, overwrite=False, warn=None):
    """Write states as the frames of an output; return where an older file has gone, or None.

    series : observables beside those of a run, name -> (dimension, values, one for each state).
    cost : of ``/runtime``, by name.
    """
    begin, scene = perf_counter(), start.scene
    first = {"time": 0.0, "position": states[0].position, "director": states[0].director}
    plan = plan_output(start.case, scene, {**first, "frames": len(states)})
    works = {f"{name}_work" for name in scene.parts.working} | set(LEDGER)
    extra = [entry for entry in plan.extra if entry[0] not in works]
    extra += [(name, np.shape(values[0]), what) for name, (what, values) in series.items()]
    plan = replace(plan, times=np.asarray(times, float), extra=tuple(extra))
    plan = plan if start.text is None else replace(plan, case=start.text)
    observe, gap = Observer(scene), Gap(scene, start.case.units.model_dump())
    gap.notify = warn or gap.notify
    with TrajectoryWriter.create(path, plan, overwrite) as writer:
        for index, state in enumerate(states):
            fields, found = observe(state)
            found |= gap.measure(state)
            found |= {name: np.asarray(v[index], float) for name, (_, v) in series.items()}
            writer.write_frame(index, 0, fields, found)
        writer.finish(status, {**cost, "output_seconds": perf_counter() - begin})
        return writer.renamed_to


def topology(scene, state):
    """Return writhe and linking number (R,) of rods that are closed and not too long.

    What is not known is NaN.
    """
    found = np.full((2, len(scene.rods)), np.nan)
    for r, rod in enumerate(scene.rods):
        if rod.count > MOST_LINKED or rod.count < 3:
            continue
        position = state.position[:, rod.nodes].T
        found[0, r] = writhe(position, rod.closed)
        if rod.closed:
            triads = state.director[:, :, rod.nodes].transpose(2, 0, 1)
            found[1, r] = found[0, r] + twist(position, triads)
    return found

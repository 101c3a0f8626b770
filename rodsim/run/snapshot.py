"""The whole state of a run between two steps, as arrays and numbers by name.

This is what a checkpoint holds: rods and tracers, the memory of the integrator and of the watch,
the counters and the clock. A run that is restored from it goes on with the same bits.
"""

import numpy as np

from rodsim.errors import FileError
from rodsim.scene.state import State


def capture(machine, recorder, state: State) -> dict:
    """Return the snapshot of a run at ``state``, the end of a step."""
    system = machine.system
    return {
        "time": float(state.time),
        "position": state.position,
        "director": state.director,
        "tracer": state.tracer,
        **({"work": state.work} if state.work.size else {}),
        "force": int(machine.force),
        "frames": recorder.next_frame,
        "clock": recorder.clock(),
        "evaluations": system.evaluations,
        "evaluation_seconds": system.seconds,
        **_prefixed("integrator", machine.integrator.memory()),
        **_prefixed("watch", machine.watch.memory()),
    }


def restore(machine, recorder, snapshot: dict) -> State:
    """Put a run back to a snapshot, return the state of its rods; FileError if it does not fit."""
    _check(snapshot, capture(machine, recorder, machine.system.scene.initial))
    machine.integrator.recall(_stripped("integrator", snapshot))
    machine.watch.recall(_stripped("watch", snapshot))
    machine.system.evaluations = snapshot["evaluations"]
    machine.system.seconds = snapshot["evaluation_seconds"]
    recorder.restore(snapshot["frames"], snapshot["clock"])
    names = ("time", "position", "director", "tracer", "work")
    return State(*(snapshot[name] for name in names if name in snapshot))


def _check(found, expected):
    """A checkpoint may be whole and yet not that of this case: then someone has made it up."""
    if _kinds(found) != _kinds(expected):
        raise FileError("damaged: its checkpoint does not fit its case")
    rods = (found["time"], found["position"], found["director"], found["tracer"])
    if not all(np.isfinite(value).all() for value in rods):
        raise FileError("damaged: its checkpoint is not finite")


def _kinds(snapshot):
    arrays = {name: np.asarray(value) for name, value in snapshot.items()}
    return {name: (array.shape, array.dtype) for name, array in arrays.items()}


def _prefixed(prefix, entries):
    return {f"{prefix}.{name}": value for name, value in entries.items()}


def _stripped(prefix, entries):
    start = f"{prefix}."
    return {n.removeprefix(start): value for n, value in entries.items() if n.startswith(start)}

"""From the run to the file: frames at their times, and what the run has cost."""

import json
from time import perf_counter

import numpy as np

from rodsim.output import CaseText, RodRecord, TrajectoryWriter


def frame_times(end: float, interval: float) -> np.ndarray:
    """Return the times of all frames: 0, whole multiples of ``interval``, and ``end``."""
    whole = int(np.floor(end / interval * (1.0 + 1e-9)))
    times = np.arange(whole + 1) * interval
    if end - times[-1] > 1e-9 * end:
        return np.append(times, end)
    times[-1] = end
    return times


def create_writer(case, scene, output, overwrite: bool) -> TrajectoryWriter:
    """Create the output file of a run, whole, with room for every frame."""
    rods = scene.rods
    records = [
        RodRecord(
            name=name,
            first=int(rods.first[r]),
            count=int(rods.count[r]),
            closed=bool(rods.closed[r]),
            spacing=float(rods.spacing[r]),
            moduli=tuple(rods.moduli[:, r]),
        )
        for r, name in enumerate(rods.names)
    ]
    source = case.source
    return TrajectoryWriter.create(
        output,
        case=CaseText(source.text, json.dumps(case.resolved(), indent=1), list(source.overrides)),
        rods=records,
        times=frame_times(case.time.end, case.interval),
        tracers=scene.initial.tracer.shape[1],
        fields=case.output.fields,
        units=case.units.model_dump(),
        density=scene.density is not None,
        overwrite=overwrite,
    )


class Recorder:
    """Writes every frame that a step has passed, and keeps the clock of the run."""

    def __init__(self, writer, system, started, compile_seconds):
        self.writer, self.system = writer, system
        self.started, self.compile_seconds = started, compile_seconds
        self.output_seconds = 0.0
        self.marched = perf_counter()

    @property
    def frames(self) -> int:
        """Number of frames in the file."""
        return self.writer.committed

    def initial(self, state) -> None:
        """Write the frame at t = 0."""
        self._write(0, state)

    def passed(self, step) -> int:
        """Write the frames that lie in a step, each at its exact time; return how many."""
        times, before = self.writer.times, self.frames
        last = step.end.time
        while self.frames < len(times) and times[self.frames] <= last * (1.0 + 1e-12):
            self._write(step.number, step.at(min(times[self.frames], last)))
        return self.frames - before

    def _write(self, number, state):
        begin = perf_counter()
        self.writer.write_frame(self.frames, number, *self.system.observe(state))
        self.output_seconds += perf_counter() - begin

    def runtime(self, integrator) -> dict:
        """Return what the run has cost so far, as stored in ``/runtime``."""
        now = perf_counter()
        sums, elastic = self.system.split_seconds()
        return {
            "wall_seconds": now - self.started,
            "compile_seconds": self.compile_seconds,
            "solve_seconds": now - self.marched - self.output_seconds,
            "output_seconds": self.output_seconds,
            "sum_seconds": sums,
            "elasticity_seconds": elastic,
            "evaluations": self.system.evaluations,
            "steps_accepted": integrator.accepted,
            "steps_rejected": integrator.rejected,
            "max_stages": integrator.max_stages,
            "spectral_radius": integrator.spectral_radius,
            **_threads(),
        }


def _threads():
    import numba

    try:
        layer = numba.threading_layer()
    except ValueError:  # nothing has run in parallel yet, or the JIT is off
        layer = "none"
    return {"threads": numba.get_num_threads(), "threading_layer": layer}

"""From the run to the file: frames at their times, checkpoints, and what the run has cost."""

import json
from time import perf_counter

import numpy as np

from rodsim.errors import StepFailure
from rodsim.output import CaseText, Plan
from rodsim.output.writer import NotFinite
from rodsim.run.ending import Motion, SumErrors
from rodsim.scene.device import machine_of
from rodsim.scene.inputs import case_digests
from rodsim.scene.series import extra_series, row_labels

SECONDS_BETWEEN_CHECKPOINTS = 60.0  # at most, if no frame comes
SECONDS_BETWEEN_SYNCS = 10.0  # at least: waiting for the disk at every frame would cost too much


def frame_times(end: float, interval: float) -> np.ndarray:
    """Return the times of all frames: 0, whole multiples of ``interval``, and ``end``."""
    whole = int(np.floor(end / interval * (1.0 + 1e-9)))
    times = np.arange(whole + 1) * interval
    if end - times[-1] > 1e-9 * end:
        return np.append(times, end)
    times[-1] = end
    return times


def plan_output(case, scene, checkpoint: dict) -> Plan:
    """Return what the output file of a run is made from, with room for every frame."""
    source, inputs = case.source, case_digests(case)
    return Plan(
        case=CaseText(
            source.text,
            json.dumps(case.resolved(), indent=1),
            list(source.overrides),
            json.dumps(inputs, indent=1) if inputs else "",
        ),
        rods=scene.rods,
        times=frame_times(case.time.end, case.interval),
        tracers=scene.initial.tracer.shape[1],
        fields=case.output.fields,
        units=case.units.names,
        density=scene.density is not None,
        checkpoint=checkpoint,
        extra=extra_series(scene),
        arrays=scene.arrays,
        labels=row_labels(scene),
        bodies={body.name: body.stored() for body in scene.bodies},
        device=machine_of(case),
    )


class Recorder:
    """Writes every frame that a step has passed and the checkpoints; keeps the clock of the run.

    ``next_frame`` is the number of the frame to come. In a run that goes on after a kill it can be
    one that the file has already: it is then written again, with the same bits.
    """

    def __init__(self, machine, started, compile_seconds):
        self.system, self.integrator = machine.system, machine.integrator
        self.until_still, self.at_rest, self.end = False, False, machine.case.time.end
        self.gap, self.motion = machine.gap, Motion(machine.system.scene.parts.driven)
        sums = machine.case.fluid.sums
        self.sum_errors = SumErrors(sums and sums.accuracy)
        self.started, self.compile_seconds = started, compile_seconds
        self.writer, self.next_frame, self.output_seconds = None, 0, 0.0
        self.marched = self._checkpointed = self._synced = perf_counter()

    @property
    def frames(self) -> int:
        """Number of frames in the file."""
        return self.writer.committed

    def initial(self, state) -> None:
        """Write the frame at t = 0."""
        self._write(0, state)

    def passed(self, step) -> int:
        """Write the frames that lie in a step, each at its exact time; return how many."""
        times, before, last = self.writer.times, self.next_frame, step.end.time
        # A fixed step ends at its frames, but for what its multiples may differ from them.
        reach = last + (0.5 * step.size if step.rates is None else 1e-12 * last)
        while self.next_frame < len(times) and times[self.next_frame] <= reach:
            time = min(times[self.next_frame], last)
            self._write(step.number, step.at(time), step.velocities_at(time), step.powers_at(time))
        return self.next_frame - before

    def _write(self, number, state, rates=None, ledger=None):
        begin = perf_counter()
        try:
            fields, observables = self.system.observe(state, rates, ledger)
            observables |= self.gap.measure(state)
            self.writer.write_frame(self.next_frame, number, fields, observables)
        except NotFinite as error:
            what = self.system.scene.parts.not_finite(state.time) or error.name
            raise StepFailure(f"{what} is not finite at t = {state.time:.6g}", state) from None
        self.motion.add(number, state.time, fields["position"])
        self.sum_errors.add(observables)
        self.next_frame += 1
        self.output_seconds += perf_counter() - begin

    def still(self) -> bool:
        """Tell whether the run ends here, since it is to end when nothing moves any more."""
        length = self.system.scene.length_scale
        self.at_rest = self.until_still and self.motion.still(self.end, length)
        return self.at_rest

    @property
    def overdue(self) -> bool:
        """Whether the last checkpoint is too long ago."""
        return perf_counter() - self._checkpointed > SECONDS_BETWEEN_CHECKPOINTS

    def checkpoint(self, snapshot: dict) -> None:
        """Store a snapshot of the run; now and then wait until all is on the disk."""
        begin = self._checkpointed = perf_counter()
        self.writer.checkpoint(snapshot)
        if begin - self._synced > SECONDS_BETWEEN_SYNCS:
            self.writer.update_runtime(self.runtime())
            self.writer.sync()
            self._synced = begin
        self.output_seconds += perf_counter() - begin

    def clock(self) -> np.ndarray:
        """Return the seconds of the run so far: wall, compiling, solving, output."""
        now = perf_counter()
        solving = now - self.marched - self.output_seconds
        return np.array([now - self.started, self.compile_seconds, solving, self.output_seconds])

    def restore(self, next_frame: int, clock: np.ndarray) -> None:
        """Go on from there: seconds of earlier parts of the run count as well."""
        wall, compiling, solving, output = clock.tolist()
        self.next_frame, self.output_seconds = next_frame, output
        self.started -= wall
        self.marched -= solving + output
        self.compile_seconds += compiling

    def follow(self, run) -> None:
        """Go on after the frames of a stored run: what they say of gap and motion is known."""
        self.gap.resume(run, self.next_frame)
        self.motion.read(run, self.next_frame)
        self.sum_errors.read(run, self.next_frame)

    def endings(self) -> list[str]:
        """Return what is to be said of the motion when the run ends."""
        moved = self.motion.sentence(self.gap.units, self.at_rest)
        sentences = self.gap.sentence(), moved, self.sum_errors.sentence()
        return [text for text in sentences if text]

    def runtime(self) -> dict:
        """Return what the run has cost so far, as stored in ``/runtime``."""
        wall, compiling, solving, output = self.clock().tolist()
        sums, elastic = self.system.split_seconds()
        return {
            "wall_seconds": wall,
            "compile_seconds": compiling,
            "solve_seconds": solving,
            "output_seconds": output,
            "sum_seconds": sums,
            "elasticity_seconds": elastic,
            "evaluations": self.system.evaluations,
            "steps_accepted": self.integrator.accepted,
            "steps_rejected": self.integrator.rejected,
            "max_stages": self.integrator.max_stages,
            "spectral_radius": self.integrator.fastest_rate,
            **_threads(),
        }


def _threads():
    import numba

    try:
        layer = numba.threading_layer()
    except ValueError:  # nothing has run in parallel yet, or the JIT is off
        layer = "none"
    return {"threads": numba.get_num_threads(), "threading_layer": layer}

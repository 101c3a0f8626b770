"""What a run will cost, said before it: from its first steps, which are made and thrown away."""

from __future__ import annotations

import resource
import sys
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from time import perf_counter

import numba
import numpy as np

from rodsim.errors import FileError, StepFailure
from rodsim.integrators.ahead import Steps, evaluations_of, steps_ahead
from rodsim.output import TrajectoryWriter
from rodsim.output.build import room
from rodsim.run.recorder import Recorder, frame_times, plan_output
from rodsim.run.snapshot import capture

EVALUATIONS, FIXED_STEPS = 300, 20  # of the first steps: so many evaluations, or fixed steps
PAIRS, FEWEST = 2e9, 40  # of points: in large scenes fewer evaluations, but not less than this
SAMPLES = 5  # of a frame


@dataclass(frozen=True)
class Forecast:
    """What a run will cost.

    seconds : wall time of its steps and frames on ``threads``, without the start. evaluations : of
    the sums, ``each`` in seconds. memory : bytes that this process has taken, having made its first
    steps. disk : bytes of the output. made : the first steps, (size, 1) each; ahead : the others.
    """

    seconds: float
    evaluations: float
    each: float
    frames: int
    threads: int
    memory: int
    disk: int
    made: Steps
    ahead: Steps


def forecast(machine, threads: int | None = None) -> Forecast | None:
    """Return what a run of a :class:`rodsim.run.machine.Machine` will cost, None if it fails.

    Makes its first steps: some 300 evaluations, fewer where they take long.
    """
    case, scene, method = machine.case, machine.system.scene, machine.integrator.method
    machine.gap.notify = lambda text: None
    with machine.threads(threads):
        try:
            done, last = _first_steps(machine)
            count, recorder = machine.system.evaluations, Recorder(machine, perf_counter(), 0.0)
            plan = plan_output(case, scene, capture(machine, recorder, scene.initial))
            frame_seconds, used = _frame_seconds(recorder, plan, last), numba.get_num_threads()
        except StepFailure:
            return None
    times = [(time, size) for time, size, _, _ in done]
    ahead = steps_ahead(machine.system, machine.integrator, times, case.time.end)
    count += evaluations_of(ahead, method, machine.limits.rate)
    timed = done[1:] or done  # the first step reads what is kept from then on
    each = sum(row[3] for row in timed) / sum(row[2] for row in timed)
    frames = len(frame_times(case.time.end, case.interval))
    total = count * each + frames * frame_seconds
    made = [(size, 1) for _, size in times]
    return Forecast(total, count, each, frames, used, _memory(), room(plan), made, ahead)


def _first_steps(machine):
    """Return (time of its end, size, evaluations, seconds) of each, and the last step itself."""
    system, case = machine.system, machine.case
    points = system.scene.rods.points
    adaptive = machine.integrator.method.adaptive
    most = min(EVALUATIONS, max(FEWEST, PAIRS / points**2))
    machine.limits  # noqa: B018  (estimated before the clock starts)
    done, begin, counted = [], perf_counter(), system.evaluations
    first = counted
    for step in machine.integrator.steps(system.scene.initial, case.time.end):
        now, count = perf_counter(), system.evaluations
        done.append((step.end.time, step.size, count - counted, now - begin))
        enough = count - first >= most if adaptive else len(done) == FIXED_STEPS
        if enough:
            break
        begin, counted = now, count
    return done, step


def _frame_seconds(recorder, plan, step):
    """Return the seconds that a frame and its checkpoint take, in a file that is not kept.

    0 where no such file can be written.
    """
    few = replace(plan, times=np.resize(plan.times, SAMPLES))
    samples = [0.0]
    given_up = suppress(OSError, FileError)
    with given_up, TemporaryDirectory() as folder, _writer(folder, few) as recorder.writer:
        for _ in range(SAMPLES):
            begin = perf_counter()
            recorder.initial(step.end)
            recorder.checkpoint(plan.checkpoint)
            samples.append(perf_counter() - begin)
    return median(samples)


def _writer(folder, plan):
    return TrajectoryWriter.create(Path(folder) / "frames.h5", plan)


def _memory():
    """Return the largest memory of this process, bytes."""
    unit = 1 if sys.platform == "darwin" else 1024
    return unit * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss

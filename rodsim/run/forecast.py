"""What a run will cost, said before it: from its first steps, which are made and thrown away."""

from __future__ import annotations

import resource
import sys
from dataclasses import dataclass
from statistics import median
from time import perf_counter

import numba

from rodsim.errors import StepFailure
from rodsim.integrators.ahead import Steps, evaluations_of, steps_ahead
from rodsim.output.build import room
from rodsim.run.recorder import Recorder, frame_times, plan_output
from rodsim.run.snapshot import capture

EVALUATIONS = 300  # of the first steps
PAIRS, FEWEST = 2e9, 40  # of points: in large scenes fewer evaluations, but not less than this
SAMPLES = 5  # of a frame
WRITE_SECONDS = 3e-4  # of a frame and its checkpoint in the file, beside computing them


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
    case, method = machine.case, machine.integrator.method
    machine.gap.notify = lambda text: None
    with machine.threads(threads):
        try:
            done = _first_steps(machine)
        except StepFailure:
            return None
        count = machine.system.evaluations
        frame_seconds, used = _frame_seconds(machine, done[-1][0]), numba.get_num_threads()
    times = [(step.end.time, step.size) for step, _, _ in done]
    ahead = steps_ahead(machine.system, machine.integrator, times, case.time.end)
    count += evaluations_of(ahead, method, machine.limits.rate)
    each = median(seconds / evaluations for _, evaluations, seconds in done)
    frames = len(frame_times(case.time.end, case.interval))
    total = count * each + frames * (frame_seconds + WRITE_SECONDS)
    made = [(size, 1) for _, size in times]
    return Forecast(total, count, each, frames, used, _memory(), _disk(machine), made, ahead)


def _first_steps(machine):
    """Return (step, evaluations, seconds) of the first steps; an estimate of the rate counts."""
    system, case = machine.system, machine.case
    points = system.scene.rods.points
    most = min(EVALUATIONS, max(FEWEST, PAIRS / points**2))
    machine.limits  # noqa: B018  (estimated before the clock starts)
    done, begin, counted = [], perf_counter(), system.evaluations
    first = counted
    for step in machine.integrator.steps(system.scene.initial, case.time.end):
        now, count = perf_counter(), system.evaluations
        done.append((step, count - counted, now - begin))
        if count - first >= most:
            break
        begin, counted = now, count
    return done


def _frame_seconds(machine, step):
    """Return the seconds that computing a frame takes."""
    samples = []
    for _ in range(SAMPLES):
        begin = perf_counter()
        state, rates = step.at(step.end.time), step.velocities_at(step.end.time)
        machine.system.observe(state, rates)
        machine.gap.measure(state)
        samples.append(perf_counter() - begin)
    return median(samples)


def _disk(machine):
    scene = machine.system.scene
    snapshot = capture(machine, Recorder(machine, perf_counter(), 0.0), scene.initial)
    return room(plan_output(machine.case, scene, snapshot))


def _memory():
    """Return the largest memory of this process, bytes."""
    unit = 1 if sys.platform == "darwin" else 1024
    return unit * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss

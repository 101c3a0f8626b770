"""One run of a case in memory, and how far its end is from that of another."""

from __future__ import annotations

from dataclasses import dataclass
from time import perf_counter

import numpy as np

from rodsim.analysis.difference import position_errors, triad_angle
from rodsim.convergence.twin import end_of_twin
from rodsim.errors import StepFailure
from rodsim.forces.elastic import ENERGIES
from rodsim.run.machine import Machine
from rodsim.scene.build import build_scene
from rodsim.scene.state import Scene, State


@dataclass(frozen=True)
class Outcome:
    """The end of a run, and what it has cost.

    ``velocity`` (3,): mean velocity of the centroid of all rods over the run, length/time;
    ``energies``: elastic energy at both ends. ``seconds``: each repeat of the solve, without
    compiling and output; ``pairs``: of a target and a source, in one evaluation; ``twin``: the end
    of the same steps of rkc from a start that differs in the last bit, where it was asked for.
    """

    scene: Scene
    end: State
    velocity: np.ndarray
    energies: tuple[float, float]
    seconds: tuple[float, ...]
    evaluations: int
    steps: int
    rejected: int
    twin: State | None = None

    @property
    def best(self) -> float:
        """Seconds of the fastest repeat: nothing makes a run faster than it is."""
        return min(self.seconds)

    @property
    def pairs(self) -> int:
        """Number of pairs in the sums of an evaluation."""
        return pairs(self.scene)


def pairs(scene) -> int:
    """Return the pairs in the sums of an evaluation, those of surfaces with each other aside."""
    points = scene.rods.points
    surfaces = sum(body.surface.points.shape[1] for body in scene.bodies)
    return points * (points + 2 * surfaces)


@dataclass(frozen=True)
class Errors:
    """What separates two outcomes; ``speed`` is None where nothing is driven, ``tracers`` where
    there are none.

    position: largest distance, length; relative: the same over the longest rod; rms: root mean
    square distance, length; angle: largest angle between triads, degrees; energy: difference
    over the larger of the elastic energies at both ends; speed: |v - v_ref|/|v_ref|, v the mean
    velocity of the centroid; tracers: largest distance of one, length.
    """

    position: float
    relative: float
    rms: float
    angle: float
    energy: float
    speed: float | None
    tracers: float | None


def solve(
    case, threads=None, repeats=1, enough=0.05, progress=lambda fraction: None, twin=False
) -> Outcome:
    """Run a case to its end without an output; again until ``repeats`` or ``enough`` seconds:
    what takes longer is hardly changed by what else the machine does.

    ``twin``: of rkc, also from a start that differs in the last bit. Raises DivergedError as
    ``simulate`` does.
    """
    scene, seconds = build_scene(case), []
    while len(seconds) < repeats and (not seconds or sum(seconds) < enough):
        machine = Machine(case, scene, force=False)
        with machine.threads(threads):
            _ = machine.limits  # a run begins with it: its steps then know the fastest rate
            begin = perf_counter()
            end, taken = _march(machine, case.time.end, progress)
            seconds.append(perf_counter() - begin)
    count, other = machine.system.evaluations, None
    if twin:
        with machine.threads(threads):
            other = end_of_twin(machine, taken, case.time.end)
    system, integrator, initial = machine.system, machine.integrator, scene.initial
    points = slice(scene.rods.points)
    drift = (end.position - initial.position)[:, points].mean(axis=1)
    return Outcome(
        scene=scene,
        end=end,
        velocity=drift / case.time.end,
        energies=(_energy(system, initial), _energy(system, end)),
        seconds=tuple(seconds),
        evaluations=count,
        steps=integrator.accepted,
        rejected=integrator.rejected,
        twin=other,
    )


def _march(machine, end, progress):
    state, integrator, taken = machine.system.scene.initial, machine.integrator, []
    try:
        for step in integrator.steps(state, end):
            machine.watch.check(step)
            state = step.end
            taken.append((step.size, integrator.fastest_rate))
            progress(state.time / end)
    except StepFailure as failure:
        machine.watch.stop(failure, integrator.accepted + 1)
    return state, taken


def _energy(system, state):
    observables = system.observe(state)[1]
    return float(sum(observables[name].sum() for name in ENERGIES))


def compare(run: Outcome, reference: Outcome) -> Errors:
    """Return the errors of a run, at the points that it shares with the reference.

    A reference with more points has all of the run's: its intervals were halved.
    """
    ours, theirs = _shared(run, reference), _shared(reference, run)
    largest, rms = position_errors(ours.position, theirs.position)
    scale = max(abs(energy) for energy in reference.energies)
    speed = None
    if swims(reference.scene):
        gap = np.linalg.norm(run.velocity - reference.velocity)
        speed = float(gap / np.linalg.norm(reference.velocity))
    return Errors(
        position=largest,
        relative=largest / reference.scene.length_scale,
        rms=rms,
        angle=triad_angle(ours.director, theirs.director),
        energy=abs(run.energies[1] - reference.energies[1]) / scale if scale else 0.0,
        speed=speed,
        tracers=_tracers(run.end.tracer, reference.end.tracer),
    )


def swims(scene) -> bool:
    """Tell whether a scene goes somewhere: driven in time, or by motors or loads of bodies."""
    return scene.parts.driven or bool(scene.bodies)


def _tracers(ours, theirs):
    """Return the largest distance of a tracer, None where there are none."""
    return position_errors(ours, theirs)[0] if ours.size else None


def _shared(run, other):
    """Return the state of those points of a run that the other one has too."""
    ours, theirs = run.scene.rods, other.scene.rods
    chosen = [
        first + np.arange(count)[:: max(1, ours.segments[r] // theirs.segments[r])]
        for r, (first, count) in enumerate(zip(ours.first, ours.count, strict=True))
    ]
    nodes = np.concatenate(chosen)
    end = run.end
    return State(end.time, end.position[:, nodes], end.director[:, :, nodes], end.tracer)

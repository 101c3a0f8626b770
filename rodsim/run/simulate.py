"""The run: evaluate, step, check, write. A run that begins and one that goes on share one path."""

from __future__ import annotations

import os
import warnings
from dataclasses import dataclass, field
from time import perf_counter

from rodsim.case import Case
from rodsim.errors import DivergedError, FileError, StepFailure, StoppedError, UsageError
from rodsim.output import TrajectoryWriter
from rodsim.progress import Silent
from rodsim.run.past import open_past
from rodsim.run.recorder import Recorder, plan_output
from rodsim.run.snapshot import capture, restore
from rodsim.scene.build import build_scene


@dataclass
class Summary:
    """How a run ended and what it cost: ``runtime`` is the file's ``/runtime``.

    ``compile_seconds`` : what was spent on compiling before the run, counted with the rest of it.
    """

    compile_seconds: float = 0.0
    status: str = "running"
    frames: int = 0
    moved: str | None = None
    runtime: dict = field(default_factory=dict)


def simulate(
    case,
    output,
    *,
    overwrite=False,
    threads=None,
    force=False,
    stop=str,
    progress=None,
    notify=warnings.warn,
    inform=lambda limits: None,
    summary=None,
) -> Summary:
    """Run a case and stream it to an HDF5 file.

    Parameters
    ----------
    case : what :func:`rodsim.load_case` returns.
    output : path of the file. One that exists is renamed to the next free ``name.1.h5`` and so
        on (``Summary.moved``), unless ``overwrite``.
    threads : number of threads, at least 1, or None for as many as the scene is worth.
    force : run also with a fixed step above its limit of stability.
    stop : called after each step; returns why the run is to stop there, or an empty text.
    progress : object with ``update(fraction, note)``, or None for none.
    notify : called with the text of each warning.
    inform : called before the first step with the scene's ``integrators.limits.Limits``.
    summary : a :class:`Summary` to fill in, for callers that want it after an error as well.

    Raises
    ------
    CaseError : the geometry of the scene cannot be used, or a fixed step is above its limit.
    FileError : the output cannot be written.
    DivergedError : the run stopped; the frames before that are in the file, its status is set.
    StoppedError : ``stop`` gave a reason; :func:`resume` goes on from there.
    """
    if not isinstance(case, Case):
        raise UsageError("simulate takes a case: rodsim.load_case(path)")
    summary = summary or Summary()
    started = perf_counter() - summary.compile_seconds
    _refuse_sources(case, output)
    scene = build_scene(case)
    for problem in scene.warnings:
        notify(str(problem))
    machine, compile_seconds = _compile(case, scene, force)
    with machine.threads(threads):
        for problem in machine.step_warnings():
            notify(str(problem))
        limits = machine.limits  # before the first snapshot: the estimate is part of it
        recorder = Recorder(machine, started, compile_seconds + summary.compile_seconds)
        plan = plan_output(case, scene, capture(machine, recorder, scene.initial))
        with TrajectoryWriter.create(output, plan, overwrite) as recorder.writer:
            inform(limits)
            moved = recorder.writer.renamed_to
            summary.moved = str(moved) if moved else None
            _record(machine, scene.initial, recorder, stop, progress or Silent(), summary)
    return summary


def resume(
    output,
    *,
    overrides=(),
    threads=None,
    stop=str,
    progress=None,
    notify=warnings.warn,
    summary=None,
) -> Summary:
    """Go on with a run where it stopped or was killed, in the same file, with the same bits.

    ``overrides`` may set a later ``time.end`` and add to ``output.fields``, nothing else; the rest
    is as in :func:`simulate`. Raises CaseError for other changes, FileError for a file that cannot
    be gone on with. A finished run without changes is left as it is.
    """
    summary = summary or Summary()
    started = perf_counter() - summary.compile_seconds
    with open_past(output, overrides) as past:
        if past.complete:
            summary.status, summary.frames = "finished", past.run.frames
            return summary
        for text in past.warnings():
            notify(text)
        scene = build_scene(past.case, past)
        machine, compile_seconds = _compile(past.case, scene, bool(past.snapshot["force"]))
        recorder = Recorder(machine, started, compile_seconds + summary.compile_seconds)
        state = restore(machine, recorder, past.snapshot)
        with machine.threads(threads), past.writer(machine) as recorder.writer:
            _record(machine, state, recorder, stop, progress or Silent(), summary)
    return summary


def _refuse_sources(case, output):
    """Raise FileError rather than write over what the case is read from."""
    for source in case.files:
        if os.path.exists(output) and os.path.exists(source) and os.path.samefile(output, source):
            raise FileError(f"{output}: the case is read from it; give another output")


def _compile(case, scene, force):
    """Import what is compiled only now: who does not run, does not wait for it."""
    begin = perf_counter()
    from rodsim.run.machine import Machine

    return Machine(case, scene, force), perf_counter() - begin


def _record(machine, state, recorder, stop, progress, summary):
    """March to the end; however that goes, file and summary say how far it came."""
    summary.status = "stopped"  # by whatever comes up the stack, unless named below
    try:
        _march(machine, state, recorder, stop, progress)
        summary.status = "finished"
    except DivergedError:
        summary.status = "diverged"
        raise
    finally:
        summary.frames, summary.runtime = recorder.frames, recorder.runtime()
        recorder.writer.finish(summary.status, summary.runtime)


def _march(machine, state, recorder, stop, progress):
    """Step from ``state`` to the end of the case: a first frame, or one after a checkpoint."""
    integrator, watch, end = machine.integrator, machine.watch, machine.case.time.end
    try:
        if recorder.next_frame == 0:
            recorder.initial(state)
        for step in integrator.steps(state, end):
            watch.check(step)
            new = recorder.passed(step)
            if new:
                watch.frame(recorder.next_frame - 1)
            reason = stop()
            if new or reason or recorder.overdue:
                recorder.checkpoint(capture(machine, recorder, step.end))
            progress.update(step.end.time / end, f"t = {step.end.time:.4g}")
            if reason and step.end.time < end:
                raise StoppedError(f"stopped by {reason} at t = {step.end.time:.6g} of {end:g}")
    except StepFailure as failure:
        watch.stop(failure, integrator.accepted + 1)

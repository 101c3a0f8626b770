"""The run: evaluate, step, check, write."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, field
from time import perf_counter

from rodsim.errors import DivergedError, StepFailure
from rodsim.progress import Silent
from rodsim.recorder import Recorder, create_writer
from rodsim.rods import build_scene


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
    progress=None,
    notify=warnings.warn,
    summary=None,
) -> Summary:
    """Run a case and stream it to an HDF5 file.

    Parameters
    ----------
    case : what :func:`rodsim.load_case` returns.
    output : path of the file. One that exists is renamed to the next free ``name.1.h5`` and so
        on (``Summary.moved``), unless ``overwrite``.
    threads : number of threads, or None for as many as the scene is worth.
    force : run also with a fixed step above its limit of stability.
    progress : object with ``update(fraction, note)``, or None for none.
    notify : called with the text of each warning.
    summary : a :class:`Summary` to fill in, for callers that want it after an error as well.

    Raises
    ------
    CaseError : the geometry of the scene cannot be used, or a fixed step is above its limit.
    FileError : the output cannot be written.
    DivergedError : the run stopped; the frames before that are in the file, its status is set.
    """
    summary = summary or Summary()
    started = perf_counter() - summary.compile_seconds
    scene = build_scene(case)
    machine, compile_seconds = _compile(case, scene, force)
    with machine.threads(threads):
        for problem in machine.step_warnings():
            notify(str(problem))
        with create_writer(case, scene, output, overwrite) as writer:
            summary.moved = str(writer.renamed_to) if writer.renamed_to else None
            compiling = compile_seconds + summary.compile_seconds
            recorder = Recorder(writer, machine.system, started, compiling)
            _record(machine, case.time.end, recorder, progress or Silent(), summary)
    return summary


def _compile(case, scene, force):
    """Import what is compiled only now: who does not run, does not wait for it."""
    begin = perf_counter()
    from rodsim.machine import Machine

    return Machine(case, scene, force), perf_counter() - begin


def _record(machine, end, recorder, progress, summary):
    """March to the end; however that goes, file and summary say how far it came."""
    summary.status = "stopped"  # by whatever comes up the stack, unless named below
    try:
        _march(machine, end, recorder, progress)
        summary.status = "finished"
    except DivergedError:
        summary.status = "diverged"
        raise
    finally:
        summary.frames, summary.runtime = recorder.frames, recorder.runtime(machine.integrator)
        recorder.writer.finish(summary.status, summary.runtime)


def _march(machine, end, recorder, progress):
    integrator, watch, state = machine.integrator, machine.watch, machine.system.scene.initial
    recorder.initial(state)
    try:
        for step in integrator.steps(state, end):
            watch.check(step)
            if recorder.passed(step):
                watch.frame(recorder.frames - 1)
            progress.update(step.end.time / end, f"t = {step.end.time:.4g}")
    except StepFailure as failure:
        watch.stop(failure, integrator.accepted + 1)

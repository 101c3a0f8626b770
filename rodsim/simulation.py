"""The run: evaluate, step, check, write."""

from __future__ import annotations

from dataclasses import dataclass, field
from time import perf_counter

from rodsim.errors import DivergedError, StepFailure
from rodsim.progress import Silent
from rodsim.recorder import Recorder, create_writer
from rodsim.rods import build_scene
from rodsim.threads import threads_for


@dataclass
class Summary:
    """How a run ended and what it cost: ``runtime`` is the file's ``/runtime``."""

    status: str = "running"
    frames: int = 0
    moved: str | None = None
    runtime: dict = field(default_factory=dict)


def simulate(
    case, output, *, overwrite=False, threads=None, progress=None, summary=None
) -> Summary:
    """Run a case and stream it to an HDF5 file.

    Parameters
    ----------
    case : what :func:`rodsim.load_case` returns.
    output : path of the file. One that exists is renamed to the next free ``name.1.h5`` and so
        on (``Summary.moved``), unless ``overwrite``.
    threads : number of threads, or None for as many as the scene is worth.
    progress : object with ``update(fraction, note)``, or None for none.
    summary : a :class:`Summary` to fill in, for callers that want it after an error as well.

    Raises
    ------
    CaseError : the geometry of the scene cannot be used. FileError : the output cannot be written.
    DivergedError : the run stopped; the frames before that are in the file, its status is set.
    """
    started = perf_counter()
    progress = progress or Silent()
    summary = summary or Summary()
    scene = build_scene(case)
    with (
        create_writer(case, scene, output, overwrite) as writer,
        threads_for(scene.rods.points, threads),
    ):
        summary.moved = str(writer.renamed_to) if writer.renamed_to else None
        system, integrator, watch, compile_seconds = _compile(case, scene)
        recorder = Recorder(writer, system, started, compile_seconds)
        summary.status = "stopped"  # by whatever comes up the stack, unless named below
        try:
            _march(case.time.end, scene, integrator, watch, recorder, progress)
            summary.status = "finished"
        except DivergedError:
            summary.status = "diverged"
            raise
        finally:
            summary.frames, summary.runtime = recorder.frames, recorder.runtime(integrator)
            writer.finish(summary.status, summary.runtime)
    return summary


def _march(end, scene, integrator, watch, recorder, progress):
    recorder.initial(scene.initial)
    try:
        for step in integrator.steps(scene.initial, end):
            watch.check(step)
            recorder.passed(step)
            watch.last_good_frame = recorder.frames - 1
            progress.update(step.end.time / end, f"t = {step.end.time:.4g}")
    except StepFailure as failure:
        watch.stop(failure, integrator.accepted + 1)


def _compile(case, scene):
    """Import what needs Numba only now: who does not run, does not wait for it."""
    begin = perf_counter()
    from rodsim.dynamics import RodSystem
    from rodsim.integrators import FIXED_STEP, make_integrator
    from rodsim.watch import Watch

    system = RodSystem(scene)
    watch = Watch(system, case.time.integrator in FIXED_STEP)
    return system, make_integrator(case.time, system), watch, perf_counter() - begin

"""The march: step, check, write, from a state to the end of the case."""

from rodsim.errors import DivergedError, StepFailure, StoppedError
from rodsim.run.listener import Listener, Summary
from rodsim.run.snapshot import capture


def record(machine, state, recorder, listener: Listener) -> Summary:
    """March to the end; however that goes, file and summary say how far it came."""
    summary = Summary("stopped")  # by whatever comes up the stack, unless named below
    moved = recorder.writer.renamed_to
    summary.moved = str(moved) if moved else None
    try:
        _march(machine, state, recorder, listener)
        summary.status = "finished"
    except DivergedError:
        summary.status = "diverged"
        raise
    finally:
        summary.frames, summary.runtime = recorder.frames, recorder.runtime()
        summary.endings = recorder.endings()
        try:
            recorder.writer.finish(summary.status, summary.runtime)
        finally:
            listener.ended(summary)
    return summary


def _march(machine, state, recorder, listener):
    """Step from ``state`` to the end of the case: a first frame, or one after a checkpoint."""
    integrator, watch, end = machine.integrator, machine.watch, machine.case.time.end
    try:
        if recorder.next_frame == 0:
            recorder.initial(state)
        watch.output = str(recorder.writer.path)
        for step in integrator.steps(state, end):
            watch.check(step)
            new = recorder.passed(step)
            if new:
                watch.frame(recorder.next_frame - 1)
            reason = listener.stop()
            if new or reason or recorder.overdue:
                recorder.checkpoint(capture(machine, recorder, step.end))
            if new and recorder.still():
                return
            listener.update(step.end.time / end, f"t = {step.end.time:.4g}")
            if reason and step.end.time < end:
                raise StoppedError(f"stopped by {reason} at t = {step.end.time:.6g} of {end:g}")
    except StepFailure as failure:
        watch.stop(failure, integrator.accepted + 1)

"""Start and resume: a run that begins and one that goes on share one path."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping
from time import perf_counter
from typing import Any, Literal

from rodsim.case import Case
from rodsim.case.plain import override_texts
from rodsim.errors import FileError, UsageError
from rodsim.output import TrajectoryWriter
from rodsim.output.paths import check_place
from rodsim.run.listener import Functions, Listener, Summary
from rodsim.run.past import open_past
from rodsim.scene.build import build_scene
from rodsim.scene.device import on_device

STILL = "still"  # when a run is to end before its time


def simulate(
    case: Case,
    output: str | os.PathLike[str],
    *,
    overwrite: bool = False,
    threads: int | None = None,
    force: bool = False,
    until: Literal["still"] | None = None,
    device: Literal["cpu", "gpu"] | None = None,
    notify: Callable[[str], object] | None = None,
    stop: Callable[[], str] | None = None,
    progress: Any = None,
    listener: Listener | None = None,
) -> Summary:
    """Run a case and stream it to an HDF5 file.

    Parameters
    ----------
    case : what :func:`rodsim.load_case` returns.
    output : path of the file. One that exists is renamed to the next free ``name.1.h5`` and so
        on (``Summary.moved``), unless ``overwrite``.
    threads : number of threads, at least 1, or None for as many as the scene is worth.
    force : run also with a fixed step above its limit of stability.
    until : ``"still"`` ends the run before ``time.end`` when nothing moves any more, see
        :meth:`rodsim.run.ending.Motion.still`.
    device : where the sums are computed, ``"cpu"`` or, exactly, on a ``"gpu"`` (docs/large.md).
    notify : called with the text of each warning; by default they are Python's own.
    stop : called after each step; returns why the run is to stop there, or an empty text.
    progress : object with ``update(fraction, note)``, or True for a bar on a terminal, a line in a
        notebook.
    listener : one :class:`rodsim.run.listener.Listener` in place of these three.

    Raises
    ------
    CaseError : the geometry of the scene cannot be used, or a fixed step is above its limit.
    FileError : the output cannot be written.
    DivergedError : the run stopped; the frames before that are in the file, its status is set.
    StoppedError : ``stop`` gave a reason; :func:`resume` goes on from there.
    """
    if not isinstance(case, Case):
        raise UsageError("simulate takes a case: rodsim.load_case(path)")
    listener = listener or Functions(notify, stop, progress, case.title or str(output))
    started = perf_counter()
    case = on_device(case, device)
    _refuse_sources(case, output)
    check_place(output, overwrite)  # before the wait for the compiler
    scene = build_scene(case)
    for problem in scene.warnings:
        listener.warn(str(problem))
    _check_until(until, scene)
    machine, recorder = _prepare(case, scene, force, started, listener)
    recorder.until_still = until == STILL
    from rodsim.run.march import record
    from rodsim.run.recorder import plan_output
    from rodsim.run.snapshot import capture

    with machine.threads(threads):
        for problem in machine.step_warnings():
            listener.warn(str(problem))
        limits = machine.limits  # before the first snapshot: the estimate is part of it
        plan = plan_output(case, scene, capture(machine, recorder, scene.initial))
        with TrajectoryWriter.create(output, plan, overwrite) as recorder.writer:
            listener.limits(limits)
            return record(machine, scene.initial, recorder, listener)


def resume(
    output: str | os.PathLike[str],
    *,
    overrides: Iterable[str] | Mapping[str, Any] = (),
    threads: int | None = None,
    until: Literal["still"] | None = None,
    device: Literal["cpu", "gpu"] | None = None,
    notify: Callable[[str], object] | None = None,
    stop: Callable[[], str] | None = None,
    progress: Any = None,
    listener: Listener | None = None,
) -> Summary:
    """Go on with a run where it stopped or was killed, in the same file, with the same bits.

    ``overrides``, a list or dict as in :func:`rodsim.load_case`, may set a later ``time.end`` and
    add to ``output.fields``, nothing else; ``device`` is by default that which the file names; the
    rest is as in :func:`simulate`. Raises CaseError for other changes, FileError for a file that
    cannot be gone on with, UsageError where that device is not there. A finished run without
    changes is left as it is.
    """
    listener = listener or Functions(notify, stop, progress, str(output))
    started = perf_counter()
    with open_past(output, override_texts(overrides)) as past:
        return go_on(past, started, threads, listener, until, device)


def go_on(
    past, started: float, threads: int | None, listener: Listener, until=None, device=None
) -> Summary:
    """Go on with a :class:`rodsim.run.past.Past`; ``started``: when, by ``perf_counter``."""
    if past.complete:
        return Summary("finished", past.run.frames)
    past.go_on_at(device)
    for text in past.warnings():
        listener.warn(text)
    scene = build_scene(past.case, past)
    _check_until(until, scene)
    force = bool(past.snapshot["force"])
    machine, recorder = _prepare(past.case, scene, force, started, listener)
    from rodsim.run.march import record
    from rodsim.run.snapshot import restore

    state = restore(machine, recorder, past.snapshot)
    recorder.follow(past.run)
    recorder.until_still = until == STILL
    with machine.threads(threads), past.writer(machine) as recorder.writer:
        return record(machine, state, recorder, listener)


def _check_until(until, scene):
    """Raise UsageError for an end that does not come."""
    if until not in (None, STILL):
        raise UsageError(f"until {until!r}: a run goes on to time.end, or until {STILL!r}")
    if until and scene.parts.driven:
        raise UsageError("until 'still': the scene is driven, so it never comes to rest")


def _refuse_sources(case, output):
    """Raise FileError rather than write over what the case is read from."""
    for source in case.files:
        if os.path.exists(output) and os.path.exists(source) and os.path.samefile(output, source):
            raise FileError(f"{output}: the case is read from it; give another output")


def _prepare(case, scene, force, started, listener):
    """Import what is compiled only now: who does not run, does not wait for it."""
    seconds = listener.compile(scene)
    begin = perf_counter()
    from rodsim.run.machine import Machine
    from rodsim.run.recorder import Recorder

    machine = Machine(case, scene, force)
    machine.gap.notify = listener.warn
    return machine, Recorder(machine, started, seconds + perf_counter() - begin)

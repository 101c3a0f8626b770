"""Text for people: what an output file holds, how its run has ended, whether all of it is good.

Of what reads a case nothing is needed here but for a run with contact or a drive, so that a look
at an output takes no longer than to open it.
"""

from __future__ import annotations

from rodsim.commands.stored_case import DAMAGE, describe_stored, diameter_of, is_driven
from rodsim.commands.touching import describe_links
from rodsim.errors import FileError
from rodsim.output import open_trajectory
from rodsim.run.ending import Motion, SumErrors, gap_sentence


def describe_output(path) -> str:
    """Return what an output file holds and how its run ended."""
    with open_trajectory(path) as run:
        unit = run.units
        last = f"t = 0 to {run.time[-1]:g} {unit['time']}" if run.frames else "no time"
        lines = [
            f"{path}: {_fate(run)}",
            f"{run.frames} of {len(run.planned)} frames, {last}",
            f"written by rodsim {run.version}, {run.created}; format {run.format}",
        ]
        lines += describe_stored(run)
        lines += describe_links(run)
        lines += _endings(run)
        for name in run.bodies:
            kept = run.body(name)
            lines.append(f"body {name}: {len(kept['points'])} points")
        if run.wall is not None:
            lines.append(f"wall: z = {run.wall:g} {unit['length']}, without slip")
        lines.append(f"fields: {', '.join(run.fields)}")
        lines.append(f"observables: {', '.join(run.observables)}")
        lines += [f"{name} of {', '.join(labels)}" for name, labels in _rows(run)]
        lines += [
            f"{key}: {value if isinstance(value, str) else format(value, '.6g')}"
            for key, value in run.runtime.items()
        ]
        lines += _inputs(run)
        lines += [f"resumed {text}" for text in run.resumes]
        if run.overrides:
            lines.append("--set " + " --set ".join(run.overrides))
    return "\n".join(lines)


def check_output(path) -> str:
    """Read a whole output file and say that it is good; FileError with all that is not."""
    from rodsim.output.verify import verify

    with open_trajectory(path) as run:
        problems = verify(run)
        if problems:
            raise FileError("\n".join(f"{path}: damaged: {problem}" for problem in problems))
        return f"{path}: checked, {run.frames} frames are whole, and so is the checkpoint"


def _fate(run) -> str:
    """Return how a run has ended, and what to do if it has not come to its end."""
    again = f"; go on with: rodsim resume {run.path}"
    if run.status != "running":
        return run.status + (again if run.status == "stopped" else "")
    from rodsim.output.paths import writing_process

    writer = writing_process(run.path)
    return f"running, {writer}" if writer else f"killed{again}"


def _endings(run):
    """Return how small the gap got and how fast the rods still moved, as the run said it."""
    if not run.frames:
        return []
    try:
        return [text for text in _sentences(run, run.case_data()) if text]
    except DAMAGE:  # its frames can still be looked at
        return []


def _sentences(run, case):
    motion = Motion(is_driven(run, case))
    motion.read(run, run.frames)
    errors = SumErrors((case["fluid"].get("sums") or {}).get("accuracy"))
    errors.read(run, run.frames)
    at_rest = run.status == "finished" and run.frames < len(run.planned)
    sentences = [motion.sentence(run.units, at_rest), errors.sentence()]
    if "gap" in run.observables:
        gaps, diameter = run.observable("gap"), diameter_of(run, case)
        k = int(gaps.argmin())
        sentences.insert(0, gap_sentence(gaps[k], run.time[k], diameter, run.units))
    return sentences


def _rows(run):
    """Yield observables and whose their rows are, where they are not those of the rods."""
    rods = [rod.name for rod in run.rods]
    for name in run.observables:
        if (labels := run.labels(name)) and labels != rods:
            yield name, labels


def _inputs(run) -> list[str]:
    """Return a line for each file the run began from: its digest, and whether it is the same."""
    if not run.inputs:
        return []
    from rodsim.scene.inputs import look_again, stored_digests

    stored = stored_digests(run.inputs)
    try:
        found = look_again(stored, run.case_data())
    except (FileError, ValueError, KeyError, TypeError, AttributeError):
        return []
    return [
        f"{key}: {file}, sha256 {stored[key]['sha256'][:16]}, {state}"
        for key, (file, state) in found.items()
    ]

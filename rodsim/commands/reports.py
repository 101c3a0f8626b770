"""Text for people: what a case will do, what a run has cost, what an output file holds."""

from __future__ import annotations

from rodsim.case.methods import METHODS
from rodsim.case.resolved import is_driven
from rodsim.commands.groups import (
    VISCOSITY,
    describe_groups,
    describe_parameters,
    describe_rods,
    in_water_units,
)
from rodsim.commands.held import describe_held
from rodsim.commands.stored_case import describe_stored
from rodsim.commands.sums import describe_sums
from rodsim.commands.touching import describe_contact, describe_links
from rodsim.errors import FileError
from rodsim.run.ending import Motion, SumErrors, gap_sentence
from rodsim.run.recorder import frame_times
from rodsim.scene.at_wall import mirror_gap
from rodsim.scene.build import build_scene
from rodsim.scene.restore import restore_case, stored_diameter
from rodsim.units import unit_text


def describe_case(case, refuse=False, threads=None) -> str:
    """Return the resolved scene, its fastest rate, stable steps, and what a run will cost.

    ``refuse`` : raise CaseError for what a run would refuse, a fixed step above its limit.
    ``threads`` : of the run, None for as many as the scene is worth.
    """
    from rodsim.commands.costs import describe_costs
    from rodsim.commands.geometry import describe_start
    from rodsim.integrators.limits import check_step
    from rodsim.run.machine import Machine

    scene = build_scene(case)
    machine = Machine(case, scene, force=False)
    unit = case.units
    lines = [case.title] if case.title else []
    lines += [*describe_parameters(case), *describe_rods(case, scene)]
    lines += [f"warning: {problem}" for problem in scene.warnings]
    lines.append(
        f"fluid: viscosity {scene.viscosity:.6g} {unit_text(VISCOSITY, unit.names)}"
        f"{in_water_units(scene.viscosity, unit.names)}, {scene.blob}, "
        f"epsilon {scene.epsilon:.6g} {unit.length} "
        f"= {scene.epsilon / scene.rods.spacing[0]:.4g} spacings"
    )
    lines += describe_held(case, scene)
    lines += describe_start(scene, machine.system, unit.names)
    if scene.wall is not None:
        lines.append(describe_wall(scene, unit.length))
    if scene.parts.apart:
        lines.append(describe_contact(scene, case.contact, unit.length))
    if scene.planar:
        lines.append("planar: only u_y, u_z and w_x are computed")
    if scene.parts.external:
        lines.append(f"acting: {_acting(scene.parts)}")
    for name, count in scene.tracer_groups.items():
        lines.append(f"tracers {name}: {count} markers")
    lines += describe_groups(case, scene)
    lines += describe_sums(case, scene)
    time = case.time
    option = METHODS[time.integrator].option
    how = f"{option} {getattr(time, option):g}"
    frames = len(frame_times(time.end, case.interval))
    lines.append(f"time: to {time.end:g} {unit.time} by {time.integrator}, {how}; {frames} frames")
    limits = machine.limits
    if refuse:
        lines += [f"warning: {problem}" for problem in check_step(case, limits)]
    lines += describe_limits(limits, unit.time)
    return "\n".join([*lines, *describe_costs(machine, threads)])


def _acting(parts) -> str:
    """Return the names of all parts, in their order, and which of them depend on time."""
    driven = {part.name: part.row.driven for part in parts}
    return ", ".join(f"{name} (driven)" if yes else name for name, yes in driven.items())


def describe_wall(scene, length_unit: str) -> str:
    """Return the line on the wall of a scene: where it is, and how far above it the rods start."""
    gap, rod, k = mirror_gap(scene, scene.initial.position)
    height = 0.5 * gap
    return (
        f"wall: z = {scene.wall:g} {length_unit}, without slip; lowest: point {k} of rod {rod}, "
        f"{height:.4g} {length_unit} = {height / scene.epsilon:.4g} epsilon above it"
    )


def describe_limits(limits, time_unit: str) -> list[str]:
    """Return what is known of the step before a run: fastest rate, limits, stages of rkc."""
    steps = ", ".join(f"{name} {step:.4g}" for name, step in limits.largest_steps.items())
    stages = ", ".join(f"{size:g}: {count}" for size, count in limits.stages.items())
    return [
        f"fastest rate at t = 0: {limits.rate:.4g} 1/{time_unit}; "
        f"largest stable step ({time_unit}): {steps}",
        f"rkc takes any step; its stages at a step of {stages}",
    ]


def run_summary(summary, output) -> str:
    """Return the lines printed when a run has ended, however it has."""
    cost = summary.runtime
    total = cost["wall_seconds"]
    lines = []
    if summary.moved:
        lines.append(f"the earlier {output} is now {summary.moved}")
    lines.append(f"{summary.status}: {summary.frames} frames in {output}")
    lines.append(
        f"{cost['evaluations']} evaluations, {cost['steps_accepted']} steps accepted, "
        f"{cost['steps_rejected']} rejected, up to {cost['max_stages']} stages"
    )
    parts = ("compile", "sum", "elasticity", "output")
    split = ", ".join(f"{part} {cost[f'{part}_seconds']:.2f}" for part in parts)
    lines.append(f"{total:.2f} s of wall time: {split} s")
    lines += summary.endings
    if summary.status == "stopped":
        lines.append(f"go on with: rodsim resume {output}")
    return "\n".join(lines)


def check_output(path) -> str:
    """Read a whole output file and say that it is good; FileError with all that is not."""
    from rodsim.output import open_trajectory
    from rodsim.output.verify import verify

    with open_trajectory(path) as run:
        problems = verify(run)
        if problems:
            raise FileError("\n".join(f"{path}: damaged: {problem}" for problem in problems))
        return f"{path}: checked, {run.frames} frames are whole, and so is the checkpoint"


def _fate(run) -> str:
    """Return how a run has ended, and what to do if it has not come to its end."""
    from rodsim.output.paths import writing_process

    again = f"; go on with: rodsim resume {run.path}"
    if run.status == "running":
        writer = writing_process(run.path)
        return f"running, {writer}" if writer else f"killed{again}"
    return run.status + (again if run.status == "stopped" else "")


def _endings(run):
    """Return how small the gap got and how fast the rods still moved, as the run said it."""
    if not run.frames:
        return []
    try:
        case = restore_case(run)
    except FileError:  # its frames can still be looked at
        return []
    motion = Motion(is_driven(case))
    motion.read(run, run.frames)
    errors = SumErrors(case)
    errors.read(run, run.frames)
    at_rest = run.status == "finished" and run.frames < len(run.planned)
    sentences = [motion.sentence(run.units, at_rest), errors.sentence()]
    if "gap" in run.observables:
        gaps = run.observable("gap")
        k, diameter = int(gaps.argmin()), stored_diameter(run, case)
        sentences.insert(0, gap_sentence(gaps[k], run.time[k], diameter, run.units))
    return [text for text in sentences if text]


def _rows(run):
    """Yield observables and whose their rows are, where they are not those of the rods."""
    rods = [rod.name for rod in run.rods]
    for name in run.observables:
        if (labels := run.labels(name)) and labels != rods:
            yield name, labels


def _inputs(run) -> list[str]:
    """Return a line for each file the run began from: its digest, and whether it is the same."""
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


def describe_output(path) -> str:
    """Return what an output file holds and how its run ended."""
    from rodsim.output import open_trajectory

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

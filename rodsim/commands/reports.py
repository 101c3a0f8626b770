"""Text for people: what a case will do, what a run has cost."""

from __future__ import annotations

from rodsim.case.methods import METHODS
from rodsim.commands.groups import (
    describe_groups,
    describe_parameters,
    describe_rods,
)
from rodsim.commands.held import describe_held
from rodsim.commands.sums import describe_sums
from rodsim.commands.touching import describe_contact
from rodsim.run.recorder import frame_times
from rodsim.scene.at_wall import mirror_gap
from rodsim.scene.build import build_scene
from rodsim.units import VISCOSITY, in_water_units, unit_text


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
    frames = f"{summary.frames} frame{'s' * (summary.frames != 1)}"
    lines.append(f"{summary.status}: {frames} in {output}")
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

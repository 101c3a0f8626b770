"""Case -> scene: shapes are built and placed, all rods put into one array, geometry checked."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from rodsim.case import check_strain_twist, spacings_differ
from rodsim.compiled.constants import HALF_TURN
from rodsim.compiled.parts import PartList
from rodsim.errors import CaseError, FileError
from rodsim.nodes import lay_out
from rodsim.registry import kinds
from rodsim.scene.at_wall import below_wall, near_wall
from rodsim.scene.shapes import FORMULAS, place
from rodsim.scene.state import Scene, State
from rodsim.scene.stored import read_shape
from rodsim.scene.tracers import tube

PLANE_TOLERANCE = 1e-12  # of the rod's length, as the case file's contract has it


def build_scene(case, stored=None) -> Scene:
    """Return the scene of a validated case; what looks wrong with it is in its ``warnings``.

    ``stored``: called with a rod's name and shape, returns position, director, spacing, closed of
    a rod that is not to be built from its shape, or None.

    Raises CaseError for what only the geometry can tell (spacings that differ, a planar scene
    that is not, triads a half-turn apart) and FileError for a shape file.
    """
    built = [_build_rod(case, name, rod, stored) for name, rod in case.rods.items()]
    rods = lay_out(
        (name, position.shape[1], closed, spacing, rod.moduli.values)
        for (name, rod), (position, _, spacing, closed) in zip(
            case.rods.items(), built, strict=True
        )
    )
    position = np.ascontiguousarray(np.concatenate([rod[0] for rod in built], axis=1))
    director = np.ascontiguousarray(np.concatenate([rod[1] for rod in built], axis=2))
    epsilon, problems = _epsilon(case, rods)
    if case.plane is not None:
        problems += _plane_problems(case, rods, position, director)
        position[0], director = position[0, 0], _flattened(director)
    problems += _half_turns(case, rods, director)
    if problems:
        raise CaseError(problems)
    tracer, groups = _tracers(case, rods, built)
    scene = Scene(
        rods=rods,
        epsilon=epsilon,
        viscosity=case.fluid.viscosity,
        blob=case.fluid.blob,
        planar=case.plane is not None,
        density=case.fluid.density,
        tracer_groups=groups,
        initial=State(0.0, position, director, tracer),
        wall=case.fluid.wall and case.fluid.wall.z,
    )
    if problems := list(below_wall(case, scene)):
        raise CaseError(problems)
    scene = replace(scene, warnings=tuple(near_wall(case, scene)))
    return with_parts(scene, [part for kind in kinds() for part in kind.build(case, scene)])


def with_parts(scene: Scene, parts) -> Scene:
    """Return a scene with other parts, and with a ledger at zero for what acts from outside."""
    scene = replace(scene, parts=PartList(parts))
    return replace(scene, initial=replace(scene.initial, work=np.zeros(scene.ledger)))


def _folder(case):
    return Path(case.source.path).parent if case.source and case.source.path else Path()


def _build_rod(case, name, rod, stored):
    """Return position, director, spacing, closed of one rod, placed."""
    shape = rod.shape
    if stored is not None and (found := stored(name, shape)) is not None:
        return found
    if shape.kind == "file":
        try:
            position, director, spacing, closed = read_shape(shape, _folder(case))
        except FileError as error:
            where = case.source.problem(("rods", name, "shape", "path"), str(error))
            raise FileError(str(where)) from error
        _check_stored(case, name, rod, spacing, position.shape[1] - (not closed))
    else:
        position, director = FORMULAS[shape.kind](shape)
        spacing, closed = shape.ds, shape.is_closed
    return *place(position, director, shape), spacing, closed


def _check_stored(case, name, rod, spacing, segments):
    """What the case file alone could not tell: the strain twist needs the file's spacing."""
    if spacing is None:
        reason = "missing: a text table needs the spacing of its points at rest"
        raise CaseError([case.source.problem(("rods", name, "shape", "spacing"), reason)])
    errors, _ = check_strain_twist(rod, spacing, segments, case.time.end)
    if errors:
        where = ("rods", name)
        raise CaseError([case.source.problem((*where, *path), reason) for path, reason in errors])


def _epsilon(case, rods):
    """Return epsilon as a length, and the problem of spacings that differ, if they do."""
    epsilon = case.fluid.epsilon
    if isinstance(epsilon, float):
        return epsilon, []
    reason = spacings_differ(dict(zip(rods.names, rods.spacing, strict=True)))
    problems = [case.source.problem(("fluid", "epsilon"), reason)] if reason else []
    return float(epsilon.spacings * rods.spacing[0]), problems


def _plane_problems(case, rods, position, director):
    """A planar scene lies in one plane of constant x with D^1 = +-x everywhere."""
    limit = PLANE_TOLERANCE * rods.lengths.max()
    problems = []
    for r, name in enumerate(rods.names):
        nodes = slice(int(rods.first[r]), int(rods.first[r] + rods.count[r]))
        off_plane = np.abs(position[0, nodes] - position[0, 0]).max()
        tilt = np.abs(np.abs(director[0, 0, nodes]) - 1.0).max()
        if off_plane > limit:
            plane = f"x = {position[0, 0]:.6g}"
            reason = f"not planar: rod '{name}' leaves the plane {plane} by {off_plane:.3g}"
        elif tilt > PLANE_TOLERANCE:
            reason = f"not planar: D1 of rod '{name}' is not along x; drop 'plane' or turn the rod"
        else:
            continue
        problems.append(case.source.problem(("plane",), reason))
    return problems


def _flattened(director):
    """Remove what rounding left out of the plane, so that it stays exactly planar."""
    flat = director.copy()
    flat[0, 0] = np.sign(flat[0, 0])
    flat[0, 1:] = 0.0
    flat[1:, 0] = 0.0
    return flat


def _half_turns(case, rods, director):
    problems = []
    for r, name in enumerate(rods.names):
        begin, end = int(rods.first[r]), int(rods.first[r] + rods.count[r])
        triads = director[:, :, begin:end]
        after = np.roll(triads, -1, axis=2)
        trace = np.einsum("ick,ick->k", triads, after)[: int(rods.segments[r])]
        if (1.0 + trace).min() < HALF_TURN:
            k = int(np.argmin(trace))
            reason = f"the triads of points {k} and {k + 1} are a half-turn apart: use more points"
            problems.append(case.source.problem(("rods", name, "shape"), reason))
    return problems


def _tracers(case, rods, built):
    """Return tracer positions (3, P) and the number of markers of each group."""
    blocks, groups = [np.zeros((3, 0))], {}
    for name, group in case.tracers.items():
        if isinstance(group, tuple):
            block = np.array(group, dtype=float).T
        else:
            position, director, _, closed = built[rods.names.index(group.rod)]
            block = tube(group, position, director, closed)
        blocks.append(block)
        groups[name] = block.shape[1]
    return np.ascontiguousarray(np.concatenate(blocks, axis=1)), groups

"""Case -> scene: shapes are built and placed, all rods put into one array, geometry checked."""

from dataclasses import replace

import numpy as np

from rodsim.case import spacings_differ
from rodsim.compiled.constants import HALF_TURN
from rodsim.compiled.parts import PartList
from rodsim.errors import CaseError
from rodsim.nodes import lay_out
from rodsim.registry import kinds
from rodsim.scene.at_wall import below_wall, near_wall
from rodsim.scene.bodies import add_nodes, build_bodies
from rodsim.scene.clearance import check_bodies
from rodsim.scene.hooks import stiff_hooks
from rodsim.scene.initial import initial_nodes
from rodsim.scene.moduli import along_rods, typical
from rodsim.scene.neighbours import coincident
from rodsim.scene.rods import build_rods
from rodsim.scene.state import Scene, State
from rodsim.scene.tracers import tube

PLANE_TOLERANCE = 1e-12  # of the rod's length, as the case file's contract has it


def build_scene(case, stored=None) -> Scene:
    """Return the scene of a validated case; what looks wrong with it is in its ``warnings``.

    ``stored``: an earlier run of the case, see :func:`rodsim.scene.rods.build_rods`.

    Raises CaseError for what only the geometry can tell (spacings that differ, a planar scene
    that is not, triads a half-turn apart, a table that contradicts itself) and FileError for a
    shape file or table.
    """
    found = build_rods(case, stored)
    built = found.rods
    rods = lay_out(
        (name, position.shape[1], closed, spacing, typical(along))
        for name, (position, _, spacing, closed), along in zip(
            case.rods, built, found.moduli, strict=True
        )
    )
    position = np.ascontiguousarray(np.concatenate([rod[0] for rod in built], axis=1))
    director = np.ascontiguousarray(np.concatenate([rod[1] for rod in built], axis=2))
    epsilon, problems = epsilon_of(case, rods)
    if case.plane is not None:
        problems += _plane_problems(case, rods, position, director)
        position[0], director = position[0, 0], _flattened(director)
    problems += _half_turns(case, rods, director)
    if problems:
        raise CaseError(problems)
    bodies = build_bodies(case, rods.points, case.fluid.blob, stored)
    arrays = {name: dict(kept) for name, kept in found.arrays.items()}
    position, director = add_nodes(case, rods, bodies, position, director, arrays)
    if case.initial is not None and stored is None:
        position, director, jumps = initial_nodes(case, rods, bodies, position, director)
        found.warnings += jumps
        if problems := _half_turns(case, rods, director):
            raise CaseError(problems)
    tracer, groups = _tracers(case, rods, position, director)
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
        entries=tuple(found.entries),
        along=along_rods(case, found, rods),
        arrays={name: kept for name, kept in arrays.items() if kept},
        warnings=tuple(found.warnings),
        bodies=bodies,
        device=case.device,
    )
    if problems := [*below_wall(case, scene), *(() if stored else check_bodies(case, scene))]:
        raise CaseError(problems)
    seen = (*near_wall(case, scene), *stiff_hooks(case, scene))
    scene = replace(scene, warnings=(*scene.warnings, *seen))
    if stored is None:
        _refuse_coincident(case, scene)
    scene = with_parts(scene, [part for kind in kinds() for part in kind.build(case, scene)])
    told = [problem for part in scene.parts for problem in part.warnings]
    return replace(scene, warnings=(*scene.warnings, *told))


def with_parts(scene: Scene, parts) -> Scene:
    """Return a scene with other parts, and with a ledger at zero for what acts from outside."""
    scene = replace(scene, parts=PartList(parts))
    return replace(scene, initial=replace(scene.initial, work=np.zeros(scene.ledger)))


def _refuse_coincident(case, scene):
    """Raise CaseError where rods start through each other or themselves."""
    pair = coincident(scene)
    if pair is None:
        return
    (name, i), (other, j) = (scene.rods.locate(point) for point in pair)
    who = f"point {j}" if name == other else f"point {j} of rod '{other}'"
    reason = (
        f"point {i} lies on {who}: rods cannot start through each other; give one another origin"
    )
    raise CaseError([case.source.problem(("rods", name, "shape"), reason)])


def epsilon_of(case, rods):
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


def _tracers(case, rods, position, director):
    """Return tracer positions (3, P) and the number of markers of each group."""
    blocks, groups = [np.zeros((3, 0))], {}
    for name, group in case.tracers.items():
        if isinstance(group, tuple):
            block = np.array(group, dtype=float).T
        else:
            rod = rods[rods.names.index(group.rod)]
            block = tube(group, position[:, rod.nodes], director[:, :, rod.nodes], rod.closed)
        blocks.append(block)
        groups[name] = block.shape[1]
    return np.ascontiguousarray(np.concatenate(blocks, axis=1)), groups

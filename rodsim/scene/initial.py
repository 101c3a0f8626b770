"""A scene that begins in a state of an earlier run: ``initial`` of the case."""

from __future__ import annotations

import numpy as np

from rodsim.blocks.ends import end_node, held_ends
from rodsim.errors import CaseError, FileError
from rodsim.forces.places import rod_named
from rodsim.scene.bodies import stored_nodes
from rodsim.scene.stored import AGREES, find_file, in_unit

JUMP = 1e-3  # spacings; less is what a shape of another run may round to


def initial_nodes(case, rods, bodies, position, director):
    """Return position (3, N) and director (3, 3, N) of all nodes in the state that a case names.

    position, director : of all nodes as the case builds them. Ends that are held in space stay
    there, with ``move`` at t = 0; beside the arrays come Problems of those that jump by that.
    Raises CaseError and FileError.
    """
    from rodsim.output import open_trajectory  # HDF5 is for who begins in an output

    folder = case.folder
    try:
        path = find_file(case.initial.path, folder)
        with open_trajectory(path) as run:
            found = _of_frame(case, run, rods, bodies)
    except FileError as error:
        raise FileError(str(case.source.problem(("initial", "path"), str(error)))) from error
    jumps = list(_hold_in_space(case, rods, (position, director), found))
    return (*map(np.ascontiguousarray, found), jumps)


def _of_frame(case, run, rods, bodies):
    """Return the nodes of a frame, in the order of the case's."""
    frame = case.initial.frame
    if not -run.frames <= frame < run.frames:
        _refuse(case, f"has frames 0 to {run.frames - 1}", "frame")
    if run.status == "diverged":
        raise FileError(f"{run.path}: its run diverged: start from another run")
    factor, errors, _ = in_unit(run.units["length"], case.units.length)
    if errors:
        raise FileError(errors[0][1])
    _refuse_others(case, run, rods, factor)
    places, triads = stored_nodes(run, frame)
    order = [run.bodies.index(body.name) for body in bodies]
    order += range(len(run.bodies), places.shape[1])  # the rotors, which have no names
    theirs = [rod_named(run.rods, name) for name in rods.names]
    nodes = np.concatenate([np.arange(run.points)[rod.nodes] for rod in theirs])
    position, director = run.read("position", frame), run.read("director", frame)
    return (
        factor * np.hstack([position[nodes].T, places[:, order]]),
        np.concatenate([director[nodes].transpose(1, 2, 0), triads[:, :, order]], axis=2),
    )


def _refuse_others(case, run, rods, factor):
    """Raise CaseError unless the rods and bodies of a case are in an output."""
    theirs = {rod.name: rod for rod in run.rods}
    for rod in rods:
        if rod.name not in theirs:
            reason = f"has no rod '{rod.name}': its rods are {', '.join(theirs)}"
        else:
            reason = _differs(rod, theirs[rod.name], factor)
        if reason:
            _refuse(case, f"{reason}: the shapes must be those of the output")
    for name in case.bodies or {}:
        if name not in run.bodies:
            _refuse(case, f"has no body '{name}'")
    if run.of_rotors(0).shape[0] and list(theirs) != list(case.rods):
        _refuse(case, f"its rods are {', '.join(theirs)}: not the case's")


def _differs(rod, theirs, factor):
    """Return how a rod differs from its namesake in an output, or nothing."""
    if rod.count != theirs.count:
        return f"rod '{rod.name}' has {theirs.count} points there, not {rod.count}"
    if rod.closed != theirs.closed:
        return f"rod '{rod.name}' is {'closed' if theirs.closed else 'open'} there"
    if abs(factor * theirs.spacing / rod.spacing - 1.0) > AGREES:
        spacing = factor * theirs.spacing
        return f"rod '{rod.name}' has a spacing of {spacing:.6g} there, not {rod.spacing:.6g}"
    return ""


def _refuse(case, reason, key="path"):
    raise CaseError([case.source.problem(("initial", key), reason)])


def _hold_in_space(case, rods, built, found):
    """Put ends that are held in space where the case holds them; yield Problems of the jumps."""
    for name, which, end in held_ends(case):
        if end.to != "space":
            continue
        rod = rod_named(rods, name)
        node = end_node(rod, which)
        jump = float(np.linalg.norm(found[0][:, node] - built[0][:, node]))
        if jump > JUMP * rod.spacing:
            reason = (
                f"is held {jump:.3g} {case.units.length} from where the output has it: move counts "
                "from the shape, and time starts at 0"
            )
            yield case.source.problem(("rods", name, which), reason)
        found[0][:, node] = built[0][:, node]
        if end.hold == "clamped" and end.motor is None and end.hook is None:
            found[1][:, :, node] = built[1][:, :, node]

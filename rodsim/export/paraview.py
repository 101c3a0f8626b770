"""A state of ParaView, as Python: it opens an output where it lies, with tubes, bodies and wall.

Loaded by File > Load State, or ``paraview --script=FILE.py``, ``pvpython FILE.py``.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from rodsim.analysis.wall import piece_of_wall
from rodsim.files import replacing
from rodsim.plotting.bodies import COLOUR as BODY
from rodsim.plotting.camera import make_camera

STATE = '''"""{title}: made by rodsim export; File > Load State, or paraview --script=THIS."""

from paraview.simple import *

OUTPUT = {output}  # the file stays where it is; change this where it has moved
RADIUS = {radius!r}  # of the tubes, {length}
WALL = {wall!r}  # its corner and the two next to it, or None

view = GetActiveViewOrCreate("RenderView")
view.AxesGrid.Visibility = 1
view.AxesGrid.XTitle, view.AxesGrid.YTitle, view.AxesGrid.ZTitle = {axes!r}

run = VTKHDFReader(registrationName="run", FileName=[OUTPUT])
GetAnimationScene().UpdateAnimationUsingDataTimeSteps()

# Tubes of the rods, each its own colour
tubes = Tube(registrationName="rods", Input=run)
tubes.Radius, tubes.NumberofSides, tubes.Capping = RADIUS, 20, 1
shown = Show(tubes, view)
ColorBy(shown, ("CELLS", "rod"))
shown.RescaleTransferFunctionToDataRange(False, True)
shown.SetScalarBarVisibility(view, False)

# The surfaces of bodies, grey, and the centrelines, hidden in the tubes
bodies = Show(run, view)
bodies.Representation = "Surface"
bodies.ColorArrayName = ["POINTS", ""]  # one colour
bodies.DiffuseColor = bodies.AmbientColor = {grey!r}

if WALL:
    wall = Plane(registrationName="wall", Origin=WALL[0], Point1=WALL[1], Point2=WALL[2])
    Show(wall, view).Opacity = 0.5

view.CameraFocalPoint = [0.0, 0.0, 0.0]
view.CameraPosition, view.CameraViewUp = {towards!r}, {up!r}
ResetCamera(view)
Render(view)
'''


def write_state(run, path, radius: float) -> None:
    """Write the state for an open run with tubes of a radius; raises FileError."""
    length, points = run.units["length"], _ends(run)
    _, up, towards = make_camera("3d", points, run.wall is not None).matrix.tolist()
    text = STATE.format(
        title=json.dumps(str(run.case_data().get("title") or Path(run.path).name))[1:-1],
        output=json.dumps(str(Path(run.path).resolve())),
        radius=float(radius),
        length=length,
        wall=_wall(points, run.wall),
        axes=[f"{axis} ({length})" for axis in "xyz"],
        grey=list(BODY[:3]),
        towards=towards,
        up=up,
    )
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


def _ends(run):
    """Return all points of the first and the last frame."""
    ends = [run.read("position", k) for k in (0, -1)] + [run.surfaces(k) for k in (0, -1)]
    return np.concatenate(ends)


def _wall(points, height):
    """Return three corners of a piece of the wall under points, or None."""
    corners = piece_of_wall(points, height, np.inf)
    return None if corners is None else corners[[0, 1, 3]].tolist()

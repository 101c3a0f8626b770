"""The state of ParaView that ``rodsim export -o FILE.py`` writes, run against a stand-in for it.

The stand-in's reader and tubes are VTK's own, those that ParaView is made of.
"""

import json
import sys
import types

import numpy as np
import pytest
from calls import command
from outputs import CASE, RODS, TIMES, create, write

pytest.importorskip("vtkmodules.vtkIOHDF")
RADIUS, HEIGHT = 0.013, -9.0
TITLE = 'three """ quotes, a {brace}, a \\ at the end \\'


class Thing:
    """Any object of ParaView: keeps what it was made with, and what is set."""

    def __init__(self, *given, **named):
        self.given = given
        self.__dict__.update(named)

    def __getattr__(self, name):
        if name.startswith("__"):
            raise AttributeError(name)
        made = Thing()
        setattr(self, name, made)
        return made

    def __call__(self, *given):
        return None


@pytest.fixture
def state(tmp_path, monkeypatch):
    """Return what a state has made of an output with a wall, by the name of the function."""
    text = json.dumps({"title": TITLE, "fluid": {"wall": {"z": HEIGHT}}})
    with create(tmp_path / "out.h5", case=type(CASE)("", text, [])) as writer:
        write(writer, range(len(TIMES)))
        writer.finish("finished", {})
    command("export", tmp_path / "out.h5", "-o", tmp_path / "a.py", "--radius", RADIUS)
    made, simple = {}, types.ModuleType("paraview.simple")
    for name in ("GetActiveViewOrCreate", "VTKHDFReader", "GetAnimationScene", "Tube", "Show",
                 "ColorBy", "Plane", "ResetCamera", "Render"):  # fmt: skip

        def make(*given, name=name, **named):
            return made.setdefault(name, []).append(Thing(*given, **named)) or made[name][-1]

        setattr(simple, name, make)
    monkeypatch.setitem(sys.modules, "paraview", types.ModuleType("paraview"))
    monkeypatch.setitem(sys.modules, "paraview.simple", simple)
    exec(compile((tmp_path / "a.py").read_text(encoding="utf-8"), "a.py", "exec"), {})
    return made


def test_it_opens_the_output_where_it_lies_and_makes_tubes_of_its_radius(state):
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkFiltersCore import vtkTubeFilter
    from vtkmodules.vtkIOHDF import vtkHDFReader

    (run,), (tubes,) = state["VTKHDFReader"], state["Tube"]
    assert tubes.Input is run
    assert tubes.Radius == RADIUS
    reader, tube = vtkHDFReader(), vtkTubeFilter()
    reader.SetFileName(run.FileName[0])
    reader.UpdateInformation()
    assert reader.GetNumberOfSteps() == len(TIMES)
    tube.SetInputConnection(reader.GetOutputPort())
    tube.SetRadius(tubes.Radius)
    tube.SetNumberOfSides(tubes.NumberofSides)
    tube.Update()
    first = vtk_to_numpy(reader.GetOutputDataObject(0).GetPoints().GetData())[0]
    around = vtk_to_numpy(tube.GetOutput().GetPoints().GetData())[: tubes.NumberofSides]
    np.testing.assert_allclose(np.linalg.norm(around - first, axis=1), RADIUS, rtol=1e-5)
    assert tube.GetOutput().GetNumberOfPoints() > 20 * sum(rod.count for rod in RODS)
    assert state["ColorBy"][0].given[1] == ("CELLS", "rod")
    assert [shown.given[0] for shown in state["Show"]] == [tubes, run, *state["Plane"]]


def test_it_shows_the_wall_and_looks_from_above_it(state):
    (wall,) = state["Plane"]
    corner, right, far = np.array([wall.Origin, wall.Point1, wall.Point2])
    assert (np.array([corner[2], right[2], far[2]]) == HEIGHT).all()
    assert np.dot(right - corner, far - corner) == 0.0
    view = state["GetActiveViewOrCreate"][0]
    assert view.CameraViewUp[2] > 0.5
    assert np.dot(view.CameraPosition, view.CameraViewUp) == pytest.approx(0.0, abs=1e-12)
    assert view.CameraPosition[2] > 0.0

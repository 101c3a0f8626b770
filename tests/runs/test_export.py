"""Exports, read back by other programs' readers."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest
from calls import command, settings, told
from outputs import POINTS, RODS, TIMES, TRACERS, create, frame, write
from scenes import CONFIGS

from rodsim import open_trajectory
from rodsim.analysis.strain import strain_twist

RING = str(CONFIGS / "closed_ring.yaml")
SHORT = "rods.ring.shape.points=40", "time.end=1e-3"


@pytest.fixture
def output(tmp_path, monkeypatch):
    """Six frames of random numbers: two rods, seven tracers, all fields."""
    monkeypatch.chdir(tmp_path)
    with create(tmp_path / "out.h5") as writer:
        write(writer, range(len(TIMES)))
    return tmp_path / "out.h5"


def test_csv_has_every_number(output):
    assert "wrote a.csv\n" in told("export", output, "-o", "a.csv", "--every", 2)
    with open("a.csv", newline="") as stream:
        heads, *rows = csv.reader(stream)
    assert heads[:6] == ["frame", "time (s)", "rod", "point", "s (um)", "x (um)"]
    assert "D3_z" in heads
    assert "velocity_y (um s^-1)" in heads
    assert len(rows) == 3 * POINTS
    assert [row[2] for row in rows[:POINTS]] == ["zeta"] * 4 + ["alpha"] * 5
    assert [float(row[4]) for row in rows[3:6]] == [0.75, 0.0, 0.5]
    fields = frame(4)[0]
    table = np.array([row[5:] for row in rows[2 * POINTS :]], float)
    assert np.array_equal(table[:, :3], fields["position"].T)
    assert np.array_equal(table[:, 3:12], fields["director"].transpose(2, 0, 1).reshape(-1, 9))
    assert np.array_equal(table[:, 12:15], fields["velocity"].T)
    assert {float(row[1]) for row in rows} == set(TIMES[::2])


def test_npz_is_the_whole_file(output):
    told("export", output, "-o", "a.npz")
    with np.load("a.npz") as arrays, open_trajectory(output) as run:
        assert np.array_equal(arrays["time"], TIMES)
        for name in run.fields:
            assert np.array_equal(arrays[name], run.read(name))
        for name in run.observables:
            assert np.array_equal(arrays[name], run.observable(name))
        assert arrays["rod_name"].tolist() == ["zeta", "alpha"]
        assert arrays["rod_closed"].tolist() == [False, True]
        assert np.array_equal(arrays["rod_moduli"], [rod.moduli for rod in RODS])
        units = json.loads(str(arrays["units"]))
        assert (units["force"], units["time"]) == ("g um s^-2", "s")


def vtk_frames(path):
    vtk_hdf = pytest.importorskip("vtkmodules.vtkIOHDF")
    reader = vtk_hdf.vtkHDFReader()
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    for step in range(reader.GetNumberOfSteps()):
        reader.SetStep(step)
        reader.Update()
        yield reader.GetOutputDataObject(0), reader


def test_vtk_reads_the_rods_with_radius_and_triads(output):
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline as Pipeline

    told("export", output, "-o", "a.vtkhdf", "--radius", 0.13)
    seen = 0
    for index, (data, reader) in enumerate(vtk_frames("a.vtkhdf")):
        fields, points = frame(index)[0], data.GetPointData()
        arrays = {points.GetArrayName(i): vtk_to_numpy(points.GetArray(i))
                  for i in range(points.GetNumberOfArrays())}  # fmt: skip
        assert np.array_equal(vtk_to_numpy(data.GetPoints().GetData()), fields["position"].T)
        for i in range(3):
            assert np.array_equal(arrays[f"D{i + 1}"], fields["director"][i].T)
        for name in ("velocity", "angular_velocity", "force", "torque"):
            assert np.array_equal(arrays[name], fields[name].T)
        assert arrays["radius"].tolist() == [0.13] * POINTS
        assert arrays["s"].tolist() == [0, 0.25, 0.5, 0.75, 0, 0.5, 1.0, 1.5, 2.0]
        assert data.GetNumberOfLines() == 2
        assert vtk_to_numpy(data.GetCellData().GetArray("rod")).tolist() == [0, 1]
        times = reader.GetOutputInformation(0).Get(Pipeline.TIME_STEPS())
        assert np.array_equal(times, TIMES)
        seen += 1
    assert seen == len(TIMES)


def test_vtk_reads_the_tracers(output):
    from vtkmodules.util.numpy_support import vtk_to_numpy

    told("export", output, "-o", "a.vtkhdf", "--tracers", "--every", 3)
    frames = [data for data, _ in vtk_frames("a.vtkhdf")]
    # The reader gives the same object again: what is in it now is its last step, frame 3.
    assert len(frames) == 2
    assert frames[-1].GetNumberOfVerts() == TRACERS
    points = vtk_to_numpy(frames[-1].GetPoints().GetData())
    assert np.array_equal(points, frame(3)[0]["tracers"].T)


@pytest.mark.parametrize(("blob", "share"), [("algebraic7", 0.60653), ("algebraic9", 0.36788)])
def test_the_radius_is_that_of_the_cylinder_that_moves_alike(tmp_path, monkeypatch, blob, share):
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkFiltersCore import vtkTubeFilter

    monkeypatch.chdir(tmp_path)
    told("run", RING, "-q", *settings(*SHORT, f"fluid.blob={blob}"))
    told("export", "out.h5", "-o", "a.vtkhdf")
    *_, (data, reader) = vtk_frames("a.vtkhdf")
    epsilon = 4 * 2 * np.pi * 2.5 / 40
    radius = vtk_to_numpy(data.GetPointData().GetArray("radius"))
    assert radius == pytest.approx(epsilon * share, rel=1e-5)
    tube = vtkTubeFilter()
    tube.SetInputConnection(reader.GetOutputPort())
    tube.SetInputArrayToProcess(0, 0, 0, 0, "radius")
    tube.SetVaryRadiusToVaryRadiusByAbsoluteScalar()
    tube.SetNumberOfSides(24)
    tube.Update()
    surface = vtk_to_numpy(tube.GetOutput().GetPoints().GetData())
    with open_trajectory("out.h5") as run:
        gaps = np.linalg.norm(surface[:, None] - run.position[-1][None], axis=2).min(axis=1)
        strain = strain_twist(run.director[-1], run.rods[0].spacing, closed=True)
    assert gaps == pytest.approx(radius[0], rel=1e-3)
    size = np.hypot(strain[:, 0], strain[:, 1])
    curvature = vtk_to_numpy(data.GetPointData().GetArray("curvature"))
    assert curvature == pytest.approx(0.5 * (size + np.roll(size, 1)))


def test_vtk_reads_a_flow(tmp_path, monkeypatch):
    from vtkmodules.util.numpy_support import vtk_to_numpy

    vtk_xml = pytest.importorskip("vtkmodules.vtkIOXML")
    monkeypatch.chdir(tmp_path)
    told("run", RING, "-q", *settings(*SHORT))
    for grid, shape in (
        ("box", None),
        ("0.5,-2:2:5,-1.5:1:6", (1, 5, 6)),
        ("0,0,-3:3:7", (1, 1, 7)),
    ):
        for name in ("a.vti", "a.npz", "a.csv"):
            told("flow", "out.h5", "--at", "1e-3", "--grid", grid, "--resolution", 9, "-o", name)
        reader = vtk_xml.vtkXMLImageDataReader()
        reader.SetFileName("a.vti")
        reader.Update()
        image = reader.GetOutput()
        points = [image.GetPoint(i) for i in range(image.GetNumberOfPoints())]
        with np.load("a.npz") as arrays:
            assert image.GetDimensions() == (shape or arrays["pressure"].shape)
            found = {
                k: vtk_to_numpy(image.GetPointData().GetArray(k)) for k in ("velocity", "pressure")
            }
            # VTK counts x fastest, we count z fastest.
            order = np.lexsort(np.round(points, 9).T[[2, 1, 0]])
            x = np.stack(np.meshgrid(*(arrays[c] for c in "xyz"), indexing="ij"), -1).reshape(-1, 3)
            assert np.array(points)[order] == pytest.approx(x, abs=1e-12)
            assert np.array_equal(found["velocity"][order], arrays["velocity"].reshape(-1, 3))
            assert np.array_equal(found["pressure"][order], arrays["pressure"].ravel())
            table = np.loadtxt("a.csv", delimiter=",", skiprows=1)
            assert np.array_equal(table[:, :3], x)
            assert np.array_equal(table[:, 6], arrays["pressure"].ravel())
            assert float(arrays["time"]) == 1e-3


def test_an_earlier_file_is_named_and_a_failed_one_leaves_it(output, monkeypatch):
    told("export", output, "-o", "a.csv")
    assert "wrote a.csv, in place of an earlier one" in told("export", output, "-o", "a.csv")
    before = Path("a.csv").read_text()

    def interrupted(*arguments):
        raise KeyboardInterrupt

    monkeypatch.setattr("rodsim.export.run._arc", interrupted)
    command("export", output, "-o", "a.csv", code=75)
    assert Path("a.csv").read_text() == before
    assert sorted(p.name for p in output.parent.iterdir()) == ["a.csv", "out.h5"]


@pytest.mark.parametrize(
    ("arguments", "code", "words"),
    [
        (("-o", "a.h5"), 2, "a.h5: must end in one of .vtkhdf .csv .npz .py"),
        (("-o", "none/a.csv"), 4, "none/a.csv: cannot be written: No such file"),
    ],
)
def test_what_cannot_be_written_is_said(output, arguments, code, words):
    result = command("export", output, *arguments, code=code)
    assert words in result.stderr

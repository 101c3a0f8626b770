"""ParaView's own reader opens the output: finished, while the run goes on, and after a kill."""

import json
import os
import signal
import subprocess
import sys

import numpy as np
import pytest
from outputs import POINTS, TIMES, create, frame, write

from rodsim.output import open_trajectory

pytest.importorskip("vtkmodules.vtkIOHDF")

LINES = [[0, 1, 2, 3], [4, 5, 6, 7, 8, 4]]  # the second rod is closed


def read_view(path):
    """Return the times and, for each frame, what VTK reads: plain lists, to pass on as JSON."""
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline as Pipeline
    from vtkmodules.vtkIOHDF import vtkHDFReader

    reader, frames = vtkHDFReader(), []
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    for step in range(reader.GetNumberOfSteps()):
        reader.SetStep(step)
        reader.Update()
        data = reader.GetOutputDataObject(0)
        points, cells = data.GetPointData(), data.GetLines()
        arrays = [points.GetArray(i) for i in range(points.GetNumberOfArrays())]
        nodes = [cells.GetCellSize(i) for i in range(cells.GetNumberOfCells())]
        nodes = np.split(vtk_to_numpy(cells.GetConnectivityArray()), np.cumsum(nodes)[:-1])
        frames.append(
            {
                "points": vtk_to_numpy(data.GetPoints().GetData()).tolist(),
                "lines": [line.tolist() for line in nodes],
                "rod": vtk_to_numpy(data.GetCellData().GetArray("rod")).tolist(),
            }
            | {array.GetName(): vtk_to_numpy(array).tolist() for array in arrays}
        )
    times = reader.GetOutputInformation(0).Get(Pipeline.TIME_STEPS())
    return (list(times) if times else None), frames


def read_view_apart(path):
    """Read in a process of its own: a reader that crashes must not end the tests."""
    code = (
        "import json, sys, test_vtk_view; print(json.dumps(test_vtk_view.read_view(sys.argv[1])))"
    )
    return json.loads(python(code, path).communicate()[0])


def python(code, *arguments):
    here = os.path.dirname(__file__)
    return subprocess.Popen(
        [sys.executable, "-c", code, *map(str, arguments)],
        stdout=subprocess.PIPE,
        text=True,
        env=os.environ | {"PYTHONPATH": os.pathsep.join([here, *sys.path])},
    )


def check(view, committed):
    times, frames = view
    # The counters of the file and of the view are two writes: a kill can fall between them. The
    # frame itself is complete before either.
    seen = len(frames)
    assert abs(seen - committed) <= 1
    # VTK takes a single step for data without time
    np.testing.assert_array_equal(times, TIMES[:committed] if committed > 1 else None)
    for index, found in enumerate(frames):
        fields = frame(index)[0]
        np.testing.assert_array_equal(found["points"], fields["position"].T)
        for i in range(3):
            np.testing.assert_array_equal(found[f"D{i + 1}"], fields["director"][i].T)
        for name in ("velocity", "angular_velocity", "force", "torque"):
            np.testing.assert_array_equal(found[name], fields[name].T)
        assert found["lines"] == LINES
        assert found["rod"] == [0, 1]


@pytest.mark.parametrize("committed", [2, len(TIMES)])
def test_vtk_reads_a_finished_run(tmp_path, committed):
    with create(tmp_path / "out.h5") as writer:
        write(writer, range(committed))
    check(read_view(tmp_path / "out.h5"), committed)


def test_vtk_reads_a_run_that_goes_on(tmp_path):
    with create(tmp_path / "out.h5") as writer:
        assert np.shape(read_view(tmp_path / "out.h5")[1][0]["points"]) == (POINTS, 3)  # no frame
        for index in range(len(TIMES)):
            write(writer, [index])
            check(read_view(tmp_path / "out.h5"), index + 1)
            if index in (0, 3):
                check(read_view_apart(tmp_path / "out.h5"), index + 1)


def test_positions_alone_are_enough(tmp_path):
    with create(tmp_path / "out.h5", fields=("position",), tracers=0) as writer:
        write(writer, range(3))
    _, frames = read_view(tmp_path / "out.h5")
    assert set(frames[0]) == {"points", "lines", "rod"}
    np.testing.assert_array_equal(frames[2]["points"], frame(2)[0]["position"].T)


ENDLESS = """
import sys
import numpy as np
from outputs import create, frame
with create(sys.argv[1], times=0.3 * np.arange(3000)) as writer:
    for index in range(3000):
        writer.write_frame(index, 10 * index + 2, *frame(index))
        writer.checkpoint({"X": frame(index)[0]["position"], "time": 0.3 * index, "step": index})
        print(index + 1, flush=True)
"""


@pytest.mark.parametrize("wait", [1, 40, 95])
def test_a_killed_run_is_whole_up_to_its_last_frame(tmp_path, wait):
    path, process = tmp_path / "out.h5", python(ENDLESS, tmp_path / "out.h5")
    for _ in range(wait):
        process.stdout.readline()
    process.send_signal(signal.SIGKILL)
    rest = process.communicate()[0].split()
    assert process.returncode == -signal.SIGKILL  # it did not end before, on its own
    written = int(rest[-1]) if rest else wait
    with open_trajectory(path) as run:
        assert run.status == "running"
        assert run.frames in (written, written + 1)
        for index in range(run.frames):
            np.testing.assert_array_equal(
                run.read("position", index), frame(index)[0]["position"].T
            )
        saved = run.checkpoint()
        assert saved["step"] in (written - 1, written)
        np.testing.assert_array_equal(saved["X"], frame(saved["step"])[0]["position"])
        committed, times = run.frames, run.time.tolist()
    view_times, frames = read_view_apart(path)
    # The counters of the file and of the view are two writes: a kill can fall between them. The
    # frame itself is complete before either.
    seen = len(frames)
    assert abs(seen - committed) <= 1
    # a kill between a frame and its time leaves the last time out, which VTK takes for 0
    assert (
        view_times is None
        or view_times[: committed - 1] == times[: len(view_times[: committed - 1])]
    )
    np.testing.assert_array_equal(frames[-1]["points"], frame(seen - 1)[0]["position"].T)
    create(path).finish("stopped", {})  # the lock of the dead process is in nobody's way

"""The output is a file of H5MD 1.1 (nongnu.org/h5md): what its specification requires is there."""

import h5py
import numpy as np
import pytest
from outputs import POINTS, TIMES, create, frame, write

import rodsim

BODIES = [
    ("position", (3, 3), (0, 1, 0), "particles/bodies/position"),
    ("place", (2, 7), (0, 0, 0), "particles/rotors/place"),
]


@pytest.fixture
def written(tmp_path):
    with create(tmp_path / "out.h5") as writer:
        write(writer, range(len(TIMES)))
        writer.finish("finished", {})
    return tmp_path / "out.h5"


def text(value):
    return value.decode() if isinstance(value, bytes) else str(value)


def test_the_root_says_version_author_and_creator(written):
    with h5py.File(written) as file:
        root = file["h5md"]
        version = root.attrs["version"]
        assert version.dtype.kind == "i"
        assert version.tolist() == [1, 1]
        assert text(root["author"].attrs["name"])
        assert text(root["creator"].attrs["name"]) == "rodsim"
        assert text(root["creator"].attrs["version"]) == rodsim.__version__


def test_every_group_of_particles_has_a_box_without_edges(tmp_path):
    create(tmp_path / "out.h5", extra=BODIES).finish("stopped", {})
    with h5py.File(tmp_path / "out.h5") as file:
        groups = file["particles"]
        assert set(groups) == {"trajectory", "tracers", "bodies", "rotors"}
        assert next(iter(groups)) == "trajectory"  # what a reader takes that is told no name
        for group in groups.values():
            box = group["box"].attrs
            assert box["dimension"].dtype.kind == "i"
            assert box["dimension"] == 3
            assert [text(b) for b in box["boundary"]] == ["none"] * 3
            assert "edges" not in group["box"]  # only for periodic boundaries


def test_every_element_has_value_step_and_time_of_one_length(written):
    elements = []
    with h5py.File(written) as file:
        for place in (*file["particles"].values(), file["observables"]):
            elements += [element for name, element in place.items() if name != "box"]
        assert len(elements) == 6 + 1 + 9
        for element in elements:
            frames = len(TIMES)
            assert element["value"].shape[0] == frames
            assert element["step"].shape == element["time"].shape == (frames,)
            assert element["step"].dtype.kind == "i"
            assert element["time"].dtype.kind == "f"


def test_mdanalysis_reads_all_frames(written):
    """H5MD's best known reader; its numbers are single precision."""
    universe = pytest.importorskip("MDAnalysis").Universe
    run = universe.empty(POINTS, trajectory=False)
    run.load_new(str(written), format="H5MD", convert_units=False)
    assert run.trajectory.n_frames == len(TIMES)
    for k, step in enumerate(run.trajectory):
        assert step.time == TIMES[k]
        np.testing.assert_allclose(step.positions, frame(k)[0]["position"].T, rtol=1e-6)

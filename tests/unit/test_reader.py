"""The reader trusts nothing: files that are not ours, cut short, or pointing elsewhere."""

import h5py
import numpy as np
import pytest
from outputs import POINTS, create, frame, write

from rodsim.errors import FileError
from rodsim.output import open_trajectory

POSITION, POWER = "particles/trajectory/position/value", "observables/power/value"
STEP = "particles/trajectory/position/step"


@pytest.fixture
def output(tmp_path):
    path = tmp_path / "out.h5"
    with create(path, checkpoint={"X": np.arange(5.0)}) as writer:
        write(writer, range(4))
        writer.checkpoint({"X": np.arange(5.0) + 0.5})
    return path


def read_all(path):
    with open_trajectory(path) as run:
        fields = [run.read(name) for name in run.fields]
        return fields, [run.observable(name) for name in run.observables]


@pytest.mark.parametrize(
    "frames", [slice(None), slice(1, 3), slice(-2, None), slice(None, None, -2), slice(3, 1), -1, 2]
)
def test_frames_are_chosen_as_in_a_list(output, frames):
    stored = np.array([frame(index)[0]["force"].T for index in range(4)])
    with open_trajectory(output) as run:
        np.testing.assert_array_equal(run.read("force", frames), stored[frames])


@pytest.mark.parametrize("number", [4, -5, 5])
def test_frames_beyond_the_committed_ones_do_not_exist(output, number):
    with open_trajectory(output) as run, pytest.raises(IndexError):
        run.read("force", number)


def test_a_run_that_goes_on_is_read_up_to_where_it_was(tmp_path):
    with create(tmp_path / "out.h5", tracers=0) as writer:
        with open_trajectory(tmp_path / "out.h5") as run:
            assert run.frames == len(run.time) == 0
            assert run.position.shape == (0, POINTS, 3)
            assert run.tracers.shape == (0, 0, 3)
        write(writer, range(2))
        with open_trajectory(tmp_path / "out.h5") as run:
            write(writer, [2])
            assert (run.frames, len(run.position)) == (2, 2)


@pytest.mark.parametrize("name", ["tracers", "velocity", "../rods", "nonsense"])
def test_what_is_not_stored_is_named(tmp_path, name):
    create(tmp_path / "out.h5", tracers=0, fields=()).finish("stopped", {})
    with open_trajectory(tmp_path / "out.h5") as run:
        with pytest.raises(FileError, match=f"has no {name}; it has position"):
            run.read(name)
        with pytest.raises(FileError, match=f"has no {name}; it has bending_energy"):
            run.observable(name)


@pytest.mark.parametrize(
    ("content", "message"),
    [(None, "no such file"), (b"", "not an HDF5"), (b"title: x\n" * 99, "not an HDF5")],
)
def test_other_files_are_refused(tmp_path, content, message):
    path = tmp_path / "other.h5"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(FileError, match=f"other.h5: {message}"):
        open_trajectory(path)


def test_folders_and_foreign_hdf5_are_refused(tmp_path):
    h5py.File(tmp_path / "foreign.h5", "w").close()
    with pytest.raises(FileError, match=r"foreign.h5: not a rodsim output$"):
        open_trajectory(tmp_path / "foreign.h5")
    with pytest.raises(FileError, match="not an HDF5"):
        open_trajectory(tmp_path)


@pytest.mark.parametrize("part", [0.1, 0.5, 0.9, 0.999])
def test_a_file_cut_short_is_refused(output, part):
    content = output.read_bytes()
    output.write_bytes(content[: int(part * len(content))])
    with pytest.raises(FileError, match=r"out.h5: .*(cut short|damaged)"):
        read_all(output)


def external(file, name):
    del file[name]
    file[name] = h5py.ExternalLink("elsewhere.h5", "/x")


def soft(file, name):
    file["kept"] = file[name]
    del file[name]
    file[name] = h5py.SoftLink("/kept")


def external_storage(file, name):
    shape, dtype = file[name].shape, file[name].dtype
    del file[name]
    file.create_dataset(name, shape, dtype, external=[("elsewhere.bin", 0, h5py.h5f.UNLIMITED)])


def virtual(file, name):
    shape, dtype = file[name].shape, file[name].dtype
    del file[name]
    layout = h5py.VirtualLayout(shape, dtype)
    layout[...] = h5py.VirtualSource("elsewhere.h5", "x", shape)
    file.create_virtual_dataset(name, layout)


@pytest.mark.parametrize("change", [external, soft, external_storage, virtual])
@pytest.mark.parametrize("name", [POSITION, STEP, POWER])
def test_nothing_outside_the_file_is_read(output, tmp_path, change, name):
    with h5py.File(tmp_path / "elsewhere.h5", "w") as file:
        file["x"] = np.full((6, POINTS, 3), 7.5)
    (tmp_path / "elsewhere.bin").write_bytes(bytes(10**4))
    with h5py.File(output, "r+") as file:
        change(file, name)
    with pytest.raises(FileError, match=f"out.h5: damaged: {name} (is a link|lies outside)"):
        read_all(output)


def test_groups_elsewhere_are_not_followed(output):
    with h5py.File(output, "r+") as file:
        external(file, "observables")
    with open_trajectory(output) as run:
        assert run.observables == []


def put(name, value):
    def change(file):
        del file[name]
        file[name] = value

    return change


def attribute(where, name, value):
    return lambda file: file[where].attrs.__setitem__(name, value)


def huge(file):
    del file[POSITION]
    file.create_dataset(POSITION, (10**9, POINTS, 3), "f8", chunks=(1, POINTS, 3))


def impossible_integer(file):
    """An integer of nine bytes, which HDF5 knows and NumPy does not: one flipped bit makes it."""
    del file["committed"]
    kind = h5py.h5t.STD_I64LE.copy()
    kind.set_size(9)
    h5py.h5d.create(file.id, b"committed", kind, h5py.h5s.create(h5py.h5s.SCALAR))


@pytest.mark.parametrize(
    "change",
    [
        impossible_integer,
        put("committed", 10**12),
        put("committed", -1),
        put("committed", 1.5),
        put("committed", [1, 2]),
        put("committed", "four"),
        put(POSITION, np.zeros((3, POINTS, 3))),
        put(POSITION, np.zeros((6, 2, 3))),
        put(POSITION, np.zeros((6, POINTS, 3), int)),
        put(POSITION, h5py.Empty("f8")),
        put("particles/trajectory/position/time", np.full(6, np.nan)),
        put("particles/trajectory/position", 5),
        put(STEP, np.zeros(2, int)),
        put("case/source", 5),
        put("case/overrides", "one"),
        put(POWER, np.zeros((6, 4))),
        huge,
        attribute("/", "status", "sleeping"),
        attribute("/", "format", "one"),
        attribute("rods/alpha", "first", 3),
        attribute("rods/alpha", "count", 2.5),
        attribute("rods/alpha", "moduli", [2.5, 3.5]),
        attribute("rods/zeta", "closed", "yes"),
        attribute("rods/zeta", "index", h5py.Empty("i8")),
        attribute("case", "mass_unit", b"\xff"),
        lambda file: file.__delitem__("rods/zeta"),
        lambda file: file.__delitem__("committed"),
        lambda file: file.__delitem__("case"),
    ],
)
def test_damage_is_one_line(output, change):
    with h5py.File(output, "r+") as file:
        change(file)
    with pytest.raises(FileError, match=r"^[^\n]*out.h5: damaged: [^\n]*$"):
        read_all(output)


def test_a_newer_format_says_so(output):
    with h5py.File(output, "r+") as file:
        file.attrs["format"] = 2
    with pytest.raises(FileError, match="format 2, of a newer rodsim"):
        open_trajectory(output)


def test_damaged_checkpoints_do_not_count(output):
    for damage in (put("X", "text"), put("seal", [1])):
        with h5py.File(output, "r+") as file:
            damage(file["checkpoint/a"])
            damage(file["checkpoint/b"])
        with open_trajectory(output) as run:
            assert run.checkpoint() is None

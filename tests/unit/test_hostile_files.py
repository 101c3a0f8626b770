"""Files made to harm: what they unpack to, what they print, and what they say of their rods."""

import zlib

import h5py
import numpy as np
import pytest
from calls import call, command
from outputs import POINTS, create, frame, write

from rodsim.errors import FileError
from rodsim.output import open_trajectory
from rodsim.output.packed import LARGEST_CHUNK

POSITION = "particles/trajectory/position/value"
SHAPE = (6, POINTS, 3)


@pytest.fixture
def output(tmp_path):
    path = tmp_path / "out.h5"
    with create(path, tracers=0) as writer:
        write(writer, range(4))
    return path


def replaced(path, chunks, **options):
    """Put another dataset in the place of the positions; return it, open, and its file."""
    file = h5py.File(path, "r+")
    values = file[POSITION][()]
    del file[POSITION]
    data = file.create_dataset(POSITION, SHAPE, "f8", chunks=chunks, **options)
    return file, data, values


def test_a_chunk_that_unpacks_to_more_than_it_says_is_not_read(output):
    file, data, _ = replaced(output, SHAPE, compression="gzip")
    with file:  # 256 MB in 260 kB, in the place of 1.3 kB
        data.id.write_direct_chunk((0, 0, 0), zlib.compress(bytes(2**28)))
    with (
        open_trajectory(output) as run,
        pytest.raises(FileError, match=f"{POSITION} has chunks that unpack to more than they say"),
    ):
        run.position  # noqa: B018


def test_a_chunk_that_is_stored_larger_than_it_says_is_not_read(output):
    file, data, _ = replaced(output, SHAPE, compression="lzf")
    with file:
        data.id.write_direct_chunk((0, 0, 0), bytes(2**22))
    with open_trajectory(output) as run, pytest.raises(FileError, match="larger than they say"):
        run.position  # noqa: B018


def test_chunks_larger_than_their_dataset_are_not_read(output):
    rows = LARGEST_CHUNK // (POINTS * 24) + 1
    file, data, _ = replaced(output, (rows, POINTS, 3), compression="gzip", maxshape=(None,) * 3)
    with file:
        data[0] = 0.5
    with open_trajectory(output) as run, pytest.raises(FileError, match="has chunks of 671"):
        run.position  # noqa: B018


@pytest.mark.parametrize(
    "options",
    [
        {"compression": "gzip", "shuffle": True},
        {"compression": "gzip", "fletcher32": True},
        {"compression": "lzf"},
        {"fletcher32": True},
        {},
    ],
)
def test_what_an_honest_program_has_packed_is_read(output, options):
    file, data, values = replaced(output, (2, POINTS, 3), **options)
    with file:
        data[:] = values
    stored = np.array([frame(index)[0]["position"].T for index in range(4)])
    with open_trajectory(output) as run:
        np.testing.assert_array_equal(run.position, stored)


def test_a_large_chunk_that_is_honest_is_read(tmp_path):
    """Random numbers do not pack: its 8 MB are stored as 8 MB, and looked into."""
    from rodsim.output.guarded import GuardedFile

    values = np.random.default_rng(5).normal(size=(2**20,))
    with h5py.File(tmp_path / "large.h5", "w") as file:
        file.create_dataset("x", data=values, chunks=values.shape, compression="gzip")
    with GuardedFile(tmp_path / "large.h5") as file:
        np.testing.assert_array_equal(file.array("x", "f", (None,)), values)


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("spacing", np.nan),
        ("spacing", 0.0),
        ("moduli", np.full(6, np.inf)),
        ("moduli", np.array([0.2, 0.3, -0.4, 0.5, 0.6, 0.7])),
    ],
)
def test_rods_that_cannot_be_are_damage(output, key, value):
    with h5py.File(output, "r+") as file:
        file["rods/alpha"].attrs[key] = value
    with pytest.raises(FileError, match="rods/alpha has a spacing or moduli that no rod can have"):
        open_trajectory(output)


@pytest.mark.parametrize("text", ["[" * 200_000, "{", "3"])
def test_a_case_that_cannot_be_read_is_damage(output, text):
    with h5py.File(output, "r+") as file:
        del file["case/resolved"]
        file["case/resolved"] = text
    with open_trajectory(output) as run, pytest.raises(FileError, match="its case cannot be read"):
        run.case_data()
    checked = call("info", output, "--check")
    assert (checked.exit_code, checked.stderr.count("\n")) == (4, 1)
    assert "damaged: its case cannot be read" in checked.stderr


def test_what_is_missing_is_no_link(output):
    with h5py.File(output, "r+") as file:
        del file["case/times"]
    with pytest.raises(FileError, match=r"damaged: case/times is missing$"):
        open_trajectory(output)


ESCAPES = "\x1b[31mred\x1b]0;title\x07"


def test_nothing_of_a_file_steers_the_terminal(output):
    with h5py.File(output, "r+") as file:
        file.attrs["version"] = ESCAPES
        file.move("rods/alpha", f"rods/{ESCAPES}")
        file["case"].attrs["time_unit"] = ESCAPES
        file["case/resumes"][0] = ESCAPES.encode()
    shown = command("info", output)
    assert shown.stdout.replace("\n", "").isprintable()
    assert shown.stdout.count(r"\x1b[31mred\x1b]0;title\x07") >= 4
    with h5py.File(output, "r+") as file:
        file.attrs["status"] = ESCAPES
    refused = command("info", output, code=4)
    assert refused.stderr.replace("\n", "").isprintable()


def test_nothing_of_a_case_steers_the_terminal(tmp_path):
    title = r'title: "\e[31mred"'
    (tmp_path / "case.yaml").write_text(
        f"{title}\nfluid: {{viscosity: 2e-6, epsilon: 0.3}}\n"
        "rods: {r: {shape: {kind: straight, points: 5, length: 2},"
        " moduli: {bending: 3e-3, twisting: 2e-3, shear: 0.7, stretch: 0.9}}}\ntime: {end: 0.5}\n"
    )
    shown = command("info", tmp_path / "case.yaml")
    assert shown.stdout.startswith(r"\x1b[31mred")

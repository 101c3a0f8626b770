"""A file that is gone on with is written past HDF5: numbers must lie where they are thought."""

import h5py
import numpy as np
import pytest
from outputs import create, frame, make_plan, write

from rodsim.errors import FileError
from rodsim.output import open_trajectory
from rodsim.output.paths import OutputLock
from rodsim.output.reopen import reopen

LENGTHS = "observables/length/value"


@pytest.fixture
def output(tmp_path):
    path = tmp_path / "out.h5"
    with create(path) as writer:
        write(writer, range(4))
    return path


def opened_again(path):
    lock = OutputLock(path)
    lock.acquire()
    try:
        return reopen(path, make_plan(), lock)
    except FileError:
        lock.release()
        raise


def laid_out(path, name, layout, values=None):
    """Put a dataset in the place of another one, with its numbers in HDF5's other layouts."""
    with h5py.File(path, "r+") as file:
        values = file[name][()] if values is None else values
        del file[name]
        properties = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
        properties.set_layout(layout)
        if layout == h5py.h5d.CHUNKED:
            properties.set_chunk(values.shape)
        file.create_dataset(name, data=values, dcpl=properties)


def test_it_goes_on_where_it_was(output):
    with opened_again(output) as writer:
        write(writer, [4])
    with open_trajectory(output) as run:
        assert run.frames == 5
        director = frame(4)[0]["director"].transpose(2, 0, 1)
        np.testing.assert_array_equal(run.read("director", 4), director)
        np.testing.assert_array_equal(run.observable("length")[4], frame(4)[1]["length"])


@pytest.mark.parametrize("layout", [h5py.h5d.CHUNKED, h5py.h5d.COMPACT])
@pytest.mark.parametrize("name", [LENGTHS, "checkpoint/a/seal"])
def test_what_is_not_in_one_piece_of_the_file_is_refused(output, layout, name):
    laid_out(output, name, layout)
    before = output.read_bytes()
    with pytest.raises(FileError, match=f"{name} was laid out anew by another program"):
        opened_again(output)
    assert output.read_bytes() == before


def test_numbers_of_another_byte_order_are_written_in_it(output):
    with h5py.File(output) as file:
        values = file[LENGTHS][()]
    laid_out(output, LENGTHS, h5py.h5d.CONTIGUOUS, values.astype(">f8"))
    with opened_again(output) as writer:
        write(writer, [4])
    with open_trajectory(output) as run:
        np.testing.assert_array_equal(run.observable("length")[4], frame(4)[1]["length"])


def test_a_place_beyond_the_end_is_refused(output):
    with h5py.File(output) as file:
        place = file[LENGTHS].id.get_offset()
    there, size = place.to_bytes(8, "little"), output.stat().st_size
    contents = output.read_bytes()
    assert contents.count(there) == 1
    output.write_bytes(contents.replace(there, (size - 8).to_bytes(8, "little")))
    with pytest.raises(FileError, match=LENGTHS):
        opened_again(output)
    assert output.stat().st_size == size


def test_a_dataset_held_open_in_this_process_shows_every_frame(tmp_path, output):
    path = tmp_path / "new.h5"
    with create(path) as writer:
        check_what_is_held(path, writer, 0)
    with opened_again(output) as writer:
        check_what_is_held(output, writer, 4)


def check_what_is_held(path, writer, first):
    with h5py.File(path, "r", locking=False) as file:
        committed, lengths = file["committed"], file[LENGTHS]
        for index in range(first, 6):
            assert (committed[()], np.isfinite(lengths[:, 0]).sum()) == (index, index)
            write(writer, [index])
            np.testing.assert_array_equal(lengths[index], frame(index)[1]["length"])
        assert committed[()] == 6

"""Grids by their words, and which frame a time means."""

import numpy as np
import pytest

from rodsim.analysis.frames import nearest_frame, spread_frames
from rodsim.analysis.grid import MARGIN, make_grid
from rodsim.errors import UsageError

LOW, HIGH = np.array([-0.5, 1.0, -7.0]), np.array([0.5, 3.0, 5.0])  # extents 1, 2, 12
POSITION = np.array([LOW, HIGH, 0.5 * (LOW + HIGH)])


def test_numbers_say_it_all():
    grid = make_grid("0.25,-2:3:6,-1:1.5:3", POSITION)
    assert grid.shape == (1, 6, 3)
    assert grid.x.tolist() == [0.25]
    assert grid.y.tolist() == [-2, -1, 0, 1, 2, 3]
    assert grid.z.tolist() == [-1, 0.25, 1.5]
    assert grid.points[:4].tolist() == [
        [0.25, -2, -1], [0.25, -2, 0.25], [0.25, -2, 1.5], [0.25, -1, -1]
    ]  # fmt: skip
    assert (grid.origin, grid.step, grid.varying) == ((0.25, -2, -1), (1, 1, 1.25), [1, 2])


@pytest.mark.parametrize(
    ("text", "varying", "fixed"),
    [
        ("plane", [1, 2], {0: 0.0}),
        ("plane:xy", [0, 1], {2: -1.0}),
        ("plane:zx@2.5", [0, 2], {1: 2.5}),
        ("line", [2], {0: 0.0, 1: 2.0}),
        ("line:x@-1,4e-1", [0], {1: -1.0, 2: 0.4}),
        ("box", [0, 1, 2], {}),
    ],
)
def test_words_make_grids_around_the_rods(text, varying, fixed):
    grid = make_grid(text, POSITION, 25)
    assert grid.varying == varying
    for axis, coordinate in fixed.items():
        assert (grid.x, grid.y, grid.z)[axis].tolist() == [coordinate]
    step = grid.step[varying[0]]
    for axis in varying:
        values = (grid.x, grid.y, grid.z)[axis]
        assert np.diff(values) == pytest.approx(step)
        room = LOW[axis] - values[0], values[-1] - HIGH[axis]
        # The margin, to half a step: the steps are equal along all axes.
        assert room == pytest.approx((MARGIN * 12, MARGIN * 12), abs=0.51 * step)
    assert max(grid.shape) == 25


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("plan", "write plane, plane:yz"),
        ("plane:yy", "name 2 different axes"),
        ("plane:x", "name 2 different axes"),
        ("line:w", "name 1 different axes"),
        ("plane:yz@1,2", "after @ give x"),
        ("plane:yz@left", "'left' is not a number"),
        ("0,1:2,3:4:5", "'1:2' must be a number or FIRST:LAST:COUNT"),
        ("0,2:1:5,3", "the last value must be above the first"),
        ("0,1:2:1,3", "COUNT > 1"),
        ("nan,1:2:3,3", "'nan' is not a number"),
        ("0:1:900,0:1:900,0:1:900", "more than 50000000 points"),
        ("0:1:99999999999999,0,0", "more than 50000000 points"),
    ],
)
def test_what_cannot_be_meant_is_said(text, words):
    with pytest.raises(UsageError, match=r"^grid ") as error:
        make_grid(text, POSITION)
    assert words in str(error.value)


def test_the_frame_nearest_to_a_time():
    times = np.array([0.0, 0.3, 0.6, 1.7])
    assert [nearest_frame(times, t, "s") for t in (0.0, 0.14, 0.16, 1.2, 1.7)] == [0, 0, 1, 3, 3]
    for outside in (-0.1, 1.71, np.nan):
        with pytest.raises(UsageError, match=r"frames from 0 to 1\.7 s"):
            nearest_frame(times, outside, "s")


def test_frames_are_spread_from_the_first_to_the_last():
    assert spread_frames(101, 6) == [0, 20, 40, 60, 80, 100]
    assert spread_frames(3, 6) == [0, 1, 2]
    assert spread_frames(1, 6) == [0]
    assert spread_frames(5, 1) == [0]

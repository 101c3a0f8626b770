"""The last lines of a run: how small the gap got, how fast the rods still move."""

import numpy as np
import pytest

from rodsim.run.ending import Motion, gap_sentence

UNITS = {"length": "um", "mass": "g", "time": "s"}
RNG = np.random.default_rng(8)
X = RNG.normal(size=(3, 7))


def motion(moved, driven=False, steps=None):
    """Return the motion of frames 0.5 s apart in which point 4 moves that far along (2, 3, 6)/7."""
    made, position = Motion(driven), X.copy()
    made.add(0, 0.0, position)
    for k, distance in enumerate(moved):
        position = position.copy()
        position[:, 4] += np.array([2.0, 3.0, 6.0]) / 7.0 * distance
        position[:, 1] += 0.3 * distance
        made.add(steps[k] if steps else k + 1, 0.5 * (k + 1), position)
    return made


def test_speed_is_that_of_the_fastest_point():
    np.testing.assert_allclose(motion([0.3, 0.7]).speeds(), [0.6, 1.4], rtol=1e-12)
    assert motion([]).sentence(UNITS) == ""


@pytest.mark.parametrize(
    ("moved", "said"),
    [
        ([1e-4], "still moving: fastest point 0.0002 um/s over the last 0.5 s"),
        ([4e-4, 2e-4, 1e-4], "0.0002 um/s over the last 0.5 s, slowing down from 0.0008"),
        ([4e-4, 2e-4, 4e-4, 7e-4], "over the last 0.5 s, growing from 0.0004"),
        ([4e-4, 2e-4, 4e-4, 5e-4], "over the last 0.5 s"),  # by less than 3: of any end state
        ([2e-4, 8e-4], "over the last 0.5 s"),  # once only
        ([3e-6, 7e-5], "over the last 0.5 s, growing from 6e-06"),  # once, but by 20
        ([0.0, 0.0, 0.0], "still moving: fastest point 0 um/s over the last 0.5 s"),
    ],
)  # fmt: skip
def test_growth_is_told_from_noise(moved, said):
    assert motion(moved).sentence(UNITS).endswith(said)


def test_of_the_frames_in_a_step_only_the_last_counts():
    made = motion([0.3, 0.9, 0.2, 0.5], steps=[1, 4, 4, 4])
    np.testing.assert_allclose(made.speeds(), [0.6, 1.6 / 1.5], rtol=1e-12)


def test_what_is_driven_neither_grows_nor_is_still_moving():
    text = motion([1e-4, 2e-4, 9e-4], driven=True).sentence(UNITS)
    assert text == "fastest point 0.0018 um/s over the last 0.5 s"


def test_gap_in_words():
    text = gap_sentence(0.1234, 0.35, 0.2426, UNITS)
    assert text == "smallest gap 0.123 um at t = 0.35 s; the rods are 0.243 um thick"
    assert gap_sentence(np.inf, np.nan, 0.2426, UNITS) == ""

"""What stands over frames and beside arrows."""

from types import SimpleNamespace

import numpy as np
import pytest

pytest.importorskip("matplotlib")

from rodsim.plotting.look import _modes
from rodsim.plotting.shapes import Shapes
from rodsim.plotting.surround import SHORT, _letters


def heading(observables, frame):
    """Return what stands over a frame of a file with such observables."""
    run = SimpleNamespace(observables=observables, time=np.array([0.0, 1.0, 3.0]))
    chosen, nothing = [0, 2], np.zeros((2, 0, 3))
    shapes = Shapes(run.time[chosen], nothing, None, [], [], nothing, {"time": "us"}, 0.1, "line",
                    names=_modes(run, chosen))  # fmt: skip
    return shapes.stamp(frame)


def test_frames_of_modes_are_called_by_the_mode():
    modes = ("residual", "mode_stiffness")
    assert [heading(modes, frame) for frame in (0, 1)] == ["at rest", "mode 3"]
    assert heading(("residual",), 1) == "t = 3 µs"


@pytest.mark.parametrize("out_of_page", [(0.05, 0.3), (-0.2, -0.25), (0.0, 0.0)])
def test_letters_of_a_compass_stand_apart(out_of_page):
    """Also that of an arrow which points at the reader, or beside another one."""
    arrows = np.array([[0.0, 0.95], [0.9, -0.1], out_of_page])
    letters = _letters(arrows)
    for k, place in enumerate(letters):
        assert np.hypot(*(place - np.delete(letters, k, axis=0)).T).min() > SHORT
        assert np.hypot(*place) > 0.99 * SHORT
    assert letters[:2] == pytest.approx(1.4 * arrows[:2])

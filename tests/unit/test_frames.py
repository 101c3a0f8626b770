import numpy as np
import pytest

from rodsim.run.recorder import frame_times


@pytest.mark.parametrize(
    ("end", "interval", "count"),
    [(0.3, 0.1, 4), (1e-3, 1e-5, 101), (0.7, 0.2, 5), (2e-3, 0.5, 2), (1e-300, 3e-302, 35)],
)
def test_frames_begin_at_0_end_at_the_end_and_are_whole_multiples_between(end, interval, count):
    times = frame_times(end, interval)
    assert len(times) == count
    assert times[0] == 0.0
    assert times[-1] == end  # exactly: 3 * 0.1 is not 0.3
    assert np.array_equal(times[1:-1], interval * np.arange(1, count - 1))
    assert (np.diff(times) > 0).all()

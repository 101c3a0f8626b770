"""Rows of a fixed step that are run over a first part only: which, and what is made of them."""

from types import SimpleNamespace

import pytest
from scenes import load

from rodsim.convergence.outcome import Errors, Outcome
from rodsim.convergence.rows import Row
from rodsim.convergence.stretch import Stretch, grown, shorten_costly, to_the_end
from rodsim.convergence.study import Study

END = 0.008


def row(method, steps, evaluations, part=1.0):
    return Row("step", method, END / steps, (f"time.step={END / steps!r}",), evaluations, part)


GUIDE, REFERENCE = row("euler", 3000, 3000.0), row("rkc", 1, 1700.0)


def of(*found):
    return shorten_costly([GUIDE, *found], REFERENCE, load("open_rod", f"time.end={END}"))


def test_only_what_costs_more_than_twice_the_reference_is_shortened_and_never_the_guide():
    cheap, costly = row("euler", 3400, 3400.0), row("rk4", 3420, 13680.0)
    rows, stretch = of(cheap, costly)
    assert rows[:2] == [GUIDE, cheap]
    short = rows[2]
    assert (short.part, short.evaluations) == (0.05, pytest.approx(684.0))
    assert short.overrides == (*costly.overrides, "time.end=0.0004", "output.interval=0.0004")
    assert stretch.guide == GUIDE
    for part, whole in ((stretch.reference, REFERENCE), (stretch.guide_part, GUIDE)):
        assert (part.value, part.part) == (whole.value, 0.05)
    assert of(cheap) == ([GUIDE, cheap], None)


def test_where_steps_do_not_lead_to_the_end_of_the_part_all_is_run():
    costly = row("rk4", 3421, 13684.0)  # no multiple of 20
    assert of(costly) == ([GUIDE, costly], None)


def outcome(steps, evaluations, *seconds):
    return Outcome(None, None, None, None, seconds, evaluations, steps, 0)


def test_cost_to_the_end_is_in_proportion_to_what_is_counted():
    """RK4: four evaluations a step, and 45 beside the steps, as the guide has them."""
    run = to_the_end(outcome(150, 645, 0.3, 0.2), row("rk4", 3000, 0.0, 0.05),
                     outcome(3000, 3045))  # fmt: skip
    assert (run.steps, run.evaluations) == (3000, 12045)
    assert run.seconds == pytest.approx((0.3 * 12045 / 645, 0.2 * 12045 / 645))


def test_errors_grow_as_those_of_the_guide():
    """e(t) E(T)/E(t); there is none where nothing is driven, and none known of a guide without."""
    errors = [Errors(*(scale * x for x in (3.0, 0.5, 2.0, 7.0, 0.0)), None, scale * 0.3)
              for scale in (1.0, 4.0, 20.0)]  # fmt: skip
    assert vars(grown(*errors)) == vars(Errors(15.0, 2.5, 10.0, 35.0, 0.0, None, 1.5))


def test_without_a_guide_nothing_is_told_of_the_end():
    stretch = Stretch(REFERENCE, GUIDE, GUIDE)
    failed = SimpleNamespace(_outcome=lambda row: "diverged: step 7")
    result = Study._stretch(failed, stretch, row("rk4", 3000, 0.0, 0.05), None, None)
    assert result.outcome is None
    assert result.status == "run to 5%, euler is diverged: step 7"

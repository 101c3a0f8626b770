"""Observed orders in time, of positions and triads, on an open rod in motion."""

import numpy as np
import pytest
from scenes import difference, last, system_of

from rodsim.integrators.euler import Euler
from rodsim.integrators.fastest_rate import FastestRate
from rodsim.integrators.rk4 import RK4
from rodsim.integrators.rkc import RKC

# Few points and a blob of 3 spacings: stiff enough to need stages, cheap enough without the JIT.
SCENE = ("open_rod", "rods.rod.shape.points=12", "fluid.epsilon.spacings=3")
SETTLED, END = 1e-4, 1e-4


class FixedRKC(RKC):
    """RKC without its controller: steps of our choice, the same number of stages in each."""

    STAGES = 12

    def __init__(self, system, step):
        super().__init__(system, tolerance=1e-4)
        self.step = step

    def _accepted(self, state, f0, end):
        return self.step, self.attempt(state, f0, self.step)

    def _estimate_rate(self, state, f0):
        self.fastest_rate = (self.STAGES - 0.5) ** 2 / (1.54 * self.step)


class PlainRKC2(FixedRKC):
    """Without the correction by its own defect this is the RKC2 of the literature."""

    def steps(self, state, end):
        self._defect.accept = lambda third, size: None
        return super().steps(state, end)


@pytest.fixture(scope="module")
def settled():
    """The scene after its first transient, whose fast modes no step of this test resolves."""
    case, system = system_of(*SCENE, f"time.end={SETTLED}", "time.tolerance=1e-10")
    integrator = RKC(system, case.time.tolerance)
    state = last(integrator.steps(system.scene.initial, SETTLED)).end
    state.time = 0.0  # nothing in this scene depends on time; fixed steps count from zero
    return system, state


@pytest.fixture(scope="module")
def exact(settled):
    return march(RK4, settled, 400)


def march(method, settled, steps):
    system, start = settled
    integrator = method(system, END / steps)
    for step in integrator.steps(start, END):
        if step.number == steps:
            return step.end
    raise AssertionError("too few steps")


@pytest.mark.parametrize(
    ("method", "order", "steps"),
    [(Euler, 1, 160), (PlainRKC2, 2, 40), (FixedRKC, 3, 40), (RK4, 4, 50)],
)
def test_observed_order(method, order, steps, settled, exact):
    errors = np.array([difference(march(method, settled, steps * k), exact) for k in (1, 2)])
    # The next term of the error series is a few per cent at these steps: seen 0.02 to 0.2.
    assert np.log2(errors[0] / errors[1]) == pytest.approx([order, order], abs=0.25)


def test_dense_output_has_the_order_of_the_method(settled, exact):
    """Half-way through one step: the Hermite interpolant errs by O(h^3) locally, like the step."""
    system, start = settled

    def error(size):
        integrator = FixedRKC(system, size)
        step = next(integrator.steps(start, END))
        fine = FixedRKC(system, size / 32)
        for part in fine.steps(start, END):
            if part.number == 16:
                break
        return difference(step.at(start.time + size / 2), part.end)

    ratio = np.array(error(END / 20)) / np.array(error(END / 40))
    assert (np.log2(ratio) > 2.5).all()


def test_dense_output_meets_both_ends_of_the_step(settled):
    system, start = settled
    step = next(FixedRKC(system, END / 20).steps(start, END))
    assert difference(step.at(start.time), start) == (0.0, 0.0)
    nearly = step.at(step.end.time * (1 - 1e-15))
    assert max(difference(nearly, step.end)) < 1e-13


def test_velocities_inside_a_step_are_the_derivative_of_its_dense_output(settled):
    """Central differences of positions, and of triads by w x D = dD/dt."""
    system, start = settled
    step = next(FixedRKC(system, END / 20).steps(start, END))
    time, gap = start.time + 0.37 * step.size, 1e-3 * step.size
    before, here, after = (step.at(time + shift) for shift in (-gap, 0.0, gap))
    u, w = np.split(step.velocities_at(time), 2)
    # The difference quotient errs by gap^2/6 of the third derivative: 1e-6 of a step's change.
    slope = (after.position - before.position) / (2 * gap)
    np.testing.assert_allclose(u, slope, rtol=0, atol=1e-6 * abs(slope).max())
    slope = (after.director - before.director) / (2 * gap)
    turned = np.cross(w[None], here.director, axis=1)
    np.testing.assert_allclose(turned, slope, rtol=0, atol=1e-6 * abs(slope).max())


def test_velocities_at_both_ends_of_a_step_are_those_of_the_fluid(settled):
    system, start = settled
    step = next(FixedRKC(system, END / 20).steps(start, END))
    for state in (start, step.end):
        fields = system.observe(state)[0]
        evaluated = np.concatenate([fields["velocity"], fields["angular_velocity"]])
        # The rate of the rotation vector is a series cut after angle^2: 1e-9 here.
        found = step.velocities_at(state.time)
        np.testing.assert_allclose(found, evaluated, rtol=0, atol=1e-8 * abs(evaluated).max())


@pytest.mark.compiled
def test_velocities_and_power_in_frames_are_smooth_at_the_default_tolerance():
    """Against a tighter run. Evaluated at the interpolated state they are wrong by up to half:
    stiff modes multiply what the interpolant leaves in them. Seen: 1.4 % and 1.5 %, at 1e-4.
    """
    loose, tight = (ring_frames(tolerance) for tolerance in (1e-4, 1e-6))
    for (u, power), (exact, drop) in zip(loose, tight, strict=True):
        assert abs(u - exact).max() < 0.04 * abs(exact).max()
        assert power == pytest.approx(drop, rel=0.04)


def ring_frames(tolerance):
    """Velocities and power of the ring at 20 times up to 20 ms."""
    _, system = system_of("closed_ring", f"time.tolerance={tolerance}", "time.end=0.02")
    times, frames = list(np.arange(1, 21) * 1e-3), []
    for step in RKC(system, tolerance).steps(system.scene.initial, 0.02):
        while times and times[0] <= step.end.time * (1 + 1e-12):
            time = min(times.pop(0), step.end.time)
            fields, seen = system.observe(step.at(time), step.velocities_at(time))
            frames.append((fields["velocity"], seen["power"].sum()))
    return frames


@pytest.mark.parametrize(("method", "limit"), [(Euler, 2.0), (RK4, 2.785)])
def test_stable_below_the_limit_of_the_fastest_rate_and_not_above(method, limit, settled):
    """0.97 of limit/rho decays, 1.05 blows up: rho by Arnoldi iteration is good to a few 1e-4."""
    system, start = settled
    rate = system.velocities(0.0, start, system.zeros(), system.zeros())
    rho = FastestRate(system).estimate(start, rate, tolerance=1e-5)
    spans = []
    for share in (0.97, 1.05):
        integrator = method(system, share * limit / rho)
        for step in integrator.steps(start, 1.0):
            if step.number == 300 or not np.isfinite(step.end.position).all():
                break
        spans.append(np.nanmax(abs(step.increment)) / np.nanmax(abs(rate * integrator.size)))
    assert spans[0] < 1.0
    # 300 steps: the stable one has decayed (1e-5 seen), the other grown until something bent.
    assert spans[0] < 1e-2
    assert not spans[1] < 1.0

"""What each integrator can do in a scene, known before the run."""

from dataclasses import dataclass

from rodsim.integrators import FIXED_STEP
from rodsim.integrators.rkc import RADIUS_SAFETY, stages_for
from rodsim.integrators.spectral import SpectralRadius


@dataclass(frozen=True)
class Limits:
    """Fastest rate (1/time) at t = 0, largest stable steps by method, rkc's stages by step."""

    rate: float
    largest_steps: dict[str, float]
    stages: dict[float, int]


def stability(system) -> Limits:
    """Estimate the fastest rate rho of a system in its initial state, and what follows from it.

    Forward Euler is stable for h < 2/rho, RK4 for h < 2.785/rho. rho is converged to 1 %; a step
    that grows the rate later in the run is not foreseen.
    """
    state = system.scene.initial
    rate = system.velocities(state.time, state, system.zeros(), system.zeros())
    rho = SpectralRadius(system).estimate(state, rate, tolerance=1e-4)
    steps = {name: method.stability_limit / rho for name, method in FIXED_STEP.items()}
    sizes = [float(f"{factor / rho:.0e}") for factor in (1e1, 1e2, 1e3, 1e4)]
    return Limits(rho, steps, {h: stages_for(h, RADIUS_SAFETY * rho) for h in sizes})

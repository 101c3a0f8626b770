"""The gIB method's time loop: a case file of rodsim in, an output file of rodsim out."""

from dataclasses import dataclass
from time import perf_counter

import numpy as np

from gib.coupling import interpolate, spread
from gib.fluid import Fluid
from rodsim.compiled.rotations import rotate
from rodsim.errors import CaseError, DivergedError
from rodsim.output import TrajectoryWriter
from rodsim.progress import Silent
from rodsim.run.gap import Gap
from rodsim.run.recorder import plan_output
from rodsim.scene.build import build_scene
from rodsim.scene.evaluation import loads_of
from rodsim.scene.state import State
from rodsim.scene.system import RodSystem

STEP = 1e-6  # s, Table 1


@dataclass
class Setup:
    """What a case file does not say: the grid (Table 1), the step, the threads.

    ``box`` None: n times two spacings of the rod, so that h = c = 2 ds (Table 1's 10 um, 64 points
    and h = 2 ds = 0.157 um do not fit together: 64 of these are 10.05 um).
    """

    n: int = 64
    box: float | None = None
    step: float = STEP
    threads: int = 1


class ImmersedRods:
    """Rods of a scene in a grid of fluid, from rest; forward Euler for the rods, as the paper."""

    def __init__(self, case, setup: Setup):
        if case.fluid.density is None:
            reason = "the Navier-Stokes equations need fluid.density"
            raise CaseError([case.source.problem("fluid", reason)])
        self.scene, self.step = build_scene(case), setup.step
        box = setup.box or setup.n * 2.0 * float(self.scene.rods.spacing[0])
        self.fluid = Fluid(setup.n, box, case.fluid.density, case.fluid.viscosity, setup.threads)
        self.state, self.steps = self.scene.initial, 0
        shape = 6, self.scene.rods.points
        self.loads, self.rates = np.empty((2, *shape))

    def advance(self) -> None:
        """Loads at X^n, then u^(n+1), then (34), (35): X^n moved by dt U, triads turned by dt W."""
        state, h = self.state, self.fluid.spacing
        self.find_loads()
        spread(state.position, self.loads, h, self.fluid.force)
        self.fluid.advance(self.step)
        self.find_rates()
        director = np.empty_like(state.director)
        rotate(self.step * self.rates[3:], state.director, director)
        self.steps += 1
        position = state.position + self.step * self.rates[:3]
        self.state = State(self.steps * self.step, position, director, state.tracer)

    def find_loads(self) -> np.ndarray:
        """Return the point loads g over m (6, N) of the present state."""
        self.loads = loads_of(self.scene, self.state)
        return self.loads

    def find_rates(self) -> np.ndarray:
        """Return U over W (6, N) of the present state in the present fluid."""
        interpolate(self.state.position, self.fluid.velocity, self.fluid.spacing, self.rates)
        return self.rates


def simulate(
    case, output, setup=None, *, overwrite=True, progress=None, max_seconds=np.inf
) -> dict:
    """Run a case by the gIB method into a file that :func:`rodsim.open_trajectory` reads.

    The case's integrator and step are not used, nor its tracers moved. Kinetic energy is that of
    the tube of radius epsilon in the case, as rodsim has it, with the velocities of the gIB method:
    it compares velocities. A run that lasts longer than ``max_seconds`` ends early, its status is
    then "stopped". Returns what is stored as ``/runtime``. Raises DivergedError.
    """
    setup, progress, begin = setup or Setup(), progress or Silent(), perf_counter()
    rods = ImmersedRods(case, setup)
    observe = _observer(rods, case)
    plan = plan_output(case, rods.scene, checkpoint={})
    with TrajectoryWriter.create(output, plan, overwrite) as writer:
        writer.write_frame(0, 0, *observe())
        solve, index = 0.0, 0
        while index + 1 < len(writer.times) and perf_counter() - begin < max_seconds:
            index += 1
            solve += _march(rods, float(writer.times[index]), case.time.end, progress)
            if not np.isfinite(rods.state.position).all():
                writer.finish("diverged", {})
                raise DivergedError(f"gIB: the rod is no longer finite at step {rods.steps}")
            writer.write_frame(index, rods.steps, *observe())
        runtime = {
            "wall_seconds": perf_counter() - begin,
            "solve_seconds": solve,
            "evaluations": rods.steps,
            "steps_accepted": rods.steps,
            "threads": setup.threads,
        }
        writer.finish("finished" if index + 1 == len(writer.times) else "stopped", runtime)
    return runtime


def _observer(rods, case):
    """Return the function that gives fields and observables of the rods as they are."""
    system, gap = RodSystem(rods.scene), Gap(rods.scene, case.units.names)

    def observe():
        fields, observables = system.observe(rods.state, rods.find_rates())
        return fields, observables | gap.measure(rods.state)

    return observe


def _march(rods, time, end, progress):
    """Make the steps to a frame; return the seconds they took."""
    start = perf_counter()
    for _ in range(round(time / rods.step) - rods.steps):
        rods.advance()
        progress.update(rods.steps * rods.step / end)
    rods.state.time = time
    return perf_counter() - start

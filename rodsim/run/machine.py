"""The compiled parts of a run, put together for one case. Importing this compiles the kernels."""

from functools import cached_property

from rodsim.compiled.threads import pairs_worth, threads_for
from rodsim.integrators.fastest_rate import FastestRate
from rodsim.integrators.limits import Limits, check_step, stability
from rodsim.integrators.make import make_integrator
from rodsim.run.gap import Gap
from rodsim.run.watch import Watch
from rodsim.scene.system import RodSystem


class Machine:
    """System, integrator, gap and watch of a case."""

    def __init__(self, case, scene, force: bool):
        """``force``: let a fixed step be above its limit of stability."""
        self.case, self.force = case, force
        self.system = RodSystem(scene)
        fastest = FastestRate(self.system)  # one estimate serves all who need the fastest rate
        self._fastest = fastest
        self.integrator = make_integrator(case.time, self.system, fastest, case.max_step_size)
        self.gap = Gap(scene, case.units.model_dump())
        self.watch = Watch(case, self.system, self.integrator, None if force else fastest)

    @cached_property
    def limits(self) -> Limits:
        """What each method can do from the initial state."""
        return stability(self.system, self._fastest)

    def threads(self, asked: int | None):
        """Return the context in which sums run with the threads this scene is worth."""
        scene = self.system.scene
        tracers, at_wall = scene.initial.tracer.shape[1], scene.wall is not None
        return threads_for(pairs_worth(scene.rods.points, tracers, scene.planar, at_wall), asked)

    def step_warnings(self) -> list:
        """Return problems of a fixed step near its limit; raises CaseError above it."""
        return [] if self.force else check_step(self.case, self.limits)

"""A background flow: the flow far away, u_inf(x, y, z, t), to which that of the rods is added.

The equations of Stokes are linear, so dX/dt = u + u_inf at X, and triads turn with w + w_inf,
w_inf = 1/2 curl u_inf, from exact derivatives of the formulas. The loads stay; tracers move with
u_inf too. Any linear flow U + G (x - x_0) is of this kind, and any parabolic one, such as that
between plates, 4 U z (H - z)/H^2, or in a tube, U (1 - (x^2 + y^2)/a^2): the profile only, without
its walls. The pressure is p_inf = mu x . lap u_inf where lap u_inf is the same everywhere (0 in a
linear flow); another flow gets none.

Its power on the rods is P = -sum (g.u_inf + m.w_inf) with the loads g, m on the fluid.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from rodsim.case.expressions import Expression
from rodsim.case.fields import expression_in, number_or
from rodsim.case.graph import Graph
from rodsim.compiled.parts import FLOW, TRACERS, Part
from rodsim.compiled.row import Entry, Row
from rodsim.errors import CaseError
from rodsim.registry import Kind

SPACE, VARIABLES = ("x", "y", "z"), ("x", "y", "z", "t")
DIVERGENCE = 1e-8  # of the gradient: what is more is a slip
ON_WALL = 1e-12  # of the gradient times the length of a rod: rounding
LOOKED_AT = np.linspace(0.0, 1.0, 12)  # of the run: when it is checked
WATCHED = 20  # points at which it is looked at how fast the flow changes


class Background:
    """The formulas of a flow: three, in x, y, z, t, with their derivatives."""

    def __init__(self, entries):
        self.velocity = [
            e if isinstance(e, Expression) else Expression(repr(e), {}, VARIABLES) for e in entries
        ]
        self.gradient = [[u.derivative(axis) for axis in SPACE] for u in self.velocity]

    def at(self, points, t) -> np.ndarray:
        """Return u_inf (3, n) at points (3, n)."""
        return np.array([u(*points, t) for u in self.velocity])

    def gradient_at(self, points, t) -> np.ndarray:
        """Return du_i/dx_j (3, 3, n) at points (3, n)."""
        return np.array([[slope(*points, t) for slope in row] for row in self.gradient])

    @property
    def driven(self) -> bool:
        """Whether it depends on time."""
        return any(u.uses_t for u in self.velocity)

    def table(self) -> tuple[np.ndarray, list[int]]:
        """Return the formulas of u_inf and w_inf as a table, and the lines of the six of them."""
        from rodsim.compiled.formula import table_of

        graph = Graph()
        outputs = [u.add_to(graph) for u in self.velocity]
        half = graph.constant(0.5)
        for i in range(3):
            j, k = (i + 1) % 3, (i + 2) % 3
            slopes = self.gradient[k][j].add_to(graph), self.gradient[j][k].add_to(graph)
            outputs.append(graph.apply("*", half, graph.apply("-", *slopes)))
        return table_of(graph, outputs)

    def numbers(self, planar: bool) -> np.ndarray:
        """Return the fixed numbers of :mod:`rodsim.flows.carried`."""
        table, lines = self.table()
        return np.concatenate([[float(planar)], lines, table.ravel()])

    def laplacian(self) -> list | None:
        """Return lap u_inf as three functions of t, or None where it depends on the place."""
        found = []
        for row in self.gradient:
            terms = [slope.derivative(axis) for slope, axis in zip(row, SPACE, strict=True)]
            if any(term.uses - {"t"} for term in terms):
                return None
            found.append(terms)
        return [
            lambda t, terms=terms: sum(float(term(0.0, 0.0, 0.0, t)) for term in terms)
            for terms in found
        ]


def _build(case, scene) -> list[Part]:
    if case.fluid.flow is None:
        return []
    flow = Background(case.fluid.flow)
    _check_flow(flow, case, scene)
    fixed = flow.numbers(scene.planar)
    row = _time_row(flow, scene)
    home = "rodsim.flows.carried:"
    return [
        Part("flow", FLOW, f"{home}carry_rods", row, fixed, drive="fluid.flow", external=True),
        Part("flow", TRACERS, f"{home}carry_tracers", row, fixed, drive="fluid.flow",
             external=True, pressure=_pressure(flow, case.fluid.viscosity)),
    ]  # fmt: skip


class Now:
    """The time, as an entry of a row."""

    uses_t = True

    def __call__(self, s, t):
        """Return t."""
        return t + 0.0 * s


class _AtPlace:
    """A component of the flow at some places, to see how fast it changes."""

    def __init__(self, velocity, points):
        self.velocity, self.points = velocity, points
        self.uses_t = velocity.uses_t

    def __call__(self, s, t):
        return self.velocity(*self.points[:, s.astype(int)], t)


def _time_row(flow, scene) -> Row:
    """Return the row that is the time, 0 where the flow is steady."""
    now = Entry(Now() if flow.driven else 0.0, np.zeros(1), 0)
    points = scene.initial.position
    places = np.linspace(0, points.shape[1] - 1, min(WATCHED, points.shape[1])).astype(int)
    watched = [
        Entry(_AtPlace(u, points), places.astype(float), 0, "flow")
        for u in flow.velocity
        if u.uses_t
    ]
    return Row(1, [now], watched)


def _check_flow(flow, case, scene) -> None:
    """Refuse a flow that is not finite, not incompressible, or leaves the plane of the scene."""
    times = case.time.end * LOOKED_AT if flow.driven else LOOKED_AT[:1]
    reasons = (reason for t in times for reason in _problems(flow, scene, t))
    if reason := next(reasons, None):
        raise CaseError([case.source.problem(("fluid", "flow"), reason)])


def _problems(flow, scene, t) -> Iterator[str]:
    """Yield what is wrong with a flow at time t at the points of the rods as they start."""
    velocity, gradient = (f(scene.initial.position, t) for f in (flow.at, flow.gradient_at))
    if not (np.isfinite(velocity).all() and np.isfinite(gradient).all()):
        yield f"is not finite, or has no slope, at the points of the rods at t = {t:.6g}"
        return
    divergence = np.abs(np.einsum("iik->k", gradient))
    size = np.sqrt(np.einsum("ijk,ijk->k", gradient, gradient))
    k = int(np.argmax(divergence - DIVERGENCE * size))
    if divergence[k] > DIVERGENCE * size[k]:
        rod, point = scene.rods.locate(k)
        yield (
            f"is not incompressible: at point {point} of rod '{rod}' at t = {t:.6g} its divergence "
            f"is {divergence[k]:.3g}, its gradient {size[k]:.3g}"
        )
    if scene.planar:
        yield from _out_of_plane(velocity, gradient)
    if scene.wall is not None:
        yield from _on_wall(flow, scene, t)


def _out_of_plane(velocity, gradient) -> Iterator[str]:
    """In a planar scene u_x is 0 and the fluid turns about x alone."""
    spin = np.array([gradient[0, 2] - gradient[2, 0], gradient[1, 0] - gradient[0, 1]])
    if np.abs(velocity[0]).max() > 0.0 or np.abs(spin).max() > 0.0:
        yield "leaves the plane of the scene: u_x must be 0, and u_y, u_z must not depend on x"


def _on_wall(flow, scene, t) -> Iterator[str]:
    """On a wall the background flow vanishes too, as (a z, b z, 0) does at z = 0."""
    points = scene.initial.position.copy()
    points[2] = scene.wall
    speed = np.abs(flow.at(points, t)).max()
    if not speed <= ON_WALL * scene.length_scale * np.abs(flow.gradient_at(points, t)).max():
        yield f"is {speed:.3g} on the wall, z = {scene.wall:g}, at t = {t:.3g}: must vanish"


def _pressure(flow, viscosity):
    laplacian = flow.laplacian()
    if laplacian is None:
        return None

    def pressure(points, sources, loads, t, left):
        """Return p_inf (T,) at points (3, T), 0 at the origin."""
        return viscosity * sum(points[i] * laplacian[i](t) for i in range(3))

    return pressure


KIND = Kind(
    build=_build,
    word="flow",
    where="Fluid",
    words=tuple[(number_or(expression_in(*VARIABLES)),) * 3],
    dimension="velocity",
    about="the flow far away: u_x, u_y, u_z as numbers or expressions in x, y, z, t",
)

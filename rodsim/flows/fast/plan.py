"""From an accuracy to the tables of a fast sum, for the points where they are now.

An error of interpolation through n Chebyshev points falls as rho^-n, rho = 1/theta +
sqrt(1/theta^2 + 1), for arcs that are apart by half of their length over theta: that gives n, where
rods are smooth; of some larger numbers that is taken which makes the fewest pairs. The rule is
only where to begin: each time lists are made, the sum is held against the exact one at 64 points,
evenly spread, and where it is not good enough the rule of what is far is made stricter.

An error of the wrong sign in a mode that is stiff and has almost no mobility would let it grow. So
each point has a little of its own mobility in addition, half of the accuracy: more than the errors,
and positive in all modes. It makes a twentieth of the accuracy in smooth loads.
"""

from __future__ import annotations

import math

import numpy as np

from rodsim.compiled.constants import ON_WALL
from rodsim.flows.blobs import BLOBS
from rodsim.flows.by_threads import velocity_kernel
from rodsim.flows.fast import packed
from rodsim.flows.fast.arcs import COUNT, LO, PROXIES, build_arcs
from rodsim.flows.fast.bounds import bound
from rodsim.flows.fast.groups import grouped, lists_of_groups
from rodsim.flows.fast.lists import both_ways, pairs_of_arcs
from rodsim.flows.fast.parts import group_kernel, sum_kernel
from rodsim.flows.fast.shares import cost_of, shared_out, sums_of
from rodsim.flows.free import EIGHT_PI

WIDE, NARROW = 0.8, 0.5  # theta of a rough and of a fine sum
FINE = 1e-4  # from here on a sum is fine
LARGE = 50_000  # points: errors of far arcs add up, and smoothness is asked twice as much of
MORE, SHARP = (4, 12, 20), 1e-7  # so many more proxies are tried, down to that accuracy
STRICTER = (  # shares of theta and smoothness
    (1.0, 1.0), (0.8, 0.2), (0.65, 0.05), (0.5, 0.01), (0.35, 1e-3), (0.25, 1e-4)
)  # fmt: skip
SAMPLES = 64
# 8 pi mu times u/(g/epsilon) and w/(m/epsilon^3) of a point at itself: H1 and D1/4 at r = 0
OWN = {"algebraic7": (2.0, 2.5), "algebraic9": (3.0, 6.25)}
SAFE = 0.5  # of the accuracy: so much of its own mobility each point has in addition


def theta_for(accuracy: float) -> float:
    """Return the first theta to try."""
    return WIDE if accuracy > FINE else NARROW


def proxies_for(accuracy: float) -> int:
    """Return n, even, with rho^-n near the accuracy."""
    theta = theta_for(accuracy)
    rho = 1.0 / theta + math.sqrt(1.0 / theta**2 + 1.0)
    return max(4, 2 * round(-0.5 * math.log(accuracy) / math.log(rho)))


def rod_sum(points, counts, accuracy, *fluid, **options) -> RodSum:
    """Return the :class:`RodSum` whose number of proxies takes the fewest pairs at points (3, N).

    More than the accuracy needs where rods are smooth let arcs of wound ones be longer.
    """
    more = proxies_for(accuracy) + np.array([0, *(MORE if accuracy >= SHARP else ())])
    sums = [RodSum(counts, accuracy, *fluid, proxies=int(p), **options) for p in more]
    return min(sums, key=lambda one: one.foreseen(points))


class FastSum:
    """The fast sum over some rods: its arcs, and of the last lists the error.

    ``error`` (2,) : |u - u_exact|/|u_exact|, root mean square over 64 points, and the same of w.
    ``pairs`` : how many pairs of points or proxies an evaluation takes.
    """

    def __init__(self, counts, accuracy: float, epsilon, viscosity, wall_height=None, proxies=None):
        self.walled = wall_height is not None
        self.accuracy, self.fluid = accuracy, (epsilon, viscosity, wall_height or 0.0)
        self.held, self.sum = (), (0, 0)
        self.arcs = build_arcs(counts, proxies or proxies_for(accuracy))
        self._tree = self.arcs.nodes, self.arcs.proxies, self.arcs.weights
        self._tree += self.arcs.chunks, self.arcs.tops
        self.error, self.pairs = np.full(2, np.nan), 0
        self.own = 0.0, 0.0

    def rules(self):
        """Yield theta and the smoothness that is asked for, each time stricter."""
        smooth = 10.0 * self.accuracy * (0.5 if self.arcs.points > LARGE else 1.0)
        for wide, rough in STRICTER:
            yield wide * theta_for(self.accuracy), rough * smooth

    def bounds(self, points):
        """Return the bounds (3, K) of all arcs."""
        bounds = np.empty((3, len(self.arcs.nodes)))
        bound(points, *self._tree, bounds)
        return bounds

    def _packed(self, lists, more):
        p = packed
        own = dict(zip((p.NODES, p.SLOTS, p.WEIGHTS, p.CHUNKS, p.TOPS), self._tree, strict=True))
        names = p.FAR_BEGINS, p.FAR, p.NEAR_BEGINS, p.NEAR
        epsilon, viscosity, wall = self.fluid
        numbers = epsilon, viscosity, *self.own, wall, *self.sum
        more |= {p.HELD: np.array(self.held, np.int32)}
        return p.pack(numbers, own | dict(zip(names, lists, strict=True)) | more)

    def _exact(self, blob, planar=False, angular=True):
        return velocity_kernel(BLOBS[blob], planar, angular, self.walled)


class RodSum(FastSum):
    """The fast sum at the points of the rods themselves.

    As a part it is exact at points that are ``held``: ``sum`` has the addresses of the exact sum
    and of its runs.
    """

    def __init__(
        self, counts, accuracy, epsilon, viscosity, blob, planar=False, wall_height=None,
        proxies=None,
    ):  # fmt: skip
        super().__init__(counts, accuracy, epsilon, viscosity, wall_height, proxies)
        alone = np.array(OWN[blob]) / (EIGHT_PI * viscosity * np.array([epsilon, epsilon**3]))
        self.alone, self.own = np.repeat(alone, 3)[:, None], SAFE * accuracy * alone
        self.kernel = sum_kernel(BLOBS[blob], planar, self.walled)
        self.exact = self._exact(blob, planar)

    def sampled(self, points) -> np.ndarray:
        """Return the points (3, S) at which the error is measured."""
        return np.ascontiguousarray(points[:, _spread_out(self.arcs.points)])

    def count(self, points) -> np.ndarray:
        """Return the tables by the first rule, and set ``pairs``, without any measuring."""
        sample = _spread_out(self.arcs.points)
        return self.tables(points, self.bounds(points), next(self.rules()), sample)

    def foreseen(self, points) -> int:
        """Return twice the pairs by the first rule, which holds more often, and the second's."""
        sample, bounds, total = _spread_out(self.arcs.points), self.bounds(points), 0
        for weight, rule in zip((2, 1), self.rules(), strict=False):
            self.tables(points, bounds, rule, sample)
            total += weight * self.pairs
        return total

    def prepare(self, points, loads) -> np.ndarray:
        """Return the tables for points (3, N), so that the sum of loads (6, N) is good enough."""
        bounds, sample = self.bounds(points), _spread_out(self.arcs.points)
        exact = np.zeros((6, len(sample)))
        self.exact(self.sampled(points), points, loads, *self.fluid, exact)
        for rule in self.rules():
            fixed = self.tables(points, bounds, rule, sample)
            found = np.zeros_like(loads)
            self.kernel(fixed, points, loads, True, found)
            alone = self.alone * loads[:, sample]
            self.error = relative_error(found[:, sample], exact, alone)
            if not self.error.max() > self.accuracy:
                break
        return fixed

    def tables(self, points, bounds, rule, sample) -> np.ndarray:
        """Return the tables by one rule; the sample takes part in measuring the error."""
        arcs, nodes = self.arcs, self.arcs.nodes
        far, near = pairs_of_arcs(points, nodes, bounds, arcs.roots, *rule)
        far, near = both_ways(far, len(nodes)), both_ways(near, len(nodes))
        costs = [cost_of(nodes[:, PROXIES], *far), cost_of(nodes[:, COUNT], *near)]
        self.pairs = int(sum(cost.sum() for cost in costs)) + len(self.held) * arcs.points
        holds = np.searchsorted(sample, nodes[:, LO] + nodes[:, COUNT]) > np.searchsorted(
            sample, nodes[:, LO]
        )
        leaves = np.zeros(len(nodes), dtype=bool)
        leaves[arcs.leaves] = True
        work = shared_out(packed.FAR_WORK, costs[0] > 0, costs[0])
        work |= shared_out(packed.NEAR_WORK, leaves, costs[1])
        work |= shared_out(packed.SAMPLE_FAR, holds & (costs[0] > 0), costs[0])
        work |= shared_out(packed.SAMPLE_NEAR, holds & leaves, costs[1])
        return self._packed((*far, *near), work)


class GroupSum(FastSum):
    """The fast sum at other targets."""

    def __init__(self, counts, accuracy, epsilon, viscosity, blob, angular=False, wall_height=None):
        super().__init__(counts, accuracy, epsilon, viscosity, wall_height)
        self.kernel = group_kernel(BLOBS[blob], angular, self.walled)
        self.exact = self._exact(blob, False, angular)
        self.rows = 6 if angular else 3

    @property
    def floor(self) -> float:
        """Height below which there is no fluid."""
        return self.fluid[2] - ON_WALL * self.fluid[0] if self.walled else -math.inf

    def prepare(self, targets, points, loads) -> np.ndarray:
        """Return the tables for targets (3, T) and points (3, N), as for the rods.

        Targets below the wall, where there is no fluid, are left out.
        """
        inside = np.flatnonzero(targets[2] >= self.floor)
        bounds, sample = self.bounds(points), inside[_spread_out(len(inside))]
        some, exact = np.ascontiguousarray(targets[:, sample]), np.zeros((self.rows, len(sample)))
        self.exact(some, points, loads, *self.fluid, exact)
        order, begins = grouped(np.ascontiguousarray(targets[:, inside]))
        groups = inside[order].astype(np.int32), begins
        for rule in self.rules():
            fixed = self.tables(points, targets, bounds, rule, sample, groups)
            found = np.zeros((self.rows, targets.shape[1]))
            self.kernel(fixed, targets, points, loads, True, found)
            self.error = relative_error(found[:, sample], exact)
            if not self.error.max() > self.accuracy:
                break
        return fixed

    def tables(self, points, targets, bounds, rule, sample, groups) -> np.ndarray:
        """Return the tables by one rule."""
        order, begins = groups
        nodes, roots = self.arcs.nodes, self.arcs.roots
        lists = lists_of_groups(points, targets, order, begins, nodes, bounds, roots, *rule)
        sizes = np.diff(begins)
        cost = sizes * (
            sums_of(nodes[:, PROXIES], *lists[:2]) + sums_of(nodes[:, COUNT], *lists[2:])
        )
        self.pairs = int(cost.sum())
        place = np.empty(targets.shape[1], dtype=int)
        place[order] = np.arange(len(order))
        holds = np.zeros(len(sizes), dtype=bool)
        holds[np.searchsorted(begins, place[sample], "right") - 1] = True
        work = {packed.TARGETS: order, packed.GROUPS: begins}
        work |= shared_out(packed.NEAR_WORK, sizes > 0, cost) | shared_out(
            packed.SAMPLE_NEAR, holds, cost
        )
        return self._packed(lists, work)


def relative_error(found, exact, alone=None) -> np.ndarray:
    """Return |found - exact|/|exact| of u, and of w where it is there; all (3 or 6, S).

    Where loads nearly cancel, as what rounding leaves of a rod at rest, over |alone|: the
    velocities that each load alone would give its own point.
    """
    errors = np.zeros(2)
    for k, rows in enumerate((slice(0, 3), slice(3, 6))[: len(exact) // 3]):
        off, size = (np.linalg.norm(a[rows]) for a in (found - exact, exact))
        if alone is not None:
            size = max(size, np.linalg.norm(alone[rows]))
        errors[k] = off / size if size > 0.0 else (np.inf if off > 0.0 else 0.0)
    return errors


def _spread_out(count):
    """Return the numbers of up to 64 points, evenly spread."""
    return np.unique(np.linspace(0, count - 1, min(SAMPLES, count)).astype(int))

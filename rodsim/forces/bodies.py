"""Contact with bodies: its numbers, its energy, how it starts, what it asks of a step.

The formulas are in :mod:`rodsim.forces.surfaces`. A rod that a body holds does not feel that body
within the exclusion from the held end.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rodsim.blocks.distance import distance, local
from rodsim.blocks.ends import held_ends
from rodsim.compiled.parts import FORCE, Part
from rodsim.forces.balls import POINTS, balls_of, surface_numbers

DIAMETER, WALL, BODIES = range(3)
HEAD = 3
NODE, KIND, HALF, RADIUS, BOUND, RUNS, RUN_COUNT, BALLS, BALL_COUNT = range(9)
BODY, RUN, BALL = 9, 3, 5
KERNELS = "rodsim.forces.surfaces:push_off_bodies", "rodsim.forces.surfaces:push_bodies_off_wall"


@dataclass(frozen=True)
class Surfaces:
    """Bodies as contact has them.

    fixed : the numbers of :mod:`rodsim.forces.surfaces`. balls : of each body, (n, 5).
    runs : of each, the points of rods that it meets, (first, end, rod).
    """

    scene: object
    fixed: np.ndarray
    balls: list[np.ndarray]
    runs: list[np.ndarray]

    @property
    def parts(self) -> list[Part]:
        """What acts between bodies and all else, and from the wall."""
        parts = [Part("contact_bodies", FORCE, KERNELS[0], fixed=self.fixed)]
        if self.scene.wall is not None:
            off_wall = Part("contact_bodies_wall", FORCE, KERNELS[1], fixed=self.fixed,
                            external=True, potential=True)  # fmt: skip
            parts.append(off_wall)
        return parts

    @property
    def labels(self) -> tuple[str, ...]:
        """Whose the rows of the contact energy are."""
        return (*self.scene.rods.names, *(body.name for body in self.scene.bodies))

    def meet(self, state) -> tuple[np.ndarray, np.ndarray]:
        """Return energies of rods and bodies (R + B,), and who is nearest: s, who, whose."""
        from rodsim.forces.surfaces import meetings

        energies, nearest = np.zeros(len(self.labels)), np.full(3, np.inf)
        meetings(self.fixed, self.scene.rods.tables, state.position, state.director, energies,
                 nearest)  # fmt: skip
        return energies, nearest

    def turning(self, turn: np.ndarray) -> np.ndarray:
        """Return how far (N,) the farthest ball goes where nodes turn by ``turn`` (3, N)."""
        found = np.zeros(turn.shape[1])
        for body, balls in zip(self.scene.bodies, self.balls, strict=True):
            arm = np.linalg.norm(balls[:, :3], axis=1).max()
            found[body.node] = arm * np.linalg.norm(turn[:, body.node])
        return found

    def closest(self, state) -> tuple[float, str, str, str]:
        """Return how near anything is to a surface, its rod or body, whose surface, and in words.

        Without Numba, at any distance.
        """
        return min(self._distances(state), default=(np.inf, "", "", ""))

    def _distances(self, state):
        scene = self.scene
        frames = [
            (state.director[:, :, body.node].T, state.position[:, body.node])
            for body in scene.bodies
        ]
        for b, (body, frame) in enumerate(zip(scene.bodies, frames, strict=True)):
            if scene.wall is not None:
                z = (frame[0] @ self.balls[b][:, :3].T)[2] + frame[1][2] - self.balls[b][:, 3]
                yield float(z.min()) - scene.wall, body.name, "the wall", f"body '{body.name}' is"
            if body.shape.kind == "file":
                continue
            for first, end, _ in self.runs[b]:
                away = distance(
                    body.shape, body.surface, local(*frame, state.position[:, first:end])
                )
                k = int(np.argmin(away))
                rod, point = scene.rods.locate(int(first) + k)
                yield float(away[k]), rod, f"body '{body.name}'", f"point {point} is"
            for c, (turn, centre) in enumerate(frames):
                if c != b:
                    balls = self.balls[c]
                    there = centre[:, None] + turn @ balls[:, :3].T
                    away = distance(body.shape, body.surface, local(*frame, there)) - balls[:, 3]
                    other = scene.bodies[c].name
                    yield float(away.min()), other, f"body '{body.name}'", f"body '{other}' is"

    def pressed(self, state, limit: float) -> str:
        """Return what is nearer to a surface than a limit, in words, or nothing."""
        s, who, whose = self.meet(state)[1]
        if s >= limit:
            return ""
        name = self.scene.name_of(int(who)).replace(", ", " at ")
        into = "the wall" if whose < 0 else self.scene.name_of(int(whose))
        return f"{name} is pressed into {into}"


def surfaces_of(case, scene, diameter, weights, strength, excluded) -> Surfaces:
    """Return the bodies of a scene as contact has them.

    weights (N,) : A ds of each point of a rod. strength : A of bodies. excluded (R,) : segments
    within which a rod does not feel the body that holds it.
    """
    balls = [balls_of(b.shape, b.surface, scene.blob, diameter) for b in scene.bodies]
    runs = [_runs(case, scene, body.name, excluded) for body in scene.bodies]
    records, blocks = np.zeros((len(scene.bodies), BODY)), []
    end = HEAD + records.size + weights.size
    for record, body, mine, met in zip(records, scene.bodies, balls, runs, strict=True):
        bound = (np.linalg.norm(mine[:, :3], axis=1) + mine[:, 3]).max()
        counts = end, len(met), end + met.size, len(mine)
        record[:] = body.node, *surface_numbers(body.shape), bound, *counts
        mine = mine * [1.0, 1.0, 1.0, 1.0, strength]
        blocks += [met.ravel(), mine.ravel()]
        end += met.size + mine.size
    wall = -np.inf if scene.wall is None else scene.wall
    head = diameter, wall, len(scene.bodies)
    fixed = np.concatenate([head, records.ravel(), weights, *blocks]).astype(float)
    return Surfaces(scene, fixed, balls, runs)


def _runs(case, scene, body, excluded):
    """Return the runs (first, end, rod) of points that a body meets."""
    found = []
    for r, rod in enumerate(scene.rods):
        first, end = rod.first, rod.first + rod.count
        for name, which, held in held_ends(case):
            if name == rod.name and held.to == body:
                first += int(excluded[r] + 1) * (which == "start")
                end -= int(excluded[r] + 1) * (which == "end")
        if first < end:
            found.append((first, end, r))
    return np.array(found, dtype=np.int64).reshape(-1, RUN)


def leaky(case, scene):
    """Yield a warning of bodies from files, whose surfaces keep nothing out."""
    for body in scene.bodies:
        if surface_numbers(body.shape)[0] == POINTS:
            reason = "its points are kept off the wall and off other bodies, but the surface of a "
            reason += "body from a file keeps out neither rods nor other bodies from files"
            yield case.source.problem(("bodies", body.name, "shape"), reason)

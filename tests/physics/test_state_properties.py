"""Frame indifference, the order of points and the order of rods, for any state of any rods.

Loads, velocities and one step of RK4 (four evaluations, with their commutators) are compared, and
the tracers with them. What is allowed is rounding: a position is known to 2^-52 |X|, so strains,
and what comes of them, to the part 2^-52 (1 + |X|/ds). ``ROUNDINGS`` of these may add up, or be all
that is left where forces cancel: 19 are the most that was seen in 2000 states of each test.
"""

from dataclasses import replace

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from rodsim.compiled.rotations import rotate
from rodsim.flows.fluid import fluid_parts
from rodsim.forces.elastic import elastic_part
from rodsim.integrators.rk4 import RK4
from rodsim.nodes import lay_out
from rodsim.scene.build import with_parts
from rodsim.scene.shapes import rotation_matrix
from rodsim.scene.state import Scene, State
from rodsim.scene.system import RodSystem

ROUNDINGS = 100
LOADS_AND_VELOCITIES = ("force", "torque", "velocity", "angular_velocity")
TURNED_ROUND = np.array([1.0, -1.0, -1.0])  # D^2 and D^3 when s -> L - s; D^1 stays


class Values:
    """Strain twist of every segment of a rod, as an expression in s and t gives it."""

    uses_t = True

    def __init__(self, values, sigma):
        self.values, self.sigma = values, sigma

    def __call__(self, s, t):
        return self.values * np.cos(self.sigma * t)


@st.composite
def scenes(draw):
    """One to three bent, sheared, stretched rods, open or closed, and some markers."""
    kinds = draw(st.lists(st.tuples(st.integers(3, 6), st.booleans()), min_size=1, max_size=3))
    random = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    size = np.repeat([3e-3, 0.7], 3)
    rods = lay_out(
        (name, *kind, random.uniform(0.05, 0.3), size * random.uniform(0.3, 3.0, 6))
        for name, kind in zip("abc", kinds, strict=False)
    )
    count = rods.count
    ds = np.repeat(rods.spacing, count)
    walk = random.normal(size=(3, rods.points)) * ds
    position = np.concatenate(
        [walk[:, a : a + n].cumsum(axis=1) for a, n in zip(rods.first, count, strict=True)], axis=1
    )
    theta = random.uniform(-0.5, 0.5, position.shape)  # neighbours stay far from a half-turn
    start = rotation_matrix(random.normal(size=3), 2.3).T
    director = np.repeat(start[:, :, None], rods.points, axis=2)
    rotate(theta, director.copy(), director)
    segments = [random.normal(size=(3, n)) for n in rods.segments]
    scene = Scene(
        rods=rods,
        epsilon=float(draw(st.floats(1.0, 5.0)) * rods.spacing.min()),
        viscosity=1.3e-6,
        blob="algebraic7",
        planar=False,
        density=None,
        tracer_groups={"markers": 3},
        initial=at_start(position, director, random.normal(size=(3, 3))),
    )
    return acting(scene, segments), segments


def at_start(*arrays):
    return State(0.0, *map(np.ascontiguousarray, arrays))


def acting(scene, segments):
    """The scene with that strain twist, and its fluid."""
    entries = tuple(tuple(Values(row, 31.0) for row in rows) for rows in segments)
    scene = replace(scene, entries=entries)
    return with_parts(scene, [elastic_part(scene), *fluid_parts(scene)])


def fields_of(scene):
    fields, _ = RodSystem(scene).observe(scene.initial)
    return {name: fields[name].copy() for name in LOADS_AND_VELOCITIES}


def after_a_step(scene, size):
    return next(RK4(RodSystem(scene), size).steps(scene.initial, size)).end


def compare(scene, image, back):
    """Assert that ``back`` takes what the image of a scene does to what the scene does.

    back : called with a field's name and its array, returns that of the scene itself.
    """
    fields, seen, ds = fields_of(scene), fields_of(image), scene.rods.spacing.min()
    states = scene.initial, image.initial
    far = max(abs(X).max() for state in states for X in (state.position, state.tracer))
    allowed = ROUNDINGS * 2.0**-52 * (1.0 + far / ds)
    for name, field in fields.items():
        assert abs(back(name, seen[name]) - field).max() <= allowed * abs(field).max(), name
    # in the step the fastest point goes a twentieth of ds, or turns by a twentieth of a radian
    size = 0.05 / max(abs(fields["velocity"]).max() / ds, abs(fields["angular_velocity"]).max())
    end, seen_end = after_a_step(scene, size), after_a_step(image, size)
    for name, largest in (("position", ds), ("director", 1.0), ("tracer", ds)):
        found = back(name, getattr(seen_end, name))
        assert abs(found - getattr(end, name)).max() <= allowed * largest, name
    moved = abs(end.position - scene.initial.position).max() / ds
    turned = abs(end.director - scene.initial.director).max()
    assert max(moved, turned) > 0.01


few = settings(max_examples=60, deadline=None, derandomize=True)
components = st.floats(-1.0, 1.0)
axes = st.tuples(components, components, components).filter(lambda e: np.linalg.norm(e) > 0.1)
shifts = st.tuples(*3 * [st.floats(-100.0, 100.0)])


@few
@given(scenes(), axes, st.floats(-180.0, 180.0), shifts)
def test_a_scene_turned_and_moved_does_the_same_turned_and_moved(made, axis, degrees, shift):
    scene, _ = made
    turn, shift = rotation_matrix(axis, np.radians(degrees)), np.array(shift)[:, None]
    state = scene.initial
    image = replace(
        scene,
        initial=at_start(
            turn @ state.position + shift,
            np.einsum("ab,ibk->iak", turn, state.director),
            turn @ state.tracer + shift,
        ),
    )

    def back(name, array):
        if name in ("position", "tracer"):
            array = array - shift
        return np.swapaxes(np.swapaxes(array, -2, -1) @ turn, -2, -1)

    compare(scene, image, back)


@few
@given(scenes())
def test_points_in_the_other_order_do_the_same(made):
    """s -> L - s: D^2 and D^3 turn round, so Omega_1 = dD^2/ds . D^3 changes sign, and only it.

    F and N change sign, but so does the order of their differences: the loads stay.
    """
    scene, segments = made
    rods, state = scene.rods, scene.initial
    order = np.concatenate(
        [np.arange(a + n - 1, a - 1, -1) for a, n in zip(rods.first, rods.count, strict=True)]
    )
    turned = []
    for rows, closed in zip(segments, rods.closed, strict=True):
        rows = rows[:, ::-1] * [[-1.0], [1.0], [1.0]]
        turned.append(np.roll(rows, -1, axis=1) if closed else rows)  # the last joins both ends
    director = state.director[:, :, order] * TURNED_ROUND[:, None, None]
    image = replace(scene, initial=at_start(state.position[:, order], director, state.tracer))
    image = acting(image, turned)

    def back(name, array):
        if name == "tracer":
            return array
        array = array[..., order]
        return array * TURNED_ROUND[:, None, None] if name == "director" else array

    compare(scene, image, back)


@few
@given(scenes(), st.randoms(use_true_random=False))
def test_rods_in_another_order_do_the_same(made, random):
    scene, segments = made
    rods, state = scene.rods, scene.initial
    turn = random.sample(range(len(rods.names)), len(rods.names))
    order = np.concatenate([np.arange(rods.count[r]) + rods.first[r] for r in turn])
    swapped = lay_out(
        (rods[r].name, rods[r].count, rods[r].closed, rods[r].spacing, rods[r].moduli) for r in turn
    )
    image = replace(
        scene,
        rods=swapped,
        initial=at_start(state.position[:, order], state.director[:, :, order], state.tracer),
    )
    image = acting(image, [segments[r] for r in turn])
    place = np.argsort(order)
    compare(scene, image, lambda name, a: a if name == "tracer" else a[..., place])

"""The gap of a scene against all pairs one by one; who counts; points that lie on each other."""

import numpy as np
import pytest
from scenes import CONFIGS
from twins import gap

from rodsim.case import load_case
from rodsim.errors import CaseError
from rodsim.forces import near
from rodsim.scene import neighbours
from rodsim.scene.build import build_scene
from rodsim.scene.gap import closest_pair


def curves(kind, seed):
    """Return positions (3, N), counts and closedness of rods that are near to each other."""
    rng = np.random.default_rng(seed)
    if kind == "coil":
        s = np.linspace(0.0, 9.0 * np.pi, 173)
        return np.array([np.cos(s), 1.3 * np.sin(s), 0.04 * s]), [173], [False]
    if kind == "ring":
        s = 2.0 * np.pi * np.arange(89) / 89
        return np.array([np.cos(s), 0.07 * np.sin(s), 0.3 * np.cos(2 * s)]), [89], [True]
    counts = rng.integers(2, 60, size=7 if kind == "rods" else 1)
    steps = rng.normal(size=(3, counts.sum()))
    closed = rng.random(len(counts)) < 0.5
    return np.cumsum(steps, axis=1), list(counts), list(closed)


@pytest.mark.parametrize("kind", ["coil", "ring", "walk", "rods"])
def test_the_closest_pair_is_that_of_all_pairs(kind):
    for seed in range(20):
        X, counts, closed = curves(kind, seed)
        excluded = np.random.default_rng(seed + 99).integers(0, 12, size=len(counts))
        first = np.concatenate([[0], np.cumsum(counts)[:-1]])
        tables = first, np.array(counts), np.array(closed), excluded
        distance, i, j = closest_pair(X, *tables)
        assert distance == gap(X.T, counts, closed, excluded)  # the same sums: the same bits
        if i >= 0:
            assert i < j
            assert distance == pytest.approx(np.linalg.norm(X[:, i] - X[:, j]), rel=1e-15)


def test_no_pair_no_gap():
    X = np.random.default_rng(3).normal(size=(3, 9))
    alone = np.array([0]), np.array([9]), np.array([True]), np.array([4])
    assert closest_pair(X, *alone) == (np.inf, -1, -1)


TWO = """\
fluid: {{viscosity: 1.3e-6, epsilon: {epsilon}, blob: {blob}}}
rods:
  a:
    shape: {a}
    moduli: {{bending: 3e-3, twisting: 4e-3, shear: 0.7, stretch: 0.9}}
  b:
    shape: {b}
    moduli: {{bending: 3e-3, twisting: 4e-3, shear: 0.7, stretch: 0.9}}
time: {{end: 0.2}}
"""
LINE = "{kind: straight, points: 21, length: 8}"


def scene(tmp_path, a=LINE, b="{kind: ring, radius: 1.7, points: 31, origin: [0.3, 0, 4.2]}",
          epsilon=0.5, blob="algebraic7"):  # fmt: skip
    path = tmp_path / "case.yaml"
    path.write_text(TWO.format(a=a, b=b, epsilon=epsilon, blob=blob))
    return build_scene(load_case(path))


def test_neighbours_are_nearer_than_half_the_girth_along_the_rod(tmp_path):
    # pi/2 1.21306 0.5 = 0.9527 along a: 2.4 spacings of 0.4; along b: 2.8 of 0.3446.
    assert list(neighbours.excluded(scene(tmp_path))) == [2, 2]
    # pi/2 0.73576 2.1 = 2.427: 6.07 and 7.04 spacings.
    thick = scene(tmp_path, epsilon=2.1, blob="algebraic9")
    assert list(neighbours.excluded(thick)) == [6, 7]
    assert list(neighbours.excluded(scene(tmp_path, epsilon=1e30))) == [21, 31]


def test_one_short_rod_has_no_gap():
    ring = load_case(CONFIGS / "closed_ring.yaml")
    assert neighbours.any_pair_counts(build_scene(ring))
    short = load_case(CONFIGS / "closed_ring.yaml", ["rods.ring.shape.points=15"])
    assert not neighbours.any_pair_counts(build_scene(short))  # half of it is 7.6 spacings


# Point 7 of the line is at z = 2.8, and the far points are all over the place.
@pytest.mark.parametrize("angle", [0, 33, 90])
def test_points_of_two_rods_in_one_place_are_refused(tmp_path, angle):
    turned = f"rotate: {{axis: [1, 0.2, 0.3], degrees: {angle}}}, origin: [0, 1.0e-8, 2.8]"
    with pytest.raises(CaseError) as caught:
        scene(tmp_path, b=f"{{kind: straight, points: 4, length: 3.3, {turned}}}")
    assert "rods.a.shape" in str(caught.value)
    assert "point 7 lies on point 0 of rod 'b'" in str(caught.value)


def test_near_is_not_in_one_place(tmp_path):
    across = np.cross(near.DIRECTION, [0.0, 0.0, 1.0])  # the same place in the sorted order
    for x, y, _ in (1e-5 * across, 0.5 * across):
        found = scene(tmp_path, b=LINE.replace("}", f", origin: [{x:.17f}, {y:.17f}, 0]}}"))
        assert neighbours.coincident(found) is None


def test_a_rod_that_begins_where_another_ends_is_refused(tmp_path):
    with pytest.raises(CaseError, match="point 20 lies on point 0 of rod 'b'"):
        scene(tmp_path, b=LINE.replace("}", ", origin: [0, 0, 8.0]}"))


def test_a_rod_through_itself_is_refused(tmp_path):
    s = 2.0 * np.pi * np.arange(62) / 31  # twice round: point k and point k + 31
    table = np.zeros((62, 12))
    table[:, 0], table[:, 1] = 1.7 * np.cos(s), 1.7 * np.sin(s)
    table[:, 5] = 1.0
    table[:, 6], table[:, 7] = np.cos(s), np.sin(s)
    table[:, 9], table[:, 10] = -np.sin(s), np.cos(s)
    np.savetxt(tmp_path / "ring.txt", table, fmt="%.17g")
    shape = "{kind: file, path: ring.txt, spacing: 0.3446, closed: true, origin: [9, 9, 0]}"
    with pytest.raises(CaseError, match="point 0 lies on point 31: rods cannot start"):
        scene(tmp_path, b=shape)

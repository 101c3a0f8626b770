"""Text tables are held against their own geometry; every slip has its words and its fate."""

import numpy as np
import pytest

from rodsim.case import load_case
from rodsim.errors import CaseError
from rodsim.scene.build import build_scene

COUNT, RADIUS = 90, 2.3
STEP = 2 * np.pi * RADIUS / COUNT
CASE = """
fluid: {{viscosity: 1.3e-6, epsilon: {epsilon}}}
rods:
  ring:
    shape: {{kind: file, path: t.txt, spacing: {spacing}, closed: {closed}{more}}}
    moduli: {{bending: 3e-3, twisting: 2e-3, shear: 0.7, stretch: 0.9}}
    strain_twist: {strain}
time: {{end: 0.5}}
"""


def ring():
    """A circle whose triads turn three times about it."""
    a = 2 * np.pi * np.arange(COUNT) / COUNT
    zero = 0 * a
    radial, tangent = np.c_[np.cos(a), np.sin(a), zero], np.c_[-np.sin(a), np.cos(a), zero]
    axial = np.c_[zero, zero, zero + 1]
    cos, sin = np.cos(3 * a)[:, None], np.sin(3 * a)[:, None]
    triads = np.stack([cos * axial + sin * radial, cos * radial - sin * axial, tangent], axis=1)
    return RADIUS * radial, triads


@pytest.fixture
def build(tmp_path):
    def make(X, D, spacing=STEP, closed=True, more="", epsilon=0.5, strain="[0, 0, 0]", blank=None):
        rows = [" ".join(map(repr, map(float, row))) for row in np.c_[X, D.reshape(len(X), 9)]]
        if blank:
            rows.insert(blank, "")
        (tmp_path / "t.txt").write_text("\n".join(rows) + "\n")
        text = CASE.format(
            spacing=spacing, closed=str(closed).lower(), more=more, epsilon=epsilon, strain=strain
        )
        (tmp_path / "case.yaml").write_text(text)
        return build_scene(load_case(tmp_path / "case.yaml"))

    return make


def arc(count=40):
    """A quarter of a circle, open."""
    a = 0.5 * np.pi * np.arange(count) / (count - 1)
    zero = 0 * a
    radial, tangent = np.c_[np.cos(a), np.sin(a), zero], np.c_[-np.sin(a), np.cos(a), zero]
    axial = np.c_[zero, zero, zero + 1]
    return RADIUS * radial, np.stack([axial, radial, tangent], axis=1), RADIUS * a[1]


def test_a_sound_table_has_no_warning(build):
    assert build(*ring()).warnings == ()
    X, D, step = arc()
    assert build(X, D, step, closed=False).warnings == ()


def shuffled(k):
    return lambda X, D: (X, np.roll(D, k, axis=1))


def uneven(X, D):
    """Points at 1.5 turns of a quadratic map of the angle, the triads along."""
    a = 2 * np.pi * (np.arange(COUNT) / COUNT + 0.12 * np.sin(2 * np.pi * np.arange(COUNT) / COUNT))
    zero = 0 * a
    radial, tangent = np.c_[np.cos(a), np.sin(a), zero], np.c_[-np.sin(a), np.cos(a), zero]
    axial = np.c_[zero, zero, zero + 1]
    return RADIUS * radial, np.stack([axial, radial, tangent], axis=1)


SLIPS = {
    "closing point repeated": (lambda X, D: (np.r_[X, X[:1]], np.r_[D, D[:1]]),
                               "is the first one again"),
    "a point twice": (lambda X, D: (np.insert(X, 20, X[20], 0), np.insert(D, 20, D[20], 0)),
                      r"point 20 \(line 21\) and point 21 \(line 22\) are the same"),
    "transposed": (lambda X, D: (X, D.transpose(0, 2, 1)), "transposed"),
    "D3 D1 D2": (shuffled(1), "D1 lies along the chords"),
    "D2 D3 D1": (shuffled(2), "D2 lies along the chords"),
    "D3 against": (lambda X, D: (X, D * np.array([1, -1, -1])[:, None]), "against the order"),
    "rows reversed": (lambda X, D: (X[::-1], D[::-1]), "rows reversed"),
    "1000 times": (lambda X, D: (1000 * X, D), "999.8 in the mean.*another unit"),
    "a row missing": (lambda X, D: (np.delete(X, 33, 0), np.delete(D, 33, 0)),
                      r"a jump from point 32 \(line 33\) to point 33 \(line 34\), 1.999 times"),
    "uneven": (uneven, "uneven points: kind: curve"),
    "two rows": (lambda X, D: (X[:2], D[:2]), "has 2 points: a closed rod has at least 3"),
}  # fmt: skip


@pytest.mark.parametrize("slip", SLIPS)
def test_slips_are_refused_with_their_name(build, slip):
    change, words = SLIPS[slip]
    X, D = change(*ring())
    with pytest.raises(CaseError, match=words) as error:
        build(X, D)
    assert "case.yaml:5: rods.ring.shape.path" in str(error.value)


@pytest.mark.parametrize("slip", sorted({*SLIPS} - {"two rows"}))
def test_as_is_takes_them(build, slip):
    X, D = SLIPS[slip][0](*ring())
    scene = build(X, D, more=", as_is: true")
    assert np.array_equal(scene.initial.position.T, X)


@pytest.mark.parametrize("factor", [2.0, 10.0, 0.1, 0.5])
def test_a_wrong_spacing_is_refused(build, factor):
    with pytest.raises(
        CaseError, match=f"is spacing wrong.* the distance in the table is {STEP:.2f}"
    ):
        build(*ring(), spacing=STEP * factor)


def test_two_blocks_are_not_one_rod(build):
    X, D = ring()
    both = np.r_[X, X + np.array([0, 0, 0.1])], np.r_[D, D]
    with pytest.raises(CaseError, match=r"has 2 blocks, the second from point 90 \(line 92\) on"):
        build(*both, blank=COUNT)
    assert build(*both, blank=COUNT, more=", as_is: true").rods.points == 2 * COUNT


def test_closed_on_an_open_curve_and_forgotten(build):
    X, D, step = arc()
    with pytest.raises(CaseError, match=r"the last is 35\.11 of the others.*is the curve closed"):
        build(X, D, step, closed=True)
    (warning,) = build(*ring(), closed=False).warnings
    assert "its ends are 1 spacings apart" in str(warning)
    X, D = SLIPS["closing point repeated"][0](*ring())
    with pytest.raises(CaseError, match="take the last row out and add closed: true"):
        build(X, D, closed=False)


@pytest.mark.parametrize(
    ("stretch", "warned", "refused"),
    [(1.008, False, False), (1.012, True, False), (1.19, True, False), (1.21, True, True),
     (0.988, True, False), (0.79, True, True)],
)  # fmt: skip
def test_from_one_percent_on_it_warns_and_from_twenty_it_refuses(build, stretch, warned, refused):
    X, D, step = arc(100)  # its chords are short by 1e-5
    if refused:
        with pytest.raises(CaseError, match="spacings apart"):
            build(stretch * X, D, step, closed=False)
        return
    warnings = build(stretch * X, D, step, closed=False).warnings
    assert len(warnings) == warned


@pytest.mark.parametrize(
    ("degrees", "warned", "refused"),
    [(0.9, False, False), (1.2, True, False), (11.2, True, False), (11.8, True, True)],
)
def test_a_tilt_warns_from_one_degree_and_is_refused_at_a_shear_of_twenty_percent(
    build, degrees, warned, refused
):
    X = np.c_[np.zeros((9, 2)), 0.25 * np.arange(9)]
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    D = np.repeat(np.array([[[1, 0, 0], [0, c, -s], [0, s, c]]]), 9, axis=0)
    if refused:
        with pytest.raises(CaseError, match=r"11\.8 degrees from the chords"):
            build(X, D, 0.25, closed=False)
        return
    assert len(build(X, D, 0.25, closed=False).warnings) == warned


def test_triads_of_segments_are_noticed(build):
    X, _, _ = arc(20)
    chord = np.diff(X, axis=0, append=2 * X[-1:] - X[-2:-1])
    third = chord / np.linalg.norm(chord, axis=1)[:, None]
    first = np.repeat([[0.0, 0.0, 1.0]], 20, axis=0)
    D = np.stack([first, np.cross(third, first), third], axis=1)
    step = np.linalg.norm(chord[0])
    (warning,) = build(X, D, step, closed=False).warnings
    assert "triads belong to points, not to segments" in str(warning)


def test_a_thin_rod_and_a_coarse_twist_are_warned_of(build):
    """A ring of the case file has these warnings; a table's spacing is known only when read."""
    scene = build(*ring(), epsilon=0.9 * STEP, strain=f"[0, 0, {1.3 / STEP}]")
    thin, coarse = sorted(map(str, scene.warnings))
    assert "is 0.9 spacings of rod 'ring': fluid flows between its points" in thin
    assert "abs(Omega) ds = 1.3 at" in coarse


@pytest.mark.parametrize(("far", "fate"), [(5e6, ""), (3e8, "warned"), (1e14, "refused")])
def test_positions_beyond_rounding(build, far, fate):
    """The rounding of a float64 near ``far`` is 2^-52 far to within a factor 2."""
    X, D = ring()
    more = f", origin: [0, {far}, 0]"
    if fate == "refused":
        with pytest.raises(
            CaseError, match=r"rods\.ring\.shape\.origin.*move everything nearer to 0"
        ):
            build(X, D, more=more)
        return
    lost = ["small strains are lost" in str(w) for w in build(X, D, more=more).warnings]
    assert lost == [True] * (fate == "warned")

"""Moduli along s: words, checks, and the array of the segments."""

import numpy as np
import pytest

from rodsim.case import load_case
from rodsim.errors import CaseError
from rodsim.scene.build import build_scene
from rodsim.scene.moduli import typical
from rodsim.scene.rods import build_rods

CASE = """
parameters: {{a: 3.0e-3, taper: 0.9, L: 2.5}}
fluid: {{viscosity: 1.3e-6, epsilon: 0.3}}
rods:
  tail:
    shape: {{kind: straight, points: 6, length: 2.5}}
    moduli: {moduli}
  loop:
    shape: {{kind: ring, radius: 0.7, points: 4}}
    moduli: {{bending: 3e-3, twisting: 2e-3, shear: 0.7, stretch: 0.9}}
time: {{end: 0.5}}
"""


@pytest.fixture
def load(tmp_path):
    def make(moduli):
        (tmp_path / "case.yaml").write_text(CASE.format(moduli=moduli))
        return load_case(tmp_path / "case.yaml")

    return make


def test_moduli_are_taken_at_the_middle_of_each_segment(load):
    case = load('{bending: [a*(1 - taper*s/L)**4, 5e-3], twisting: "where(s < 1, a, 2*a)",'
                " shear: 0.7, stretch: exp(-s)}")  # fmt: skip
    tail, loop = build_rods(case).moduli
    s = np.array([0.25, 0.75, 1.25, 1.75, 2.25])
    assert tail[0] == pytest.approx(3e-3 * (1 - 0.9 * s / 2.5) ** 4, rel=1e-14)
    assert tail[1].tolist() == [5e-3] * 5
    assert tail[2].tolist() == [3e-3, 3e-3, 6e-3, 6e-3, 6e-3]
    assert tail[5] == pytest.approx(np.exp(-s), rel=1e-14)
    assert typical(tail)[[1, 3]].tolist() == [5e-3, 0.7]
    whole = build_scene(case).along
    assert whole.shape == (9, 10)
    assert np.array_equal(whole[:6, :5], tail)
    assert np.array_equal(whole[:6, 6:], loop)
    assert not whole[:, 5].any()
    assert not whole[6:].any()
    assert case.resolved()["rods"]["tail"]["moduli"]["stretch"] == "exp(-s)"


@pytest.mark.parametrize(
    ("moduli", "words"),
    [
        ("{bending: 1 - s, twisting: 1e-3, shear: 0.7, stretch: 0.9}",
         r"rods\.tail\.moduli\.bending = 1 - s \(g um\^3 s\^-2\): is -0\.25 at s = 1\.25: must be"),
        ("{bending: 1e-3, twisting: log(s - 1), shear: 0.7, stretch: 0.9}", r"twisting.*is nan at"),
        ("{bending: 1e-3, twisting: sin(t), shear: 0.7, stretch: 0.9}", "unknown name 't'"),
        ("{bending: 1e-3, twisting: [1, 2], shear: 0.7, stretch: 0.9}", "twisting"),
        ("{bending: 1e-3, twisting: -1, shear: 0.7, stretch: 0.9}", "must be > 0"),
    ],
)  # fmt: skip
def test_they_stay_positive_and_depend_on_s_alone(load, moduli, words):
    with pytest.raises(CaseError, match=words):
        build_rods(load(moduli))


def test_a_scene_of_constants_has_none(load):
    assert (
        build_scene(load("{bending: 1e-3, twisting: 1e-3, shear: 0.7, stretch: 0.9}")).along is None
    )

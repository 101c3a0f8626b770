"""Units at the skin: names, products, kT, and the scales that docs/numbers.md prints."""

import math
import re

import pytest
from scenes import ROOT

from rodsim.case import case_from_mapping, load_case
from rodsim.case.materials import round_rod
from rodsim.errors import CaseError, UsageError
from rodsim.units import in_si, thermal_energy, unit_text

PN = {"length": "um", "force": "pN", "time": "s"}
G = {"length": "um", "mass": "g", "time": "s"}
ENERGY, BENDING, VISCOSITY = (1, 2, -2), (1, 3, -2), (1, -1, -1)


@pytest.mark.parametrize(
    ("dimension", "force", "mass"),
    [
        (ENERGY, "pN um", "g um^2 s^-2"),
        (BENDING, "pN um^2", "g um^3 s^-2"),
        (VISCOSITY, "pN um^-2 s", "g um^-1 s^-1"),
        ((1, 1, -2), "pN", "g um s^-2"),
        ((0, 0, 0), "1", "1"),
    ],
)
def test_force_stands_in_the_place_of_mass(dimension, force, mass):
    assert (unit_text(dimension, PN), unit_text(dimension, G)) == (force, mass)
    # 1 pN is 1e-3 g um s^-2
    ratio = in_si(dimension, PN) / in_si(dimension, G)
    assert ratio == pytest.approx(1e-3 ** dimension[0], rel=1e-14)


def test_thermal_energy():
    """4.114e-21 J at 298 K, in units as people have them."""
    joule = 1.380649e-23 * 298
    cases = [
        ("nm", "ag", "us", 1e-21 * 1e-18 / 1e-12),
        ("Å", "Da", "ps", 1.6605e-27 * 1e-20 / 1e-24),
        ("A", "fg", "ns", 1e-18 * 1e-20 / 1e-18),
        ("um", "pg", "ms", 1e-15 * 1e-12 / 1e-6),
    ]
    for length, mass, time, size in cases:
        units = {"length": length, "mass": mass, "time": time}
        assert thermal_energy(298, units) == pytest.approx(joule / size, rel=1e-4)
    assert thermal_energy(298, PN) == pytest.approx(joule / 1e-18, rel=1e-12)
    with pytest.raises(UsageError, match="do not know the unit 'furlong'"):
        thermal_energy(298, {**G, "length": "furlong"})


def test_the_scales_of_the_docs():
    """The rows of the table against SI: bacterium, sperm, DNA, fibre."""
    table = re.findall(r"^\| (.*) \|$", (ROOT / "docs/numbers.md").read_text(), re.M)
    cells = {row.split(" | ")[0]: row.split(" | ")[1:] for row in table}
    units = [dict(re.findall(r"(\w+): (\w+)", cell)) for cell in cells["`units`"]]

    def numbers(row):
        return [float(cell.split()[0]) for cell in cells[row]]

    viscosity = [n * in_si(VISCOSITY, u) for n, u in zip(numbers("viscosity"), units, strict=True)]
    assert viscosity == pytest.approx([1e-3, 1e-3, 1e-3, 1.0])
    for name, kt in zip(units, numbers("kT at 298 K"), strict=True):
        assert thermal_energy(298, name) == pytest.approx(kt, rel=2e-3)
    bending = numbers("bending modulus")
    assert bending[2] * in_si(BENDING, units[2]) == pytest.approx(50e-9 * 1.38e-23 * 298, rel=5e-3)
    fibre = 1e6 * math.pi * 1e-4**4 / 4
    assert bending[3] * in_si(BENDING, units[3]) == pytest.approx(fibre, rel=1e-3)


DATA = {
    "units": {"length": "um", "force": "pN", "time": "s"},
    "parameters": {"a": 0.1, "E": "2e6/4"},
    "fluid": {"viscosity": 1e-3, "epsilon": {"radius": "2*a"}},
    "rods": {"r": {"shape": {"kind": "straight", "points": 50, "length": 7},
                   "moduli": {"young": "E", "radius": "a", "poisson": 0.3}}},
    "time": {"end": 0.2},
}  # fmt: skip


def test_moduli_from_youngs_modulus():
    case = case_from_mapping(DATA)
    a1, a2, a3, b1, b2, b3 = case.rods["r"].moduli.values
    assert a1 == a2 == pytest.approx(5e5 * math.pi * 1e-4 / 4)
    assert a3 == pytest.approx(a1 / 1.3)  # G J / E I = 1/(1 + nu)
    assert b3 == pytest.approx(4 * a1 / 0.01)  # E A / E I = 4/r^2
    assert b1 == b2 == pytest.approx(b3 / 2.6 * 7.8 / 8.8)
    assert case.resolved()["rods"]["r"]["moduli"].keys() == round_rod(1, 1, 0).keys()
    assert case_from_mapping(case.resolved()).rods == case.rods
    softer = case_from_mapping(DATA, ["rods.r.moduli.stretch=3"]).rods["r"].moduli
    assert softer.values == (a1, a2, a3, b1, b2, 3.0)
    assert case.resolved()["units"] == DATA["units"]


def test_epsilon_from_the_radius():
    for blob, factor in (("algebraic7", math.sqrt(math.e)), ("algebraic9", math.e)):
        fluid = case_from_mapping(DATA, [f"fluid.blob={blob}"]).fluid
        assert fluid.epsilon == pytest.approx(0.2 * factor, rel=1e-15)


@pytest.mark.parametrize(
    ("override", "key", "words"),
    [
        ("rods.r.moduli.radius=null", "rods.r.moduli", "belong together"),
        ("rods.r.moduli.young=-E", "rods.r.moduli.young", "must be > 0"),
        ("rods.r.moduli.young=e", "rods.r.moduli.young", "no parameter 'e'"),
        ("rods.r.moduli.poisson=0.6", "rods.r.moduli.poisson", "must be <= 0.5"),
        ("fluid.epsilon.radius=0", "fluid.epsilon.radius", "must be > 0"),
        ("fluid.epsilon={radius: 1, spacings: 2}", "fluid.epsilon.spacings", "unknown key"),
        ("units.mass=g", "units", "give mass or force, not both"),
        ("rods.r.moduli={young: 1, radius: 2, bending: 1, twisting: 1, shear: 1, stretch: 1}",
         "rods.r.moduli", "young has no effect"),
    ],
)  # fmt: skip
def test_refused(override, key, words):
    with pytest.raises(CaseError) as caught:
        case_from_mapping(DATA, [override])
    (problem,) = caught.value.problems
    assert problem.key == key
    assert words in problem.reason
    assert "(pN um^-2)" in str(problem) or not words.startswith("must be > 0") or "young" not in key


def test_an_angstrom_may_be_written_as_one(tmp_path):
    (tmp_path / "c.yaml").write_text("units: {length: Å}\nfluid: {viscosity: -1, epsilon: 1}\n")
    with pytest.raises(CaseError, match=r"must be > 0 \(g Å\^-1 s\^-1\)"):
        load_case(tmp_path / "c.yaml")

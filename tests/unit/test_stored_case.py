"""What info tells of the case in an output, read from its text alone."""

import json

import pytest
from outputs import CASE, create, write

from rodsim import open_trajectory
from rodsim.case import case_from_mapping
from rodsim.commands import stored_case
from rodsim.commands.stored_case import describe_stored, diameter_of, is_driven
from rodsim.output import CaseText

ROD = {
    "shape": {"kind": "straight", "points": 4, "spacing": 0.25},
    "moduli": {"bending": [3.5e-3, 3.6e-3], "twisting": 2.5e-3, "shear": 0.7, "stretch": "0.9 + s"},
}
FAR = {**ROD, "shape": {**ROD["shape"], "origin": [0, 9, 0]}}
DATA = {
    "title": "t",
    "units": {"length": "um", "mass": "g", "time": "s"},
    "fluid": {"viscosity": 1.3e-6, "epsilon": {"spacings": 3.0}, "blob": "algebraic9"},
    "rods": {
        "zeta": ROD,
        "alpha": ROD,
        "t": FAR,
    },
    "tracers": {"marks": {"kind": "tube", "rod": "t", "radius": 0.6, "around": 3, "along": 5}},
    "time": {"end": 0.7, "integrator": "rk4", "step": 1e-3},
}


@pytest.fixture
def stored(tmp_path):
    """Return a function that makes an output of the case with changed sections, and opens it."""

    def make(text=None, **changes):
        resolved = text or json.dumps(case_from_mapping(DATA | changes).resolved())
        with create(tmp_path / "out.h5", True, case=CaseText("", resolved, [])) as writer:
            write(writer, range(2))
            writer.finish("finished", {})
        return open_trajectory(tmp_path / "out.h5")

    return make


def test_a_drive_is_an_expression_of_time_and_no_name_that_looks_like_one(stored):
    with stored() as run:
        assert not is_driven(run, run.case_data())
    driven = {**ROD, "strain_twist": ["0.3*sin(40*t)", 0, 0]}
    with stored(rods={"zeta": driven, "alpha": FAR}, tracers={}) as run:
        assert is_driven(run, run.case_data())


def test_how_thick_rods_are_is_what_contact_has_or_the_fluid(stored):
    """algebraic9: 2 exp(-1) epsilon, epsilon = 3 spacings of 0.25."""
    with stored() as run:
        assert diameter_of(run, run.case_data()) == pytest.approx(0.5518191618, rel=1e-9)
    with stored(contact={"diameter": 0.83}) as run:
        assert diameter_of(run, run.case_data()) == 0.83


def test_the_lines_of_a_whole_case(stored):
    with stored() as run:
        lines = describe_stored(run)
    assert lines[0] == "t"
    assert lines[1].endswith("(1.3 mPa s), algebraic9, epsilon 0.75 um = 3 spacings")
    assert lines[2] == (
        "rod zeta: 4 points, open, spacing 0.25 um; bending 0.0035 and 0.0036, twisting 0.0025 "
        "g um^3 s^-2; shear 0.7, stretch 0.9 + s g um s^-2"
    )
    assert lines[-1] == "time: to 0.7 s by rk4, step 0.001"


def test_moduli_are_those_of_each_rod_and_told_once_where_both_are_the_same(stored):
    soft = {"bending": [2.5e-3, 2.5e-3], "twisting": 2.5e-3, "shear": 0.6, "stretch": 0.8}
    with stored(title="", rods=DATA["rods"] | {"alpha": {**FAR, "moduli": soft}}) as run:
        first, zeta, alpha, time = describe_stored(run)
    assert first.startswith("fluid: viscosity")  # no line for a title that is not there
    assert "; bending 0.0035 and 0.0036, twisting" in zeta
    assert "; bending 0.0025, twisting 0.0025 g um^3 s^-2; shear 0.6, stretch 0.8 g um" in alpha
    assert time.startswith("time: to 0.7 s")


def test_of_many_rods_the_first_are_described(stored, monkeypatch):
    monkeypatch.setattr(stored_case, "MOST_RODS", 1)
    with stored() as run:
        lines = describe_stored(run)
    assert [line.partition(":")[0] for line in lines[2:]] == ["rod zeta", "and 1 more rods", "time"]


@pytest.mark.parametrize("text", [CASE.resolved, "[3]", '{"fluid": {"viscosity": "x"}, "time": 3}'])
def test_of_a_case_that_is_damaged_the_rods_are_left(stored, text):
    with stored(text) as run:
        lines = describe_stored(run)
    assert [line.partition(";")[0] for line in lines] == [
        "rod zeta: 4 points, open, spacing 0.25 um",
        "rod alpha: 5 points, closed, spacing 0.5 um",
    ]

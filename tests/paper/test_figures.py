"""Quick versions of all figures: pictures, data, and the claims that hold, and that do not."""

import csv
from dataclasses import replace

import pytest
from figures.report import Row, markdown, verdict
from figures.runs import Workplace
from paper import reproduce

pytestmark = [pytest.mark.paper, pytest.mark.compiled]

EXPECTED = {  # rows by the start of their claim: does the code bear it out, on any machine
    "fig2": {"Omega_3 = pi/2": "in part", "Omega_3 = pi:": "in part", "Open rods": "yes"},
    "fig3": {"bending, twisting": "yes", "kinetic": "yes", "epsilon = 6 ds": "no"},
    "fig4": {"more coiled": "yes", "a stable coil": "in part", "Rings": "yes"},
    "late": {"(not in the paper)": "in part"},
    "fig5": {"bending and total": "no", "kinetic": "yes", "stretching": "yes"},
    "fig6": {"the speed grows linearly": "yes", "good agreement": "no", "shorter": "yes"},
}


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    return Workplace(tmp_path_factory.mktemp("paper"), quick=True, gib_seconds=20.0)


@pytest.mark.parametrize("name", list(EXPECTED))
def test_a_figure(name, place):
    # The open rod's 2000 steps of gIB are to be done; the ring's 100 000 are cut short.
    place = replace(place, gib_seconds=20.0 if name == "fig5" else 400.0)
    rows = reproduce([name], place)
    for start, agrees in EXPECTED[name].items():
        (row,) = [row for row in rows if row.claim.startswith(start)]
        assert row.agrees == agrees, row
    picture = place.path(f"{name}.png").read_bytes()
    assert picture.startswith(b"\x89PNG")
    assert 5_000 < len(picture) < 150_000
    with open(place.path(f"{name}.csv")) as stream:
        head, *lines = csv.reader(stream)
    assert len(lines) >= 2
    assert all(len(line) == len(head) for line in lines)


def test_table_3(place):
    rows = reproduce(["table3"], place)
    ratio = next(row for row in rows if "12 times faster" in row.claim)
    assert ratio.agrees == "yes", ratio  # a factor of hundreds: no clock can hide it
    assert len(markdown(rows).splitlines()) == len(rows) + 2


def test_verdicts():
    assert verdict([True, True]) == verdict(True) == "yes"
    assert verdict([True, False]) == "in part"
    assert verdict([False, False]) == verdict(False) == "no"
    assert markdown([Row("a", "b", "c", "no")]).splitlines()[-1] == "| a | b | c | no |"

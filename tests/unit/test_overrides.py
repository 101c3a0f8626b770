"""``--set key=value``: what can be changed, and what is refused."""

import math

import pytest

from rodsim.case import load_case
from rodsim.errors import CaseError

CASE = """\
parameters: {k: 1.5}
fluid: {viscosity: 1.3e-6, epsilon: 0.3}
rods:
  tail:
    shape: {kind: straight, points: 50, length: 4}
    moduli: {bending: [3e-3, 4e-3], twisting: 5e-3, shear: 0.8, stretch: 0.9}
    strain_twist: ["k*s", 0, 0]
time: {end: 0.2}
"""


@pytest.fixture
def change(tmp_path):
    path = tmp_path / "case.yaml"
    path.write_text(CASE)
    return lambda *overrides: load_case(path, overrides)


@pytest.mark.parametrize(
    ("overrides", "read", "value"),
    [
        (["time.end=1e-3"], lambda c: c.time.end, 1e-3),
        (["time.end = 0.7"], lambda c: c.time.end, 0.7),
        (["time.end=0.7", "time.end=0.8"], lambda c: c.time.end, 0.8),
        (["output.interval=0.1"], lambda c: c.interval, 0.1),
        (["output.fields=[position, force]"], lambda c: c.output.fields, ("position", "force")),
        (["units.length=mm"], lambda c: c.units.length, "mm"),
        (["title=a = b"], lambda c: c.title, "a = b"),
        (["parameters.d=k/3", "time.end=4*d"], lambda c: c.time.end, 2.0),
        (["parameters.phi=pi"], lambda c: c.parameters, {"k": 1.5, "phi": math.pi}),
        (
            ["rods.tail.parameters.k=2*k0", "parameters.k0=0.4"],
            lambda c: c.rods["tail"].strain_twist[0].parameters,
            {"k": 0.8, "k0": 0.4},
        ),
        (["time.end='0.7'"], lambda c: c.time.end, 0.7),
        (["rods.tail.shape.points=0.3/0.1 + 40*k"], lambda c: c.rods["tail"].shape.points, 63),
        (
            ["rods.tail.moduli.bending=[2*k, k**2]"],
            lambda c: c.rods["tail"].moduli.values[:2],
            (3.0, 2.25),
        ),
        (["parameters.k=2.5"], lambda c: c.rods["tail"].strain_twist[0].parameters, {"k": 2.5}),
        (["rods.tail.strain_twist.2=0.4"], lambda c: c.rods["tail"].strain_twist[2], 0.4),
        (["rods.tail.moduli.bending.1=0.5"], lambda c: c.rods["tail"].moduli.values[1], 0.5),
        (["rods.tail.moduli.bending=0.5"], lambda c: c.rods["tail"].moduli.values[:2], (0.5, 0.5)),
        (["rods.tail.shape.origin.1=3"], lambda c: c.rods["tail"].shape.origin, (0.0, 3.0, 0.0)),
        (["rods.tail.strain_twist=null"], lambda c: c.rods["tail"].strain_twist, (0.0, 0.0, 0.0)),
        (["fluid.epsilon={spacings: 6}"], lambda c: c.fluid.epsilon.spacings, 6.0),
        (
            ["rods.tail.shape.length=null", "rods.tail.shape.spacing=0.02"],
            lambda c: c.rods["tail"].shape.ds,
            0.02,
        ),
        (
            ["rods.tail.shape.rotate.axis=[0, 0, 1]", "rods.tail.shape.rotate.degrees=30"],
            lambda c: c.rods["tail"].shape.rotate.degrees,
            30.0,
        ),
    ],
)
def test_changes(change, overrides, read, value):
    assert read(change(*overrides)) == value


@pytest.mark.parametrize(
    ("override", "key", "words"),
    [
        ("time.end", "time.end", "must be written key=value"),
        ("=3", "", "must be written key=value"),
        ("", "", "must be written key=value"),
        ("time.end=", "time.end", "has no value"),
        ("time.edn=3", "time.edn", "did you mean 'end'?"),
        ("tiem.end=3", "tiem.end", "did you mean 'time'?"),
        ("rods.tial.shape.points=3", "rods.tial.shape.points", "did you mean 'tail'?"),
        ("rods.new={}", "rods.new", "rods has no 'new'"),
        ("parameters.2b=3", "parameters.2b", "letters, digits and _"),
        ("parameters.b=3*c", "parameters.b", "unknown name 'c'"),
        ("parameters.sin=3", "parameters.sin", "already has a meaning"),
        ("tracers.m=[[1, 2, 3]]", "tracers.m", "tracers has no 'm'"),
        ("rods.tail.shape.radius=1", "rods.tail.shape.radius", "unknown key"),
        ("rods.tail.strain_twist.3=1", "rods.tail.strain_twist.3", "entries 0 to 2"),
        ("rods.tail.strain_twist.-1=1", "rods.tail.strain_twist.-1", "entries 0 to 2"),
        ("fluid.viscosity.x=1", "fluid.viscosity.x", "single value"),
        ("time.end=[1", "time.end", "not valid YAML"),
        ("time.end={a: 1, a: 2}", "time.end.a", "duplicate key"),
        ("time.end=-1", "time.end", "must be > 0"),
        ("time.end=long", "time.end", "there is no parameter 'long': must be a number"),
        ("time.end=3*x", "time.end", "unknown name 'x': it can use pi or k"),
        ("time.end=k - 2", "time.end", "must be > 0"),
        ("rods.tail.shape.points=50/3", "rods.tail.shape.points", "whole number, and is 16.66"),
        ("time=null", "time", "missing"),
        ("time.end=\udc80", "time.end", "U+DC80"),
    ],
)
def test_refused(change, override, key, words):
    with pytest.raises(CaseError) as caught:
        change(override)
    (problem,) = caught.value.problems
    assert (problem.where, problem.key) == ("--set", key)
    assert words in problem.reason


def test_problems_of_options_and_of_the_file_come_together(change):
    with pytest.raises(CaseError) as caught:
        change("time.end=x", "fluid.blob=cube", "nothing", "rods.tail.moduli.shear=0")
    assert [p.key for p in caught.value.problems] == [
        "nothing", "time.end", "fluid.blob", "rods.tail.moduli.shear"
    ]  # fmt: skip


def test_lines_of_the_file_survive_an_override(change):
    case = change("time.end=0.3")
    assert case.source.where(("rods", "tail", "shape", "points")).endswith("case.yaml:5")
    assert case.source.where(("time", "end")) == "--set"
    assert case.source.where(("time", "step")).endswith("case.yaml:8")

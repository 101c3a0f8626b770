"""Case files -> Case: values, defaults, derived numbers, the schema and the templates."""

import json
import math
import pickle

import numpy as np
import pytest
import yaml

from rodsim.case import (
    TEMPLATES,
    case_from_mapping,
    case_schema,
    check_strain_twist,
    load_case,
    template,
)
from rodsim.errors import CaseError, UsageError

RING = """\
fluid:
  viscosity: 1.3e-6
  epsilon: {spacings: 4}
rods:
  ring:
    shape: {kind: ring, radius: 2.5, points: 200}
    moduli: {bending: [3e-3, 4e-3], twisting: 5e-3, shear: 0.8, stretch: 0.9}
time: {end: 0.2}
"""


@pytest.fixture
def load(tmp_path):
    def make(text, overrides=()):
        path = tmp_path / "case.yaml"
        path.write_text(text)
        return load_case(path, overrides)

    return make


def test_values_and_defaults(load):
    case = load(RING)
    rod = case.rods["ring"]
    assert rod.moduli.values == (3e-3, 4e-3, 5e-3, 0.8, 0.8, 0.9)
    assert rod.strain_twist == (0.0, 0.0, 0.0)
    assert rod.shape.origin == (0.0, 0.0, 0.0)
    assert rod.shape.is_closed
    assert rod.shape.ds == pytest.approx(2 * math.pi * 2.5 / 200, rel=1e-15)
    assert rod.shape.segments == 200
    assert (case.fluid.blob, case.fluid.epsilon.spacings) == ("algebraic7", 4.0)
    assert (case.time.integrator, case.time.tolerance, case.time.step) == ("rkc", 1e-4, None)
    assert (case.units.length, case.units.mass, case.units.time) == ("um", "g", "s")
    assert case.interval == pytest.approx(0.002, rel=1e-15)
    assert case.output.fields == ("position", "director")
    assert case.plane is None
    assert case.tracers == {}
    assert case.warnings == ()


@pytest.mark.parametrize(
    ("shape", "ds"),
    [
        ("{kind: straight, points: 11, length: 3}", 0.3),
        ("{kind: straight, points: 11, spacing: 0.4}", 0.4),
        ("{kind: helix, points: 11, length: 3, radius: 1, pitch: -2}", 0.3),
        ("{kind: sine, points: 11, length: 3, amplitude: 0, wavelength: 2}", 0.3),
    ],
)
def test_open_shapes(load, shape, ds):
    shape = load(RING.replace("{kind: ring, radius: 2.5, points: 200}", shape)).rods["ring"].shape
    assert shape.ds == pytest.approx(ds, rel=1e-15)
    assert (shape.segments, shape.is_closed) == (10, False)


def test_file_shape_is_known_only_when_read(load):
    text = RING.replace("{kind: ring, radius: 2.5, points: 200}", "{kind: file, path: a.txt}")
    shape = load(text).rods["ring"].shape
    assert (shape.ds, shape.segments, shape.frame, shape.rod) == (None, None, None, None)


def test_tracers(load):
    case = load(
        RING + "tracers:\n  points: [[1, 2, 3], [4, 5, 6]]\n"
        "  tube: {kind: tube, rod: ring, radius: 0.4, around: 8, along: 100}\n"
    )
    assert case.tracers["points"] == ((1.0, 2.0, 3.0), (4.0, 5.0, 6.0))
    assert (case.tracers["tube"].around, case.tracers["tube"].along) == (8, 100)


def test_expression_gets_the_parameters(load):
    case = load(RING + "parameters: {k: 1.5}\n", ["rods.ring.strain_twist=['k*s', 0, 0.5]"])
    first, second, third = case.rods["ring"].strain_twist
    assert (first.text, first.parameters) == ("k*s", {"k": 1.5})
    assert first(0.4, 7.0) == pytest.approx(0.6)
    assert (second, third) == (0.0, 0.5)


def test_an_empty_section_is_one_left_out(load):
    assert load(RING + "output:\n  # interval: 3\n").interval == pytest.approx(0.002)


def test_a_case_cannot_be_changed(load):
    with pytest.raises(ValueError, match="frozen"):
        load(RING).time.end = 3.0


def test_resolved_is_json_and_makes_the_same_case(load):
    case = load(RING, ["rods.ring.strain_twist=['0.5*sin(s)', 0, 0]", "time.integrator=rk4",
                       "time.step=1e-3"])  # fmt: skip
    resolved = json.loads(json.dumps(case.resolved()))
    assert resolved["output"] == {"interval": 0.002, "fields": ["position", "director"]}
    assert resolved["rods"]["ring"]["strain_twist"] == ["0.5*sin(s)", 0.0, 0.0]
    assert resolved["time"] == {"end": 0.2, "integrator": "rk4", "step": 1e-3}
    assert case_from_mapping(resolved) == case_from_mapping(case.resolved())
    assert case_from_mapping(resolved).resolved() == resolved
    later = case_from_mapping(resolved, ["time.end=0.4"])
    assert (later.time.end, later.interval) == (0.4, 0.002)
    assert resolved["time"]["end"] == 0.2


def test_case_pickles(load):
    case = load(RING, ["rods.ring.strain_twist=['sin(s)', 0, 0]"])
    assert pickle.loads(pickle.dumps(case)).resolved() == case.resolved()


def test_source_remembers_text_and_overrides(load, tmp_path):
    case = load(RING, ["time.end=0.3"])
    assert case.source.text == RING
    assert case.source.overrides == ("time.end=0.3",)
    path = tmp_path / "case.yaml"
    assert str(case.source.problem("rods.ring.shape.radius", "is odd")) == (
        f"{path}:6: rods.ring.shape.radius = 2.5 (um): is odd"
    )
    assert (
        str(case.source.problem(("time", "end"), "is odd")) == "--set: time.end = 0.3 (s): is odd"
    )


def test_units_of_messages_are_the_cases_own(load):
    case = load(RING + "units: {length: mm, mass: kg, time: h}\n")
    assert case.source.problem("fluid.viscosity", "").unit == "kg mm^-1 h^-1"
    assert case.source.problem("rods.ring.moduli.bending.0", "").unit == "kg mm^3 h^-2"
    assert case.source.problem("rods.ring.moduli.stretch", "").unit == "kg mm h^-2"


def test_coarse_rod_is_a_warning(load):
    case = load(RING, ["rods.ring.strain_twist=[9, 0, 12]"])  # abs(Omega) = 15, ds = pi/40
    (warning,) = case.warnings
    assert warning.key == "rods.ring.strain_twist"
    assert "abs(Omega) ds = 1.178" in warning.reason


@pytest.mark.parametrize(
    ("overrides", "key"),
    [
        (["time.step=1e-3"], "time.step"),
        (["time.integrator=euler", "time.step=1e-3", "time.tolerance=1e-3"], "time.tolerance"),
    ],
)
def test_what_the_integrator_ignores_is_a_warning(load, overrides, key):
    (warning,) = load(RING, overrides).warnings
    assert warning.key == key
    assert warning.reason.startswith("ignored: ")


@pytest.mark.parametrize(
    ("overrides", "interval"),
    [
        (["time.integrator=rk4", "time.step=1e-3"], 2e-3),
        (["time.integrator=rk4", "time.step=8e-4"], 2.4e-3),  # end/100 = 2.5 steps
        (["time.integrator=euler", "time.step=0.1"], 0.1),  # not less than a step
        (["output.interval=0.7"], 0.7),  # longer than the run: frames at 0 and end only
    ],
)
def test_interval(load, overrides, interval):
    assert load(RING, overrides).interval == pytest.approx(interval, rel=1e-12)


def test_rest_state_is_looked_for_at_the_end_as_well(load):
    with pytest.raises(CaseError, match=r"t = 0\.2: above 2"):
        load(RING, ["rods.ring.strain_twist=['200*t', 0, 0]"])


def test_strain_twist_is_taken_at_midpoints(load):
    rod = load(RING, ["rods.ring.strain_twist=['where(s < 0.05, 0, 1)', 0, 0]"]).rods["ring"]
    errors, warnings = check_strain_twist(rod.entries, ds=1.9, segments=1, end=0.0)  # s = 0.95
    assert not errors
    assert "at s = 0.95" in warnings[0][1]
    assert check_strain_twist(rod.entries, ds=0.09, segments=1, end=0.0) == ([], [])  # s = 0.045
    errors, _ = check_strain_twist(rod.entries, ds=2.1, segments=3, end=0.0)
    assert errors[0][0] == ("strain_twist",)


def test_huge_rods_are_sampled(load):
    rod = load(RING, ["rods.ring.strain_twist=['s*0', 0, 0]"]).rods["ring"]
    assert check_strain_twist(rod.entries, ds=1e-3, segments=10**9, end=0.0) == ([], [])


@pytest.mark.parametrize("name", TEMPLATES)
def test_templates_are_valid_cases(load, name):
    case = load(template(name))
    assert case.warnings == ()
    assert case.resolved()["rods"]


def test_template_of_the_open_rod_is_the_papers(load):
    rod = load(template("open")).rods["rod"]
    assert rod.shape.points == 76
    assert rod.shape.ds == pytest.approx(math.pi / 40, rel=1e-8)
    assert rod.strain_twist == pytest.approx((1.3, 0.0, math.pi), rel=1e-8)


def test_unknown_template():
    with pytest.raises(UsageError, match="did you mean 'ring'"):
        template("rign")


@pytest.mark.parametrize("name", TEMPLATES)
def test_optional_keys_of_the_templates_work_uncommented(load, name):
    optional = ("# density", "# rotate", "# origin", "# tracers", "#   markers", "#   points",
                "# fields", "# perturbation")  # fmt: skip
    lines = template(name).split("\n")
    found = [line for line in lines if line.strip().startswith(optional)]
    assert len(found) >= 7
    text = "\n".join(line.replace("# ", "", 1) if line in found else line for line in lines)
    case = load(text)
    assert case.fluid.density == 1e-12
    assert set(case.tracers) == {"markers", "points"}


def _walk(node):
    if isinstance(node, dict):
        yield from node.items()
        for item in node.values():
            yield from _walk(item)
    elif isinstance(node, list):
        for item in node:
            yield from _walk(item)


def test_schema_is_draft_07_with_every_reference_there():
    schema = case_schema()
    json.dumps(schema)
    assert schema["$schema"] == "http://json-schema.org/draft-07/schema#"
    keys = {key for key, _ in _walk(schema)}
    assert not keys & {"$defs", "prefixItems", "discriminator"}
    for key, target in _walk(schema):
        if key == "$ref":
            assert target.removeprefix("#/definitions/") in schema["definitions"]


def test_schema_knows_the_unions_and_describes_every_key():
    definitions = case_schema()["definitions"]
    epsilon = definitions["Fluid"]["properties"]["epsilon"]["oneOf"]
    assert {"$ref": "#/definitions/Spacings"} in epsilon
    assert {"exclusiveMinimum": 0, "type": ["number", "string"]} in epsilon
    bending = definitions["Moduli"]["properties"]["bending"]["oneOf"]
    assert [member["type"] for member in bending] == ["number", "string", "array"]
    natural, table, triple = definitions["Rod"]["properties"]["strain_twist"]["oneOf"]
    assert natural["const"] == "natural"
    assert table == {"$ref": "#/definitions/StrainTables"}
    entry = triple["items"][0]["oneOf"]
    assert [member.get("type") for member in entry] == ["number", "string", None]
    assert definitions["Fluid"]["required"] == ["viscosity", "epsilon"]
    for model in definitions.values():
        assert model["additionalProperties"] is False
        for key, field in model["properties"].items():
            assert key == "kind" or field["description"]


def test_same_data_as_an_ordinary_yaml_reader(load):
    text = template("ring")
    plain = yaml.safe_load(text)
    case = load(text)
    assert case.fluid.viscosity == plain["fluid"]["viscosity"]
    assert np.array(case.rods["ring"].strain_twist) == pytest.approx(
        plain["rods"]["ring"]["strain_twist"]
    )


def test_more_points_are_no_advice_where_a_unit_is_wrong(load):
    (warning,) = load(RING, ["fluid.epsilon=1e-9"]).warnings
    assert "points would do: are the units of epsilon and the rod right?" in warning.reason
    with pytest.raises(CaseError, match="are the units of strain_twist and the rod right"):
        load(RING, ["rods.ring.strain_twist=[1.2e6, 0, 0]"])


def test_the_command_for_another_run_replaces_what_it_changes(load, tmp_path):
    source = load(RING, ["time.integrator=euler", "time.step = 1e-3", "time.end=0.3"]).source
    assert source.command("time.integrator=rkc", output="a b.h5") == (
        f"rodsim run {tmp_path / 'case.yaml'} --set time.integrator=rkc --set 'time.step = 1e-3'"
        " --set time.end=0.3 -o 'a b.h5'"
    )
    assert source.command("time.step=1e-4").endswith(
        "--set time.integrator=euler --set time.step=1e-4 --set time.end=0.3"
    )


@pytest.mark.parametrize("epsilon", [0.05, {"spacings": 0.5}])
def test_a_rod_thinner_than_its_spacing_is_warned_of(epsilon):
    shape = {"kind": "straight", "points": 21, "length": 2.0}
    moduli = {"bending": 3e-3, "twisting": 3e-3, "shear": 0.7, "stretch": 0.9}
    data = {"fluid": {"viscosity": 1e-6, "epsilon": epsilon}, "time": {"end": 1e-3},
            "rods": {"tail": {"shape": shape, "moduli": moduli}}}  # fmt: skip
    (warning,) = case_from_mapping(data).warnings
    assert "is 0.5 spacings of rod 'tail'" in str(warning)
    data["fluid"]["epsilon"] = 0.1
    assert case_from_mapping(data).warnings == ()

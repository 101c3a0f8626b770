"""What editors and shells are given: the schema of case files, completion of the command."""

import json
import os
import subprocess
import sys

import pytest
import yaml
from jsonschema import Draft7Validator
from scenes import CONFIGS

from rodsim.case import TEMPLATES, case_schema, template
from rodsim.case.yaml_text import parse

CASES = sorted(CONFIGS.glob("*.yaml"))
MODELINE = "# yaml-language-server: $schema=rodsim.schema.json"


@pytest.fixture(scope="module")
def validator():
    Draft7Validator.check_schema(case_schema())
    return Draft7Validator(case_schema())


def data_of(text):
    return parse(text, str)[0]


@pytest.mark.parametrize("path", CASES, ids=lambda path: path.stem)
def test_configs_pass_the_schema_and_name_it(path, validator):
    text = path.read_text()
    assert text.splitlines()[0] == MODELINE
    validator.validate(data_of(text))


@pytest.mark.parametrize("name", TEMPLATES)
def test_templates_pass_the_schema(name, validator):
    validator.validate(data_of(template(name)))
    validator.validate(yaml.safe_load(template(name)))  # editors read YAML by other rules


def test_the_schema_beside_the_configs_is_that_of_the_command():
    assert json.loads((CONFIGS / "rodsim.schema.json").read_text()) == case_schema()


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("viscosity: 1.0e-6", "viscosity: -2.0e-6"),
        ("viscosity: 1.0e-6", "viscosity: 2.0e-6\n  viscosty: 2.0e-6"),
        ("kind: ring ", "kind: rind "),
        ("points: 200", "points: 2"),
        ("points: 200", "points: 40.5"),
        ("  ring:", "  my ring:"),
        ("bending: 3.5e-3", "bending: [3.5e-3, 3.4e-3, 3.3e-3]"),
        ("tolerance: 1.0e-4", "tolerance: 2.0"),
        ("integrator: rkc", "integrator: rk5"),
        ("      kind: ring                          #", "      kind: helix\n      pitch: 0\n#"),
    ],
)
def test_the_schema_refuses_what_is_wrong(old, new, validator):
    text = template("ring")
    assert old in text
    assert not validator.is_valid(data_of(text.replace(old, new, 1)))


@pytest.mark.parametrize(
    ("more", "good"),
    [
        ("shape: {origin: [0, d, 0]}", True),
        ("moduli: {bending: 2.0e-3}", True),
        ("loads: {weight: {force: [0, 0, f]}}", True),
        ("strain_twist: [{period: 3}, 0, 0]", True),
        ("shape: {kind: ring, radius: 2}", True),
        ("shape: {orign: [0, 0, 3]}", False),
        ("shape: {points: 1}", False),
        ("moduli: {bendin: 2.0e-3}", False),
        ("loads: {weight: {force: [0, 0]}}", False),
    ],
)
def test_a_rod_like_another_need_not_say_all(validator, more, good):
    text = template("ring")
    assert "time:" in text
    rods = f"rods:\n  other: {{like: ring, {more}}}\n"
    assert validator.is_valid(data_of(text.replace("rods:\n", rods, 1))) == good
    alone = rods.replace("like: ring, ", "")
    assert not validator.is_valid(data_of(text.replace("rods:\n", alone, 1)))


@pytest.mark.parametrize(("shell", "at"), [("bash", "1"), ("zsh", "1"), ("fish", "sw")])
def test_shells_can_complete_commands(shell, at):
    """``at`` is the number of the word to complete; for fish it is the word."""

    def ask(instruction):
        environment = dict(os.environ, _RODSIM_COMPLETE=f"{shell}_{instruction}",
                           COMP_WORDS="rodsim sw", COMP_CWORD=at)  # fmt: skip
        return subprocess.run(
            [sys.executable, "-m", "rodsim"], env=environment, capture_output=True, text=True
        ).stdout

    assert "_RODSIM_COMPLETE" in ask("source")
    assert "sweep" in ask("complete")

"""YAML text -> data and lines: numbers by YAML 1.2, none of YAML's traps."""

import math

import pytest

from rodsim.case.yaml_text import DEEPEST, MOST_PROBLEMS, parse
from rodsim.errors import CaseError


def read(text):
    return parse(text, lambda line: f"f:{line}")


def problems(text):
    with pytest.raises(CaseError) as caught:
        read(text)
    return caught.value.problems


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1e-3", 0.001),
        ("1.", 1.0),
        (".5", 0.5),
        ("1E+3", 1000.0),
        ("-2.5e2", -250.0),
        ("+2", 2),
        ("010", 10),
        ("0x1F", 31),
        ("0o17", 15),
        ("-.inf", -math.inf),
        ("9" * 5000, math.inf),
        ("true", True),
        ("FALSE", False),
        ("~", None),
        ("null", None),
        ("no", "no"),
        ("yes", "yes"),
        ("on", "on"),
        ("1e-3x", "1e-3x"),
        ("1_000", "1_000"),
        ("12:30", "12:30"),
        ("2013-01-01", "2013-01-01"),
        ("'1e-3'", "1e-3"),
        ('"true"', "true"),
        ("''", ""),
    ],
)
def test_scalar(text, value):
    found = read(f"a: {text}")[0]["a"]
    assert found == value
    assert type(found) is type(value)


def test_nan():
    assert math.isnan(read("a: .nan")[0]["a"])


def test_lines_are_those_of_keys_and_list_entries():
    data, lines = read("# note\na:\n  b: [1,\n      2]\nc:\n  - x\n  - {y: 3}\n")
    assert data == {"a": {"b": [1, 2]}, "c": ["x", {"y": 3}]}
    assert lines == {
        (): 2, ("a",): 2, ("a", "b"): 3, ("a", "b", 0): 3, ("a", "b", 1): 4,
        ("c",): 5, ("c", 0): 6, ("c", 1): 7, ("c", 1, "y"): 7,
    }  # fmt: skip


def test_all_duplicate_keys_are_reported():
    found = problems("a: 1\nb: {c: 1, c: 2}\na: 3\n")
    assert [(p.where, p.key) for p in found] == [("f:2", "b.c"), ("f:3", "a")]
    assert found[1].reason == "duplicate key: first given at f:1"


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("a: &x 1", 1, "anchors (&x) are not supported"),
        ("a: 1\nb: *x", 2, "aliases (*x) are not supported"),
        ("a: 1\n<<: {b: 2}", 2, "merge keys"),
        ("a: !!python/object:os.system 1", 1, "tags"),
        ("a: 1\n---\nb: 2", 2, "second document"),
        ("a: 1\n2: 3", 2, "the key 2 must be text"),
        ("null: 3", 1, "must be text"),
        ("[a]: 3", 1, "a key must be plain text"),
        ("? {a: 1}\n: 2", 1, "a key must be plain text"),
        ("a:\n\tb: 1", 2, "indent with spaces, not tabs"),
        ("a: b: c", 1, "a ':' too many"),
        ("a: 1\nb: [1, 2\nc: 3\n", 3, "check indents, commas, quotes and brackets"),
        ("a: 'x", 1, "not valid YAML"),
        ("a: 1\nb: \x00", 2, "U+0000"),
        ("a: 1\nb: \x1b[31m", 2, "U+001B"),
        ("a: \ud800", 1, "U+D800"),
    ],
)
def test_refused(text, line, words):
    first = problems(text)[0]
    assert first.where == f"f:{line}"
    assert words in first.reason


@pytest.mark.parametrize("opening", ["[", "- ", "{a: "])
def test_depth_is_limited(opening):
    found = problems("a:\n  " + opening * 100_000)
    assert found[0].reason == f"nested deeper than {DEEPEST} levels"


def test_quoted_merge_sign_is_an_ordinary_key():
    assert read('"<<": 1')[0] == {"<<": 1}


def test_problems_are_limited():
    assert len(problems("a: 1\n" * 10_000)) == MOST_PROBLEMS


def test_empty_text_is_none():
    assert read("# only a comment\n")[0] is None

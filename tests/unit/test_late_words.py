"""The word of a part in a case: its validator is made late, and is the one it would be early."""

import pydantic
import pytest
from pydantic import Field, ValidationError

from rodsim import registry
from rodsim.case.fields import (
    Model,
    NotNegative,
    NumberOrExpression,
    Positive,
    ScopedText,
    Vector,
)


class Spring(Model):
    """Words of a part that is not there."""

    stiffness: Positive
    length: NotNegative = 0.7
    direction: Vector = (0.0, 0.0, 2.0)
    pull: NumberOrExpression = 0.3


class Early(Model):
    """A section with the word as it would be without delay."""

    title: str = ""
    springs: dict[str, Spring] | None = Field(
        None, description="what holds", json_schema_extra={"dimension": "stiffness"}
    )


@pytest.fixture
def made(monkeypatch):
    """The types whose validators were made late."""
    made, maker = [], pydantic.TypeAdapter

    def counted(words):
        made.append(words)
        return maker(words)

    monkeypatch.setattr(pydantic, "TypeAdapter", counted)
    return made


@pytest.fixture
def late(monkeypatch, made):
    def kind(word, where, words):
        return registry.Kind(lambda *_: [], word, where, words, "stiffness", "what holds")

    kinds = kind("springs", "Early", dict[str, Spring]), kind("other", "Elsewhere", Spring)
    monkeypatch.setattr(registry, "kinds", lambda: kinds)
    bare = type("Early", (Model,), {"__annotations__": {"title": str}, "title": "",
                                    "__module__": __name__, "__doc__": Early.__doc__})  # fmt: skip
    return registry.with_words(bare)


def errors_of(model, data):
    with pytest.raises(ValidationError) as caught:
        model.model_validate(data)
    return [(e["loc"], e["type"], e["msg"]) for e in caught.value.errors()]


def test_a_word_is_what_its_type_makes_of_it(late):
    words = {"stiffness": 2.5, "direction": [3, 4, 5], "pull": ScopedText("k*t", {"k": 7.0})}
    found = late.model_validate({"springs": {"a": words}}).springs["a"]
    assert isinstance(found, Spring)
    assert (found.stiffness, found.length, found.direction) == (2.5, 0.7, (3, 4, 5))
    assert found.pull.uses_t  # the parameters of its place have come with it


def test_only_sections_of_its_own_have_a_word(late):
    assert list(late.model_fields) == ["title", "springs"]


@pytest.mark.parametrize(
    "data",
    [
        {"springs": {"a": {"stiffness": -2, "length": -3}, "b": {"stiff": 3}}},
        {"springs": [3]},
        {"springs": {"a": {"stiffness": "3"}}, "sprngs": 3},
    ],
)
def test_all_that_is_wrong_is_told_at_its_place(late, data):
    assert errors_of(late, data) == errors_of(Early, data)


def test_its_validator_is_made_once_and_only_if_a_case_has_it(late, made):
    assert late.model_validate({"title": "none"}).springs is None
    assert made == []
    for _ in range(2):
        late.model_validate({"springs": {"a": {"stiffness": 2.5}}})
    assert made == [dict[str, Spring] | None]
    assert late.model_validate({"springs": None}).springs is None


def test_the_schema_is_the_same(late):
    assert late.model_json_schema() == Early.model_json_schema()

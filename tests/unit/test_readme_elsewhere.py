"""The README as package indexes show it: links lead to the repository, or are words."""

import importlib.util
import re

import pytest
from scenes import ROOT

TEXT = (ROOT / "README.md").read_text(encoding="utf-8")
LINK = re.compile(r"\]\(([^)]+)\)")


@pytest.fixture(scope="module")
def elsewhere():
    pytest.importorskip("hatchling", reason="builds the package")
    path = ROOT / "docs" / "readme_elsewhere.py"
    spec = importlib.util.spec_from_file_location("readme_elsewhere", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.elsewhere


def test_every_link_leads_into_the_repository_where_that_is_known(elsewhere):
    made = LINK.findall(elsewhere(TEXT, "https://host.test/us/rodsim/"))
    asked = LINK.findall(TEXT)
    assert len(made) == len(asked) > 30
    for link, was in zip(made, asked, strict=True):
        kind = "raw" if was.endswith(".png") else "blob"
        expected = was if was.startswith("#") else f"https://host.test/us/rodsim/{kind}/HEAD/{was}"
        assert link == expected


def test_without_a_repository_words_stay_and_pictures_go(elsewhere):
    text = elsewhere(TEXT, None)
    assert not [link for link in LINK.findall(text) if not link.startswith(("#", "https:"))]
    assert "![" not in text
    assert re.findall(r"^## .*", text, re.M) == re.findall(r"^## .*", TEXT, re.M)
    configs = [line for line in TEXT.splitlines() if line.startswith("| `")]
    assert len(configs) == sum(line.startswith("| `") for line in text.splitlines())

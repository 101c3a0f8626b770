"""docs/gallery.md shows every config, with its own sentence; its pictures are small."""

import importlib.util
import re
import sys

import pytest
from scenes import CONFIGS, ROOT

pytest.importorskip("matplotlib")
PAGE = ROOT / "docs" / "gallery.md"
NAMES = sorted(path.stem for path in CONFIGS.glob("*.yaml"))


@pytest.fixture(scope="module")
def gallery():
    spec = importlib.util.spec_from_file_location("gallery", ROOT / "docs" / "gallery.py")
    module = sys.modules["gallery"] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_every_config_has_a_section_with_its_own_sentence(gallery):
    sections = gallery.stored_sections()
    assert sorted(sections) == NAMES
    for name, text in sections.items():
        assert f"\n\n{gallery.sentence(name)}\n\n" in text
        assert re.search(r"\d.* · `rodsim (run|rest( --saddle)?)`, \d+\.\d CPU s · ", text), name
        assert f"(images/gallery/{name}.png)" in text


def test_the_pictures_are_those_of_the_configs_and_small():
    pictures = list((ROOT / "docs" / "images" / "gallery").iterdir())
    assert sorted(path.name for path in pictures) == [f"{name}.png" for name in NAMES]
    assert sum(path.stat().st_size for path in pictures) < 3e6
    for path in pictures:
        assert path.read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"


def test_a_sentence_ends_where_the_header_ends_it(gallery):
    assert gallery.sentence("two_flagella") == (
        "Two flagella side by side, the second like the first but for its place and its phase."
    )


@pytest.mark.long
@pytest.mark.compiled
def test_the_command_measures_and_draws_what_the_page_says(gallery, tmp_path, monkeypatch):
    monkeypatch.setattr(gallery, "PICTURES", tmp_path)
    fresh = gallery.show("fibre_settling_on_wall", tmp_path)
    cost = re.compile(r"\d+\.\d CPU s")
    stored = gallery.stored_sections()["fibre_settling_on_wall"]
    assert cost.sub("", fresh) == cost.sub("", stored)
    assert (tmp_path / "fibre_settling_on_wall.png").stat().st_size > 3000

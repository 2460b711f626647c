"""README.md is short, stands alone, and can be read where there is nothing but its text."""

from __future__ import annotations

import importlib.util
import re
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from PIL import Image, ImageChops, ImageStat

from prag_asp import TaskSpace, load_domain
from prag_asp.dataset import instruction_writer_of
from tests.docs.pages import DOCS, ROOT
from tests.docs.test_examples import SETUP
from tests.toml import tomllib

README = (ROOT / "README.md").read_text(encoding="utf-8")
GENERATE = DOCS / "generate"


def generated(name: str) -> ModuleType:
    """Return a module of docs/generate, which is not a package."""
    spec = importlib.util.spec_from_file_location(f"docs.generate.{name}", GENERATE / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


def substitutions() -> list[dict[str, Any]]:
    table = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    return table["tool"]["hatch"]["metadata"]["hooks"]["fancy-pypi-readme"]["substitutions"]


def long_description() -> str:
    """Return the README as a package index shows it."""
    text = README
    for each in substitutions():
        text = re.sub(each["pattern"], each["replacement"], text)
    return text


def test_it_is_short() -> None:
    assert len(README.encode()) <= 6_000


def test_the_two_commands_stand_near_the_top_on_one_line_each() -> None:
    top = README.splitlines()[:40]
    assert sum(line in SETUP and "python3 -m venv" in line for line in top) == 2


def test_every_link_and_picture_exists() -> None:
    targets = re.findall(r"\]\(([^)#]+)\)", README)
    assert targets
    assert [each for each in targets if not each.startswith("https://") and not (ROOT / each).exists()] == []


def test_without_files_it_has_no_links_to_files_and_the_picture_in_words() -> None:
    text = long_description()
    assert re.findall(r"\]\((?!https://)", text) == []
    assert "see it work in five minutes | Quickstart, gallery of domains |" in text
    pictures = generated("pictures")
    domain = load_domain("household")
    [task] = TaskSpace(domain, 5).where(*pictures.SHOWN).sample(1, seed=1)
    told = instruction_writer_of(domain).captions(task)[1:]
    headings = " | ".join(heading.partition(". ")[2] for heading, _ in told)
    captions = " | ".join(caption for _, caption in told)
    assert f"| {headings} |" in text and f"| {captions} |" in text
    assert f"| {headings} |" not in README


@pytest.mark.parametrize("name", ["five_subgoals", "desk"])
def test_a_picture_is_what_its_script_draws(name: str) -> None:
    pictures = generated("pictures")
    with Image.open(pictures.PICTURES / f"{name}.png") as committed:
        drawn = pictures.draw(pictures.STRIPS[name]).convert("RGB")
        assert drawn.size == committed.size
        difference = ImageStat.Stat(ImageChops.difference(drawn, committed.convert("RGB"))).mean
    # A newer Pillow may draw letters a little differently; another witness differs by more than this.
    assert max(difference) < 1.0, f"draw it again: python docs/generate/pictures.py {name}"


def test_the_pictures_are_those_of_the_script_or_screenshots_of_a_page_and_small() -> None:
    pictures = generated("pictures")
    found: dict[str, Path] = {path.stem: path for path in pictures.PICTURES.iterdir()}
    drawn = {*pictures.STRIPS, "curve", "cameras", "first_dataset", "demonstration"}
    assert drawn <= found.keys()
    pages = "".join(page.read_text(encoding="utf-8") for page in (ROOT / "docs").rglob("*.md"))
    assert [name for name in found.keys() - drawn if f"pictures/{found[name].name}" not in pages] == [], "screenshots"
    assert found.pop("demonstration").stat().st_size < 2_000_000
    assert all(path.stat().st_size < 300_000 for path in found.values())

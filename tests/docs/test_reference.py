"""The reference is whole: no key, predicate, encoding, name or option is missing from the pages."""

from __future__ import annotations

import itertools
import json
import re
from pathlib import Path
from types import ModuleType

import click
import pytest

import prag_asp
import prag_asp.dataset
import prag_asp.evaluation
import prag_asp.physics
import prag_asp.rl
import prag_asp.similarity
from prag_asp import TaskSpace, load_domain
from prag_asp.cli import cli
from prag_asp.dataset import feasible, write_line
from prag_asp.program.paths import shipped_domains
from prag_asp.scene.predicate_names import PREDICATE_ROLES
from prag_asp.scene.read.scene_reader import SCENE_KEYS
from prag_asp.scene.shape_kinds import KINDS
from tests.docs.pages import DOCS, ROOT
from tests.docs.test_readme import generated


def page(name: str) -> str:
    return (DOCS / name).read_text(encoding="utf-8")


def test_the_scene_names_all_that_it_may_say() -> None:
    text = page("domains/scene.md")
    names = {*SCENE_KEYS, *KINDS, *itertools.chain(*(kind.keys for kind in KINDS.values())), *PREDICATE_ROLES}
    assert {name for name in names if f"`{name}" not in text and f"{name} =" not in text} == set()


def test_the_contract_names_every_predicate_that_is_defined_for_it() -> None:
    text = page("domains/contract.md")
    contract = (ROOT / "encodings" / "contract.lp").read_text(encoding="utf-8")
    names = set(re.findall(r"^#defined (\w+)/", contract, re.MULTILINE))
    assert {name for name in names if f"`{name}(" not in text} == set()


def test_the_options_name_every_rule() -> None:
    text = page("domains/options.md")
    assert {path.stem for path in (ROOT / "encodings" / "rules").glob("*.lp") if f"`{path.stem}" not in text} == set()


PACKAGES = (prag_asp, prag_asp.similarity, prag_asp.dataset, prag_asp.physics, prag_asp.rl, prag_asp.evaluation)


@pytest.mark.parametrize("package", PACKAGES, ids=lambda package: package.__name__)
def test_every_public_name_has_an_entry(package: ModuleType) -> None:
    name, public = package.__name__, package.__all__
    assert set(re.findall(rf"^::: {name}\.(\w+)$", page("reference/python.md"), re.MULTILINE)) == set(public)


def test_every_encoding_is_shown_in_full() -> None:
    text = "\n".join(generated("encodings").encoding_lines())
    assert "<!-- encodings -->" in page("reference/encodings.md")
    files = sorted((ROOT / "encodings").rglob("*.lp"))
    assert len(files) > 20
    for path in files:
        source = path.read_text(encoding="utf-8")
        assert f"### {path.relative_to(ROOT / 'encodings')} " in text
        assert len(re.findall(r"%\*!", source)) == source.count("*%")
        rules = re.sub(r"(?s)%\*!.*?\*%", "", source).splitlines()[1:]
        assert [line for line in rules if line.strip() and f"    {line}" not in text] == []
    assert "%*!" not in text


def test_every_option_of_every_command_is_listed() -> None:
    assert "<!-- commands -->" in page("reference/commands.md")
    reference = "\n".join(generated("commands").command_lines())
    context = click.Context(cli)
    names = cli.list_commands(context)
    assert {"count", "sample", "validate"} <= set(names)
    sections = dict(section.split("\n", 1) for section in reference.split("\n## ")[1:])
    for name in names:
        command = cli.get_command(context, name)
        assert command is not None
        options = [each for each in command.params if isinstance(each, click.Option)]
        assert [each.opts for each in options if f"{each.opts[-1]}" not in sections[name]] == []
    assert "\\[default: 10x10]" in sections["sample"]


def test_the_gallery_shows_every_domain() -> None:
    text = page("gallery.md")
    examples = {path.parent.name for path in (ROOT / "examples").glob("*/domain.lp")} - {"desk"}
    for name in {*shipped_domains(), *examples}:
        scene = "[scene]" in next(Path(ROOT).glob(f"*/{name}/domain.toml")).read_text(encoding="utf-8")
        assert f"\n## {name}\n" in text
        assert (f"](pictures/{name}.png)" in text) == scene


def test_every_page_stands_in_the_navigation() -> None:
    listed = set(re.findall(r": ([\w/]+\.md)$", (ROOT / "mkdocs.yml").read_text(encoding="utf-8"), re.MULTILINE))
    notebooks = {f"notebooks/{path.stem}.md" for path in (ROOT / "examples" / "notebooks").glob("*.ipynb")}
    assert listed == {str(path.relative_to(DOCS)) for path in DOCS.rglob("*.md")} | notebooks


def test_a_group_of_the_navigation_has_at_most_six_pages() -> None:
    groups = re.split(r"^ +- [^:\n]+:$", (ROOT / "mkdocs.yml").read_text(encoding="utf-8"), flags=re.MULTILINE)
    assert max(len(re.findall(r"\.md$", group, re.MULTILINE)) for group in groups) == 6


def test_the_overview_has_a_sentence_for_every_guide() -> None:
    sentences = re.findall(r"^\| \[[^]]+\]\((guides/\w+\.md)\) \| You [^|]+\. \|$", page("index.md"), re.MULTILINE)
    assert sorted(sentences) == sorted(str(path.relative_to(DOCS)) for path in DOCS.glob("guides/*.md"))


def test_contributing_tells_of_every_room() -> None:
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    told = set(re.findall(r"^\| `(\w+)/` \|", text, re.MULTILINE))
    assert told == {path.parent.name for path in (ROOT / "prag_asp").glob("*/__init__.py")}


def test_contributing_names_files_that_exist() -> None:
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    named = [Path(each) for each in re.findall(r"`([\w.]+/[\w./]*)`", text)]
    assert len(named) > 15
    told = [path.parent if path.stem == "NAME" else path for path in named if path.parts[0] not in {".venv", "site"}]
    assert [str(path) for path in told if not ((ROOT / path).exists() or (ROOT / "prag_asp" / path).exists())] == []


def test_the_page_of_json_lines_names_every_field() -> None:
    domain = load_domain(ROOT / "examples" / "dishes", constants={"capacity": 4})
    line = json.loads(write_line(next(feasible(TaskSpace(domain, 1), seed=1))))
    text = page("reference/json_lines.md")
    lines, _, _ = text.partition("\n## ")
    assert re.findall(r"^\| `(\w+)` \|", lines, re.MULTILINE) == list(line)
    assert {name for name in (*line["verdict"], *line["witness"]) if f"`{name}`" not in text} == set()

"""Problems of BDDL, read by the grammar that LIBERO publishes, say the same as their tasks."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from prag_asp import Atom, Dataset, QueryError
from prag_asp.dataset import export
from prag_asp.dataset.formats.bddl import problem
from prag_asp.dataset.formats.episode_source import EpisodeSource
from prag_asp.physics import yaw_of
from prag_asp.task import FrozenDict


def scanned(text: str) -> list[Any]:
    """Return a file as lists of words: small letters, and no comments."""
    stack: list[list[Any]] = [[]]
    for token in re.findall(r"[()]|[^\s()]+", re.sub(r";.*$", "", text, flags=re.MULTILINE).lower()):
        if token == "(":
            stack.append([])
        elif token == ")":
            stack[-2].append(stack.pop())
        else:
            stack[-1].append(token)
    ((define, *groups),) = stack[0]
    assert define == "define"
    return groups


def read(path: Path) -> dict[str, Any]:
    """Return the groups of a problem by their names, as LIBERO takes them apart."""
    groups = {group[0]: group[1:] for group in scanned(path.read_text(encoding="utf-8"))}
    assert groups[":domain"] == ["robosuite"]
    for name in (":objects", ":fixtures"):
        groups[name] = typed(groups[name])
    (goal,) = groups[":goal"]
    assert goal[0] == "and"
    groups[":goal"] = goal[1:]
    regions = {}
    for name, *attributes in groups[":regions"]:
        told = {each[0]: each[1] for each in attributes}
        (sides,), (turn,) = told[":ranges"], told[":yaw_rotation"]
        assert len(sides) == 4 and len(turn) == 2
        regions[name] = (told[":target"], [*map(float, sides)], float(turn[0]))
    groups[":regions"] = regions
    return groups


def typed(words: list[str]) -> dict[str, str]:
    """Return the classes of names in a list such as ``a b - block``, in which a class comes once."""
    found: dict[str, list[str]] = {}
    names: list[str] = []
    while words:
        if words[0] == "-":
            assert words[1] not in found
            found[words[1]], names, words = names, [], words[2:]
        else:
            names, words = [*names, words[0]], words[1:]
    assert not names
    return {name: kind for kind, names in found.items() for name in names}


def facts(groups: list[Any]) -> dict[str, bool]:
    """Return facts as our program writes them."""
    found = {}
    for group in groups:
        value = group[0] != "not"
        name, *arguments = group if value else group[1]
        told = [each.replace("[", "(").replace("]", ")") for each in arguments]
        found[f"{name}({','.join(told)})" if told else name] = value
    return found


def as_text(known: Any) -> dict[str, bool]:
    return {str(fluent): value for fluent, value in known.items()}


def test_each_task_has_a_file_with_its_facts_words_and_entities(filmed: Dataset, tmp_path: Path) -> None:
    folder = export(filmed, "bddl", tmp_path / "out")
    assert sorted(path.name for path in folder.glob("*.bddl")) == ["test-000000.bddl", "train-000000.bddl"]
    for number, entry in enumerate(filmed.entries()):
        told = read(folder / f"{entry.part}-{entry.number:06d}.bddl")
        assert facts(told[":init"]) == as_text(entry.task.initial)
        assert facts(told[":goal"]) == as_text(entry.task.goal) and entry.task.goal
        assert " ".join(told[":language"]) == entry.instruction["default"].lower()
        assert told["problem"] == ["prag_asp_tabletop"]
        entities = {**told[":objects"], **told[":fixtures"]}
        assert entities == {"table_1": "table", **entry.task.entities}
        assert {"panda", "table_1"} <= {*told[":fixtures"]} and "cube_1" not in told[":fixtures"]
        assert {*told[":obj_of_interest"]} <= {*told[":objects"]}
        first = filmed.witness(number).moments[0].poses
        assert {*told[":regions"]} == {f"{name}_init_region" for name in first}
        for name, pose in first.items():
            target, sides, yaw = told[":regions"][f"{name}_init_region"]
            assert target == "table_1" and sides == pytest.approx([*pose.position[:2]] * 2, abs=1e-5)
            assert yaw == pytest.approx(yaw_of(pose.quaternion), abs=1e-5)


def test_zones_are_regions_of_the_table(arms: Dataset, tmp_path: Path) -> None:
    told = read(export(arms, "bddl", tmp_path / "out") / "train-000000.bddl")
    scene = EpisodeSource(arms).scene
    for name in ("left_side", "middle", "right_side"):
        (x, y, _), (long, wide, _) = scene.fixed[name], scene.shapes[name].size
        target, sides, _ = told[":regions"][name]
        assert target == "table" and sides == pytest.approx([x - long / 2, y - wide / 2, x + long / 2, y + wide / 2])


def test_without_a_scene_terms_are_words_and_there_are_no_regions(told: Dataset, tmp_path: Path) -> None:
    folder = export(told, "bddl", tmp_path / "out", level="exact")
    for entry in told.entries():
        found = read(folder / f"train-{entry.number:06d}.bddl")
        assert "disc[1]" in found[":objects"] and not found[":regions"] and not found[":fixtures"]
        assert facts(found[":init"]) == as_text(entry.task.initial)
        assert facts(found[":goal"]) == as_text(entry.task.goal)


def test_words_that_would_be_expressions_are_written_without_parentheses(told: Dataset) -> None:
    entry = replace(told.entry(0), instruction={"plain": "move it (slowly); twice"})
    assert "  (:language move it [slowly], twice)\n" in problem(EpisodeSource(told), entry)


@pytest.mark.parametrize("name", ["cubeA", '"a b"', "a;b"])
def test_a_name_that_would_be_read_as_another_is_refused(told: Dataset, name: str) -> None:
    entry = told.entry(0)
    task = replace(entry.task, goal=FrozenDict({Atom("on", (name, "left")): True}))
    with pytest.raises(QueryError, match="BDDL has no name"):
        problem(EpisodeSource(told), replace(entry, task=task))

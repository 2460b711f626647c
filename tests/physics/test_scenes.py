"""Scenes made and answered by hand: see scenes/."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import Any

import pytest

from prag_asp.physics import Budget, check_witness, validate_task
from prag_asp.scene.scene import Scene
from prag_asp.scene.scene_loader import parse_scene
from prag_asp.task import Task
from tests.physics.scenarios import state, task
from tests.toml import tomllib

FOLDER = Path(__file__).parent / "scenes"


def read(name: str) -> dict[str, Any]:
    return tomllib.loads((FOLDER / f"{name}.toml").read_text(encoding="utf-8"))


BODIES = read("scene")
FEASIBLE: list[dict[str, Any]] = read("feasible")["scene"]
INFEASIBLE: list[dict[str, Any]] = read("infeasible")["scene"]


def scene_of(given: dict[str, Any]) -> Scene:
    shapes = {**BODIES["shapes"], **given.get("shapes", {})}
    own = {name: given.get(name, {}) for name in ("fixed", "materials", "own")}
    return parse_scene({**BODIES, **own, "shapes": shapes}, {}, {name: name for name in shapes}, folder=FOLDER)


def task_of(given: dict[str, Any]) -> Task:
    forgotten = tuple(fluent for step in given["steps"] for fluent in step.get("forgets", ()))
    steps = [(step["does"], state(*step["makes"])) for step in given["steps"]]
    return task(state(*given["initial"]), *steps, forget=forgotten)


def test_there_are_enough_scenes_of_each_kind() -> None:
    assert len(FEASIBLE) >= 66 and len(INFEASIBLE) >= 54
    names = [given["name"] for given in (*FEASIBLE, *INFEASIBLE)]
    assert len(set(names)) == len(names) and all(given["why"] for given in (*FEASIBLE, *INFEASIBLE))
    causes = Counter(given["cause"] for given in INFEASIBLE)
    assert len(causes) >= 10 and min(causes.values()) >= 3


@pytest.mark.parametrize("given", FEASIBLE, ids=lambda given: given["name"].replace(" ", "_"))
def test_what_can_be_done_is_done_and_stays_still(given: dict[str, Any]) -> None:
    scene, request = scene_of(given), task_of(given)
    verdict = validate_task(request, scene, seed=1, budget=Budget(10, 10, "settling"))
    assert (verdict.status, verdict.reason) == ("feasible", "")
    assert verdict.witness is not None and check_witness(request, verdict.witness, scene) == []


@pytest.mark.parametrize("given", INFEASIBLE, ids=lambda given: given["name"].replace(" ", "_"))
def test_what_cannot_be_done_is_never_found_and_proved_only_by_a_proof(given: dict[str, Any]) -> None:
    verdict = validate_task(task_of(given), scene_of(given), seed=1, budget=Budget(5, 10))
    assert verdict.status == ("infeasible" if given["proof"] else "not_found")
    assert given["proof"] in verdict.reason

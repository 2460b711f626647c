"""The task of a page before physics: the verdict, the film strip and the animation are those of the library."""

from __future__ import annotations

import shlex
from collections.abc import Iterator
from dataclasses import replace
from io import BytesIO
from pathlib import Path
from typing import Any

import pytest

from prag_asp import LimitReached, QueryError, TaskSpace, load_domain, load_scene
from prag_asp.errors import PhysicsMissingError, SceneError
from prag_asp.explore import physics_view
from prag_asp.explore.explored_domain import ExploredDomain
from prag_asp.explore.page_state import PageState
from prag_asp.explore.physics_view import TaskPhysics, calls_elsewhere
from prag_asp.explore.task_trial import trial_of
from prag_asp.explore.turns import CANCEL
from prag_asp.space.limits import Limits
from prag_asp.stop_reason import StopKind
from tests.commands import ok

TABLETOP = ExploredDomain(load_domain("tabletop"), ("tabletop",), "load_domain('tabletop')")
FIRST = PageState(1, chosen=("pick(panda,brick_1,bin_1)",))


@pytest.fixture(scope="module")
def physics() -> Iterator[TaskPhysics]:
    pytest.importorskip("pybullet")
    yield TaskPhysics(TABLETOP)


def test_the_verdict_and_its_python_and_command_agree(
    physics: TaskPhysics, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    trial = trial_of(TABLETOP, {"state": FIRST.query, "seed": "3"})
    view = physics.verdict(trial)
    assert (view.status, view.cause) == ("feasible", "")
    assert view.effort.endswith("; seed 3")
    found: dict[str, Any] = {}
    exec(view.same[0].python, found)  # the Python of this package's own page
    assert found["verdict"].status == view.status
    assert physics._verdicts.get(physics_view._key(trial), dict) == found["verdict"]
    monkeypatch.chdir(tmp_path)
    for line in view.same[0].shell.split(" && "):
        command, _, file = line.partition(" > ")
        printed = ok(*shlex.split(command)[1:])
        if file:
            Path(file).write_text(printed)
    assert printed == "1\tfeasible\n"


def test_a_feasible_task_has_a_strip_and_a_film_which_are_made_once(physics: TaskPhysics) -> None:
    pillow = pytest.importorskip("PIL.Image")
    trial = trial_of(TABLETOP, {"state": FIRST.query})
    strip, film = physics.strip(trial), physics.animation(trial)
    assert pillow.open(BytesIO(strip.content)).format == "PNG"
    assert film.kind in ("video/mp4", "image/webp") and film.content
    assert physics.strip(trial) is strip and physics.animation(trial) is film
    scene = physics.scene_file(trial)
    assert (scene.kind, scene.content[:4]) == ("model/gltf-binary", b"glTF")
    assert physics.scene_file(trial) is scene and len(physics._episodes._values) == 1


def test_a_task_that_is_not_feasible_has_a_cause_and_no_picture() -> None:
    pytest.importorskip("pybullet")
    state = PageState(1, chosen=("stack(a,b)",))
    explored = ExploredDomain(load_domain("blocks"), ("blocks",), "")
    with pytest.raises(SceneError, match="has no \\[scene\\]"):
        trial_of(explored, {"state": state.query})
    trial = trial_of(TABLETOP, {"state": FIRST.query})
    far = replace(trial, scene=_far_away(trial.scene))
    physics = TaskPhysics(TABLETOP)
    view = physics.verdict(far)
    assert view.status in ("infeasible", "not_found")
    assert view.cause
    assert [each.what for each in view.same] == ["the verdict"]
    with pytest.raises(QueryError, match="only feasible tasks"):
        physics.strip(far)


def _far_away(scene: Any) -> Any:
    """Return a scene whose robot stands 5 m away, so that it reaches nothing."""
    return replace(scene, robots={name: mount._replace(x=mount.x - 5.0) for name, mount in scene.robots.items()})


@pytest.mark.parametrize(
    ("fields", "problem"),
    [
        ({"state": "length=2&do=pick(panda,brick_1,bin_1)"}, "complete tasks"),
        ({"state": FIRST.query, "seed": "-1"}, "seed"),
        ({"state": FIRST.query, "budget": "0x1"}, "RESTARTSxSAMPLES"),
        ({"state": FIRST.query, "budget": "many"}, "RESTARTSxSAMPLES"),
        ({"state": FIRST.query, "tier": "magic"}, "tier of checks"),
        ({"state": f"{FIRST.query}&where=lacks+pick"}, "no task of tabletop"),
    ],
)
def test_what_is_no_trial_gets_one_line(fields: dict[str, str], problem: str) -> None:
    with pytest.raises(QueryError, match=problem) as error:
        trial_of(TABLETOP, fields)
    assert len(error.value.lines) == 1


def test_pages_of_plans_and_of_changed_domains_have_no_command_for_files() -> None:
    plans = trial_of(TABLETOP, {"state": replace(FIRST, by="plan").query})
    own = ExploredDomain(TABLETOP.domain, ("tabletop", "--flat"), "")
    tasks = trial_of(own, {"state": FIRST.query})
    for explored, trial in ((TABLETOP, plans), (own, tasks)):
        same = physics_view.same_by_physics(explored, trial, feasible=True)
        assert [each.shell for each in same] == [""] * 4
    other = trial_of(TABLETOP, {"state": FIRST.query, "budget": "20x5"})
    verdict, *pictures = physics_view.same_by_physics(TABLETOP, other, feasible=True)
    assert "--budget 20x5" in verdict.shell and [each.shell for each in pictures] == [""] * 3
    assert TaskSpace(TABLETOP.domain, 1).index(other.task) == other.rank
    assert load_scene(TABLETOP.domain) == other.scene


def test_without_pybullet_the_line_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    def missing(reason: str = "") -> None:
        raise PhysicsMissingError(f"{reason}, and physics needs PyBullet; install it")

    monkeypatch.setattr("prag_asp.explore.task_trial.require_physics", missing)
    with pytest.raises(PhysicsMissingError, match="install it"):
        TaskPhysics(TABLETOP).verdict(trial_of(TABLETOP, {"state": FIRST.query}))


def test_work_in_another_process_ends_with_its_page_and_after_a_time(monkeypatch: pytest.MonkeyPatch) -> None:
    stopped = ExploredDomain(TABLETOP.domain, ("tabletop",), "", limits=Limits(stop=lambda: CANCEL))
    trial = trial_of(TABLETOP, {"state": FIRST.query})
    with pytest.raises(LimitReached) as ended:
        TaskPhysics(stopped, calls_elsewhere(stopped)).verdict(trial)
    assert ended.value.reason == CANCEL
    monkeypatch.setattr(physics_view, "LONGEST", 0)
    with pytest.raises(LimitReached, match="choose a smaller budget") as late:
        TaskPhysics(TABLETOP, calls_elsewhere(TABLETOP)).verdict(trial)
    assert late.value.reason.kind is StopKind.TIME

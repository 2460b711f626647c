"""Pictures of witnesses and demonstrations: film strips with captions, and single states."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from prag_asp.errors import QueryError
from prag_asp.physics.checks.numbers import count_mismatch
from prag_asp.physics.demonstration.demonstration import Demonstration
from prag_asp.physics.filming.camera_rendering import moment_of
from prag_asp.physics.pictures.camera import picture, pillow
from prag_asp.physics.pictures.highlights import changed_entities, highlighted
from prag_asp.physics.pictures.picture_world import open_picture_world
from prag_asp.physics.pictures.sheet import Panel, sheet
from prag_asp.physics.predicates.predicate import words
from prag_asp.physics.symbolic_facts import Fact, facts
from prag_asp.physics.witness import Moment, Witness
from prag_asp.scene.scene import Scene
from prag_asp.task import Task
from prag_asp.wording import plural

if TYPE_CHECKING:
    from PIL import Image

START_FACTS = 4
"""The maximum number of facts in the caption of an initial state."""

SIDES = re.compile(r"\b(left|right|in front|behind)\b")


def film_strip(
    task: Task,
    shown: Witness | Demonstration,
    scene: Scene,
    *,
    frames: int | None = None,
    columns: int = 3,
    size: tuple[int, int] = (360, 320),
    headings: Sequence[str | None] | None = None,
    captions: Sequence[tuple[str, str]] | None = None,
    bystanders: bool = True,
) -> Image.Image:
    """Return a picture of all states of a witness or a demonstration, or of `frames` of them, including the two ends.

    They are arranged in rows of at most `columns`; `size` is the size of one picture in pixels. What an action has
    changed is outlined, and shown in a close-up if the robot hides it. Below each picture are the action and its
    positive effects in plain words, large enough to be legible at the width of a page. `headings` that are not None
    replace the words for the actions; `captions` replace all words with a heading and a text for each state. With
    `bystanders`, objects of the scene that the task does not name are also shown, where they hide and touch nothing.

    Raises:
        PicturesMissingError: Pillow is not installed.
        QueryError: there are fewer than two frames or no columns, or `shown` does not belong to the task.
    """
    if (frames is not None and frames < 2) or columns < 1:
        raise QueryError(f"a film strip needs at least 2 frames and 1 column; got {frames} and {columns}")
    moments = moments_of(task, shown)
    check_headings(task, headings)
    pillow()
    last = len(task.actions)
    chosen = range(last + 1) if frames is None else sorted({round(i * last / (frames - 1)) for i in range(frames)})
    pictures = []
    with open_picture_world(task, shown, moments, scene, size, bystanders=bystanders) as world:
        view = world.choose_view(chosen)
        for k in chosen:
            world.show(moments[k])
            changed = changed_entities(task, moments, world.scene, k)
            pictures.append(highlighted(world.studio, moments[k], world.scene, changed, size, view))
    if captions is not None and len(captions) != last + 1:
        raise QueryError(f"{plural(len(captions), 'caption')} for {plural(last + 1, 'state')}; give one for each")
    texts = make_captions(task, scene, chosen, headings, captions)
    return sheet([Panel(image, *text) for image, text in zip(pictures, texts, strict=True)], columns)


def still(
    task: Task,
    shown: Witness | Demonstration,
    scene: Scene,
    state: int,
    *,
    size: tuple[int, int] = (960, 800),
    bystanders: bool = True,
) -> Image.Image:
    """Return a picture of one state (0 is the initial state) without a caption; `size` is in pixels.

    With `bystanders`, objects that the task does not name are also shown, in the same places in each state.

    Raises:
        PicturesMissingError: Pillow is not installed.
        QueryError: the task has no such state, or `shown` does not belong to the task.
    """
    moments = moments_of(task, shown)
    if not 0 <= state < len(moments):
        raise QueryError(f"state {state}: the states of the task are 0 to {len(moments) - 1}")
    pillow()
    with open_picture_world(task, shown, moments, scene, size, bystanders=bystanders) as world:
        view = world.choose_view((state,))
        world.show(moments[state])
        return picture(world.studio, size, view)


def moments_of(task: Task, shown: Witness | Demonstration) -> Sequence[Moment]:
    """Return the moments in a witness or a demonstration that belong to the states of a task."""
    if isinstance(shown, Witness):
        unfit = count_mismatch(shown, len(task.actions))
        if unfit is not None:
            raise QueryError(unfit)
        return shown.moments
    moments = tuple(moment_of(shown, frame) for frame in shown.ends.tolist())
    if len(moments) != len(task.actions) + 1:
        raise QueryError(f"the demonstration has {plural(len(moments), 'state')}, the task {_actions(task)}")
    return moments


def _actions(task: Task) -> str:
    """Return a phrase that states the number of actions in a task."""
    return plural(len(task.actions), "action")


def check_headings(task: Task, headings: Sequence[str | None] | None) -> None:
    """Check that there is a heading for each action."""
    if headings is not None and len(headings) != len(task.actions):
        raise QueryError(f"{plural(len(headings), 'heading')} for {_actions(task)}; give one for each")


def caption(task: Task, scene: Scene, k: int, headings: Sequence[str | None] | None) -> tuple[str, str]:
    """Return the heading and the text of a state in plain words."""
    if k == 0:
        named = {argument for action in task.actions for argument in action.arguments}
        true_facts = [fact for fact in facts(scene, task.initial) if fact.value]
        bodies = {name for name in named if name in scene.shapes and scene.shapes[name].traits.body}
        handled = [fact for fact in true_facts if not bodies.isdisjoint(fact.arguments)]
        return "start", _fact_words(handled or true_facts, START_FACTS)
    effects = [fact for fact in facts(scene, task.subgoals[k - 1]) if fact.value]
    undone = [fact for fact in facts(scene, task.subgoals[k - 1]) if not fact.value]
    heading = headings[k - 1] if headings is not None else None
    if not heading:
        action = task.actions[k - 1]
        unnamed = () if scene.shared else scene.robots
        heading = " ".join(words(part) for part in (action.name, *action.arguments) if part not in unnamed)
    return f"{k}. {heading}", _fact_words(effects or undone[:1])


def make_captions(
    task: Task,
    scene: Scene,
    chosen: Iterable[int],
    headings: Sequence[str | None] | None,
    captions: Sequence[tuple[str, str]] | None = None,
) -> list[tuple[str, str]]:
    """Return the heading and text of each state; if left and right are the robot's, the first text says so."""
    texts = [captions[k] if captions is not None else caption(task, scene, k, headings) for k in chosen]
    if scene.frame == "viewer" or not any(SIDES.search(text) for pair in texts for text in pair):
        return texts
    heading, text = texts[0]
    who = "robots see" if scene.shared else "robot sees"
    return [(heading, f"{text} (sides are as the {who} them)".lstrip()), *texts[1:]]


def _fact_words(candidates: Sequence[Fact], most: int = 2) -> str:
    """Return the facts that come first in captions, in words; facts of user-defined predicates precede all others."""
    worth = (fact for fact in candidates if fact.predicate.caption_rank < math.inf)
    ranked = sorted(worth, key=lambda fact: fact.predicate.caption_rank)
    return ", ".join(fact.sentence() for fact in ranked[:most] or candidates[:1])

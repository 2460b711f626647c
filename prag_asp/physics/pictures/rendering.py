"""Draw witnesses and demonstrations: film strips of the states with captions, single states, and animations."""

from __future__ import annotations

import math
import re
from bisect import bisect_left
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from prag_asp.atom import Atom
from prag_asp.errors import QueryError, SceneError
from prag_asp.physics.checks.numbers import LIMIT_TOLERANCE, broken_numbers, count_mismatch
from prag_asp.physics.demonstration.demonstration import FRAMES_A_SECOND, Demonstration
from prag_asp.physics.filming.film import moment_of
from prag_asp.physics.pictures.camera import picture, pillow
from prag_asp.physics.pictures.saving import save_picture
from prag_asp.physics.pictures.sheet import Panel, line_count, sheet
from prag_asp.physics.pictures.views import best_view
from prag_asp.physics.predicates.predicate import words
from prag_asp.physics.symbolic_facts import Fact, facts, physical_task
from prag_asp.physics.witness import Moment, Witness
from prag_asp.physics.world.simulator import Simulator, open_simulator
from prag_asp.scene.scene import Scene
from prag_asp.task import Task
from prag_asp.wording import plural

if TYPE_CHECKING:
    from PIL import Image

RATE = 10
"""Frames of an animation a second."""

LAST_PAUSE = 1500
"""Milliseconds for which an animation stops at its end."""

GIVE = 0.005
"""How far a joint or a finger that was measured may be pressed beyond its limit, in radians and metres."""

START_FACTS = 4
"""How many facts of an initial state are told, of what the task's actions name."""

SIDES = re.compile(r"\b(left|right|in front|behind)\b")


def film_strip(
    task: Task,
    shown: Witness | Demonstration,
    scene: Scene,
    *,
    frames: int | None = None,
    columns: int = 6,
    size: tuple[int, int] = (360, 320),
    headings: Sequence[str | None] | None = None,
    told: Sequence[tuple[str, str]] | None = None,
) -> Image.Image:
    """Return a picture of the states of a witness or a demonstration, or of `frames` of them with first and last.

    They stand side by side, at most `columns` in a row; `size` is that of one frame in pixels. Under each stand the
    action and what it made true, in plain words; `headings` replace the words for the actions,
    except for those that are None, and `told` all words: a heading and a caption for each state.

    Raises:
        PicturesMissingError: Pillow is not installed.
        QueryError: less than two frames or no columns are asked for, or what is shown does not belong to the task.
    """
    if (frames is not None and frames < 2) or columns < 1:
        raise QueryError(f"a film strip needs at least 2 frames and 1 column; got {frames} and {columns}")
    moments = _moments(task, shown)
    _check_headings(task, headings)
    pillow()
    last = len(task.actions)
    chosen = range(last + 1) if frames is None else sorted({round(i * last / (frames - 1)) for i in range(frames)})
    with _simulator(task, shown, moments, scene) as simulator:
        view = best_view(task, moments, simulator.scene, size, chosen)
        pictures = [picture(simulator, moments[k], size, view) for k in chosen]
    if told is not None and len(told) != last + 1:
        raise QueryError(f"{plural(len(told), 'caption')} for {plural(last + 1, 'state')}; give one for each")
    captions = make_captions(task, scene, chosen, headings, told)
    return sheet([Panel(image, *caption) for image, caption in zip(pictures, captions, strict=True)], columns)


def still(
    task: Task, shown: Witness | Demonstration, scene: Scene, state: int, *, size: tuple[int, int] = (960, 800)
) -> Image.Image:
    """Return a picture of one state, 0 for the initial one, without words; `size` in pixels.

    Raises:
        PicturesMissingError: Pillow is not installed.
        QueryError: the task has no such state, or what is shown does not belong to the task.
    """
    moments = _moments(task, shown)
    if not 0 <= state < len(moments):
        raise QueryError(f"state {state}: the states of the task are 0 to {len(moments) - 1}")
    pillow()
    with _simulator(task, shown, moments, scene) as simulator:
        view = best_view(task, moments, simulator.scene, size, (state,))
        return picture(simulator, moments[state], size, view)


def animate(
    task: Task,
    demonstration: Demonstration,
    scene: Scene,
    path: Path,
    *,
    size: tuple[int, int] = (400, 350),
    speed: float = 2.0,
    headings: Sequence[str | None] | None = None,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> None:
    """Write an animation of a demonstration, `speed` times as fast: a .gif or .webp, by the name of the file.

    It shows `RATE` frames a second in `size` pixels, and under each the action that is performed. `progress` is told
    how many frames of how many are drawn.

    Raises:
        PicturesMissingError: Pillow is not installed.
        QueryError: the file is neither .gif nor .webp, the speed is not positive, or the demonstration does not
            belong to the task.
        OutputError: the file cannot be written.
    """
    if path.suffix.lower() not in (".gif", ".webp"):
        raise QueryError(f"{path}: an animation is a .gif or a .webp")
    if not 0.0 < speed < math.inf:
        raise QueryError(f"the speed of an animation is a positive number; got {speed}")
    moments = _moments(task, demonstration)
    _check_headings(task, headings)
    pillow()
    every = max(1, round(speed * FRAMES_A_SECOND / RATE))
    frames = [*range(0, len(demonstration.times) - 1, every), len(demonstration.times) - 1]
    panels = []
    with _simulator(task, demonstration, moments, scene) as simulator:
        view = best_view(task, moments, simulator.scene, size)
        for frame in frames:
            k = min(bisect_left(demonstration.ends.tolist(), frame), len(task.actions))
            shown = picture(simulator, moment_of(demonstration, frame), size, view)
            panels.append(Panel(shown, _caption(task, scene, k, headings)[0]))
            progress(len(panels), len(frames))
    pictures = [sheet([panel], 1, lines=line_count(panels)) for panel in panels]
    times = demonstration.times[frames] * 1000 / speed
    pauses = [*(int(pause) for pause in np.round(np.diff(times))), LAST_PAUSE]
    save_picture(pictures[0], path, save_all=True, append_images=pictures[1:], duration=pauses, loop=0)


def _moments(task: Task, shown: Witness | Demonstration) -> Sequence[Moment]:
    """Return the states of a task as a witness or a demonstration has them.

    Raises:
        QueryError: they are not as many as the task has.
    """
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
    """Return how many actions a task has, in words."""
    return plural(len(task.actions), "action")


@contextmanager
def _simulator(
    task: Task, shown: Witness | Demonstration, moments: Sequence[Moment], scene: Scene
) -> Iterator[Simulator]:
    """Open a simulator in which all the moments of what is shown can be drawn.

    Raises:
        QueryError: the scene does not allow the size of an object, or a moment lacks an object or an arm of the task,
            has another, or numbers that cannot be.
    """
    try:
        sized = scene.with_sizes(shown.sizes) if isinstance(shown, Witness) else shown.sized_scene(scene)
    except SceneError as error:
        raise QueryError(str(error)) from None
    with open_simulator(sized, visual=True) as simulator:
        physical = physical_task(task, sized)
        tolerance = LIMIT_TOLERANCE if isinstance(shown, Witness) else GIVE
        for k, moment in enumerate(moments):
            for fault in broken_numbers(moment, physical, simulator, tolerance):
                raise QueryError(f"state {k}: {fault}")
        yield simulator


def _check_headings(task: Task, headings: Sequence[str | None] | None) -> None:
    """Check that there is a heading for each action.

    Raises:
        QueryError: there is not.
    """
    if headings is not None and len(headings) != len(task.actions):
        raise QueryError(f"{plural(len(headings), 'heading')} for {_actions(task)}; give one for each")


def _caption(task: Task, scene: Scene, k: int, headings: Sequence[str | None] | None) -> tuple[str, str]:
    """Return the heading of a frame and what it shows, in plain words."""
    if k == 0:
        named = {argument for action in task.actions for argument in action.arguments}
        known = [fact for fact in facts(scene, task.initial) if fact.value]
        handled = [fact for fact in known if not named.isdisjoint(_things(fact, scene))]
        return "start", _told(handled or known, START_FACTS)
    made = [fact for fact in facts(scene, task.subgoals[k - 1]) if fact.value]
    undone = [fact for fact in facts(scene, task.subgoals[k - 1]) if not fact.value]
    heading = (headings[k - 1] if headings is not None else None) or _action_words(task.actions[k - 1], scene)
    return f"{k}. {heading}", _told(made or undone[:1])


def _things(fact: Fact, scene: Scene) -> set[str]:
    """Return the objects that a fact speaks of."""
    return {argument for argument in fact.arguments if argument in scene.shapes and scene.shapes[argument].traits.body}


def make_captions(
    task: Task,
    scene: Scene,
    chosen: Iterable[int],
    headings: Sequence[str | None] | None,
    told: Sequence[tuple[str, str]] | None = None,
) -> list[tuple[str, str]]:
    """Return heading and caption of some states; the first says whose sides are meant, where they are the robot's."""
    captions = [told[k] if told is not None else _caption(task, scene, k, headings) for k in chosen]
    if scene.frame == "viewer" or not any(SIDES.search(text) for caption in captions for text in caption):
        return captions
    heading, text = captions[0]
    who = "robots see" if scene.shared else "robot sees"
    return [(heading, f"{text} (sides are as the {who} them)".lstrip()), *captions[1:]]


def _action_words(action: Atom, scene: Scene) -> str:
    """Return an action in plain words: its name and its arguments but a single robot."""
    untold = () if scene.shared else scene.robots
    return " ".join(words(part) for part in (action.name, *action.arguments) if part not in untold)


def _told(made: Sequence[Fact], most: int = 2) -> str:
    """Return what is most worth telling of some facts; relations of the domain's own come first."""
    worth = (fact for fact in made if fact.predicate.caption_rank < math.inf)
    known = sorted(worth, key=lambda fact: fact.predicate.caption_rank)
    told = known[:most] or list(made[:1])
    return ", ".join(fact.sentence() for fact in told)

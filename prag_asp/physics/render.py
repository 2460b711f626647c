"""Draw witnesses and demonstrations: film strips of the states with captions, and animations."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from prag_asp.domain.atom import Atom
from prag_asp.domain.scene import Scene
from prag_asp.errors import OutputError, PragError, QueryError
from prag_asp.physics.bullet import pybullet
from prag_asp.physics.demonstration import Demonstration, pose_of
from prag_asp.physics.facts import Fact, facts
from prag_asp.physics.predicates.predicate import words
from prag_asp.physics.simulator import Simulator, open_simulator
from prag_asp.physics.verdict import Moment, Witness
from prag_asp.space.task import Task

if TYPE_CHECKING:
    from PIL import Image

EYE, TARGET, FIELD_OF_VIEW = (1.38, 0.52, 0.94), (0.34, 0.0, 0.27), 45.0
LIGHT, LIGHT_DISTANCE = (-0.3, 0.8, 1.8), 3.0
SKY, GROUND = (247, 249, 252), (214, 221, 230)
INK, QUIET, PAPER = (33, 37, 41), (108, 117, 125), (255, 255, 255)
OVERSAMPLING = 2
MARGIN, GUTTER = 14, 12
LAST_PAUSE = 1500
"""Milliseconds for which an animation stops at its end."""
TOLD_FIRST = (
    "holding",
    "on_top",
    "inside",
    "located",
    "rotated",
    "left_of",
    "right_of",
    "in_front_of",
    "behind",
    "is_open",
    "is_closed",
    "at",
)


class PicturesMissingError(PragError):
    """Pictures need Pillow, which is not installed."""


def film_strip(
    task: Task,
    shown: Witness | Demonstration,
    scene: Scene,
    *,
    frames: int = 5,
    size: tuple[int, int] = (360, 320),
    headings: Sequence[str] | None = None,
) -> Image.Image:
    """Return a picture of at most `frames` states of a witness or a demonstration, the first and the last included.

    They stand side by side; `size` is that of one frame in pixels. Under each stand the action and what it made
    true, in plain words; `headings` replace the words for the actions.

    Raises:
        PicturesMissingError: Pillow is not installed.
        QueryError: less than two frames are asked for, or what is shown belongs to another task.
        SceneError: the scene does not allow the size of an object.
    """
    if frames < 2:
        raise QueryError(f"a film strip needs at least 2 frames; got {frames}")
    moments = _moments(task, shown)
    _check_headings(task, headings)
    _pillow()
    chosen = sorted({round(i * len(task.actions) / (frames - 1)) for i in range(frames)})
    with open_simulator(_sized(shown, scene), visual=True) as simulator:
        pictures = [picture(simulator, moments[k], size) for k in chosen]
    captions = [_caption(task, scene, k, headings) for k in chosen]
    return _strip(pictures, captions, size)


def animate(
    task: Task,
    demonstration: Demonstration,
    scene: Scene,
    path: Path,
    *,
    size: tuple[int, int] = (480, 420),
    every: int = 2,
    headings: Sequence[str] | None = None,
) -> None:
    """Write an animation of a demonstration, as long as it took: a .gif or .webp, by the name of the file.

    It shows each `every`-th frame in `size` pixels, and under it the action that is performed.

    Raises:
        PicturesMissingError: Pillow is not installed.
        QueryError: the file is neither .gif nor .webp, `every` is not positive, or the demonstration belongs to
            another task.
        OutputError: the file cannot be written.
    """
    if path.suffix not in (".gif", ".webp") or every < 1:
        raise QueryError(f"an animation is a .gif or a .webp of every n-th frame; got {path} and {every}")
    _moments(task, demonstration)
    _check_headings(task, headings)
    _pillow()
    frames = [*range(0, len(demonstration.times) - 1, every), len(demonstration.times) - 1]
    pictures = []
    with open_simulator(demonstration.sized(scene), visual=True) as simulator:
        for frame in frames:
            k = min(bisect_left(demonstration.ends.tolist(), frame), len(task.actions))
            shown = picture(simulator, _moment(demonstration, frame), size)
            pictures.append(_strip([shown], [(_caption(task, scene, k, headings)[0], "")], size))
    times = demonstration.times[frames] * 1000
    pauses = [*(int(pause) for pause in np.round(np.diff(times))), LAST_PAUSE]
    try:
        pictures[0].save(path, save_all=True, append_images=pictures[1:], duration=pauses, loop=0)
    except OSError as error:
        raise OutputError(f"{path}: the animation cannot be written: {error}") from error


def _moments(task: Task, shown: Witness | Demonstration) -> Sequence[Moment]:
    """Return the states of a task as a witness or a demonstration has them.

    Raises:
        QueryError: they are not as many as the task has.
    """
    if isinstance(shown, Witness):
        moments, what = shown.moments, "witness"
    else:
        moments, what = tuple(_moment(shown, frame) for frame in shown.ends.tolist()), "demonstration"
    if len(moments) != len(task.actions) + 1:
        raise QueryError(f"the {what} has {len(moments)} states, the task {len(task.actions)} actions")
    return moments


def _sized(shown: Witness | Demonstration, scene: Scene) -> Scene:
    """Return a scene with the sizes of what is shown."""
    return scene.with_sizes(shown.sizes) if isinstance(shown, Witness) else shown.sized(scene)


def _moment(demonstration: Demonstration, frame: int) -> Moment:
    """Return what a frame of a demonstration shows."""
    poses = dict(zip(demonstration.objects, map(pose_of, demonstration.poses[frame].tolist()), strict=True))
    joints, width = tuple(demonstration.joints[frame].tolist()), float(demonstration.widths[frame])
    return Moment(poses, joints, width, openings=demonstration.opened(frame))


def _check_headings(task: Task, headings: Sequence[str] | None) -> None:
    """Check that there is a heading for each action.

    Raises:
        QueryError: there is not.
    """
    if headings is not None and len(headings) != len(task.actions):
        raise QueryError(f"{len(headings)} headings are given for {len(task.actions)} actions")


def picture(simulator: Simulator, moment: Moment, size: tuple[int, int]) -> Image.Image:
    """Return one state as a picture of `size` pixels; the simulator must have been opened with `visual`."""
    image_type = _pillow()
    simulator.place(moment.poses, moment.openings)
    simulator.pose_arm(moment.joints, moment.width)
    pixels = _render(simulator, (size[0] * OVERSAMPLING, size[1] * OVERSAMPLING))
    image: Image.Image = image_type.fromarray(pixels).resize(size, image_type.Resampling.LANCZOS)
    return image


def _pillow() -> Any:
    """Return Pillow's module of images.

    Raises:
        PicturesMissingError: it is not installed.
    """
    try:
        from PIL import Image  # noqa: PLC0415 - pictures are optional
    except ImportError as error:
        raise PicturesMissingError('pictures need Pillow: pip install "prag_asp[pictures]"') from error
    return Image


def _render(simulator: Simulator, size: tuple[int, int]) -> NDArray[np.uint8]:
    """Return what the camera sees before a gradient, shape (height, width, 3)."""
    width, height = size
    view = pybullet.computeViewMatrix(EYE, TARGET, (0.0, 0.0, 1.0))
    projection = pybullet.computeProjectionMatrixFOV(FIELD_OF_VIEW, width / height, 0.1, 5.0)
    result = pybullet.getCameraImage(
        width,
        height,
        view,
        projection,
        lightDirection=LIGHT,
        lightAmbientCoeff=0.62,
        lightDiffuseCoeff=0.42,
        lightSpecularCoeff=0.12,
        lightDistance=LIGHT_DISTANCE,
        shadow=True,
        renderer=pybullet.ER_TINY_RENDERER,
        physicsClientId=simulator.client,
    )
    # A PyBullet that was built without NumPy returns flat tuples.
    colors: NDArray[np.uint8] = np.asarray(result[2], dtype=np.uint8).reshape(height, width, 4)[:, :, :3].copy()
    nothing = np.asarray(result[4], dtype=np.int64).reshape(height, width) < 0
    share = np.linspace(0.0, 1.0, height)[:, None]
    rows = np.asarray(SKY) * (1 - share) + np.asarray(GROUND) * share
    gradient = np.broadcast_to(rows[:, None, :], (height, width, 3)).astype(np.uint8)
    colors[nothing] = gradient[nothing]
    return colors


def _caption(task: Task, scene: Scene, k: int, headings: Sequence[str] | None) -> tuple[str, str]:
    """Return the heading of a frame and what it shows, in plain words."""
    if k == 0:
        return "start", _told([fact for fact in facts(scene, task.initial) if fact.value])
    made = [fact for fact in facts(scene, task.subgoals[k - 1]) if fact.value]
    undone = [fact for fact in facts(scene, task.subgoals[k - 1]) if not fact.value]
    heading = headings[k - 1] if headings is not None else _action_words(task.actions[k - 1], scene)
    return f"{k}. {heading}", _told(made or undone[:1])


def _action_words(action: Atom, scene: Scene) -> str:
    """Return an action in plain words: its name and its arguments but the robot."""
    robots = {entity for entity, shape in scene.shapes.items() if shape.kind == "robot"}
    return " ".join(words(part) for part in (action.name, *action.arguments) if part not in robots)


def _told(made: Sequence[Fact]) -> str:
    """Return what is most worth telling of some facts."""
    order = {name: position for position, name in enumerate(TOLD_FIRST)}
    known = sorted((fact for fact in made if fact.predicate.name in order), key=lambda f: order[f.predicate.name])
    told = known[:2] or list(made[:1])
    return ", ".join(fact.sentence() for fact in told)


def _strip(pictures: Sequence[Image.Image], captions: Sequence[tuple[str, str]], size: tuple[int, int]) -> Image.Image:
    """Return pictures side by side, each above its caption."""
    from PIL import ImageDraw, ImageFont  # noqa: PLC0415 - pictures are optional

    width, height = size
    large, small = ImageFont.load_default(size=17), ImageFont.load_default(size=14)
    wrapped = [_wrap(text, small, width) for _, text in captions]
    room = 34 + 19 * max(len(lines) for lines in wrapped)
    total = (len(pictures) * (width + GUTTER) - GUTTER + 2 * MARGIN, height + room + 2 * MARGIN)
    strip: Image.Image = _pillow().new("RGB", total, PAPER)
    pen = ImageDraw.Draw(strip)
    for i, (image, (heading, _), lines) in enumerate(zip(pictures, captions, wrapped, strict=True)):
        x = MARGIN + i * (width + GUTTER)
        strip.paste(image, (x, MARGIN))
        pen.text((x + 2, MARGIN + height + 8), heading, font=large, fill=INK)
        for row, line in enumerate(lines):
            pen.text((x + 2, MARGIN + height + 34 + 19 * row), line, font=small, fill=QUIET)
    return strip


def _wrap(text: str, font: Any, width: int) -> list[str]:
    """Return a text in lines that fit a width in pixels."""
    lines: list[str] = []
    for word in text.split():
        longer = f"{lines[-1]} {word}" if lines else word
        if lines and font.getlength(longer) <= width:
            lines[-1] = longer
        else:
            lines.append(word)
    return lines

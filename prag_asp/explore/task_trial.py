"""A task on a page for physics to judge, and the work on it, which another process can do."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryDirectory

from prag_asp.dataset.jsonl import Record
from prag_asp.dataset.language import instruction_writer_of
from prag_asp.dataset.scenes import scene_of
from prag_asp.dataset.task_origin import index_of
from prag_asp.errors import PicturesMissingError, QueryError
from prag_asp.explore.explored_domain import ExploredDomain
from prag_asp.explore.page_state import PageState, parse_query
from prag_asp.physics import require_physics
from prag_asp.physics.demonstration.demonstration import Demonstration
from prag_asp.physics.verdict import TIERS, Budget, Tier, Verdict
from prag_asp.scene.scene import Scene
from prag_asp.task import Task
from prag_asp.wording import unknown

LARGEST_SEED = 2**63 - 1


@dataclass(frozen=True)
class Trial:
    """A task in its scene, with the seed, the index and the budget of the search for a witness.

    `captions` holds a heading and a text for the picture of each state. `state` is the page that shows the task, and
    `rank` is the rank of the task, or None on a page of plans.
    """

    state: PageState
    rank: int | None
    task: Task
    scene: Scene
    seed: int
    index: int
    budget: Budget
    captions: tuple[tuple[str, str], ...]

    @property
    def headings(self) -> list[str]:
        """The description of each action."""
        return [heading.partition(". ")[2] for heading, _ in self.captions[1:]]


def trial_of(explored: ExploredDomain, fields: Mapping[str, str]) -> Trial:
    """Return the trial that a request specifies in the fields `state`, `seed`, `budget` and `tier`.

    Raises:
        PragError: a field is wrong, the page shows no whole task, or the domain has no scene.
    """
    state, seed = parse_query(fields.get("state", "")), read_seed(fields)
    budget, tier = Budget.parse(fields.get("budget", "10x10")), fields.get("tier", Tier.KINEMATICS)
    if tier not in TIERS:
        raise QueryError(unknown(tier, TIERS, "tier of checks"))
    budget = replace(budget, tier=Tier(tier))
    state = replace(state, chosen=explored.chosen(state))
    if len(state.chosen) < state.length:
        raise QueryError("physics validates only complete tasks; choose the other actions first")
    scene, space = scene_of(explored.domain), explored.space_of(state)
    task = next(space.tasks_of_plans([state.chosen]))
    rank = space.index(task) if state.by == "task" else None
    captions = tuple(instruction_writer_of(explored.domain).captions(task))
    return Trial(state, rank, task, scene, seed, index_of(Record(task)), budget, captions)


def read_seed(fields: Mapping[str, str]) -> int:
    """Return the seed in a request.

    Raises:
        QueryError: the seed is not a whole number, or is too large.
    """
    text = fields.get("seed", "0").strip()
    if not (text.isascii() and text.isdigit() and len(text) < 20 and int(text) <= LARGEST_SEED):
        raise QueryError(f"seed {text[:30]!r}: write a whole number from 0 to {LARGEST_SEED}")
    return int(text)


def judge(trial: Trial) -> Verdict:
    """Return the verdict on a task.

    Raises:
        PhysicsMissingError: PyBullet is not installed; the message says what to install.
    """
    require_physics("the verdict on a task takes a simulation")
    from prag_asp.physics import validate_task  # noqa: PLC0415 - needs PyBullet

    return validate_task(trial.task, trial.scene, seed=trial.seed, index=trial.index, budget=trial.budget)


def draw_strip(trial: Trial, verdict: Verdict) -> bytes:
    """Return the film strip of a feasible task as PNG.

    Raises:
        PicturesMissingError: Pillow is not installed; the message says what to install.
    """
    from prag_asp.physics import film_strip  # noqa: PLC0415 - needs PyBullet

    assert verdict.witness is not None
    buffer = BytesIO()
    image = film_strip(trial.task, verdict.witness, trial.scene, captions=trial.captions)
    image.save(buffer, "PNG", optimize=True)
    return buffer.getvalue()


def execute(trial: Trial, verdict: Verdict) -> Demonstration:
    """Return the episode of the robot executing a feasible task.

    Raises:
        QueryError: the robot fails to execute it.
    """
    from prag_asp.physics import demonstrate  # noqa: PLC0415 - needs PyBullet

    assert verdict.witness is not None
    shown = verdict.demonstration or demonstrate(trial.task, verdict.witness, trial.scene)
    if not shown.success:
        raise QueryError(f"the robot fails to execute it: {shown.detail}; another seed gives another witness")
    return shown


def make_scene_file(trial: Trial, shown: Demonstration) -> bytes:
    """Return the 3D scene of an episode as a .glb file.

    Raises:
        PicturesMissingError: Pillow is not installed; the message says what to install.
    """
    from prag_asp.physics import episode_glb  # noqa: PLC0415 - needs PyBullet

    return episode_glb(trial.task, shown, trial.scene, headings=trial.headings)


def draw_film(trial: Trial, shown: Demonstration) -> tuple[str, bytes]:
    """Return the media type and the animation of an episode: MP4, or WebP without PyAV.

    Raises:
        PicturesMissingError: Pillow is not installed; the message says what to install.
    """
    from prag_asp.physics import animate  # noqa: PLC0415 - needs PyBullet

    headings = trial.headings
    with TemporaryDirectory() as folder:
        path = Path(folder) / "task.mp4"
        try:
            animate(trial.task, shown, trial.scene, path, headings=headings)
            return "video/mp4", path.read_bytes()
        except PicturesMissingError:
            path = path.with_suffix(".webp")
            animate(trial.task, shown, trial.scene, path, headings=headings)
            return "image/webp", path.read_bytes()

"""Physics for the task on a page: its verdict in words, its film strip, and the robot executing it in 3D."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from prag_asp.errors import LimitReached, QueryError
from prag_asp.explore.explored_domain import Cache, ExploredDomain
from prag_asp.explore.page_server import Picture
from prag_asp.explore.same_result import SameResult, python_space, shell_line
from prag_asp.explore.task_trial import Trial, draw_film, draw_strip, execute, judge, make_scene_file
from prag_asp.physics.demonstration.demonstration import Demonstration
from prag_asp.physics.verdict import Budget, Verdict
from prag_asp.processes.bounded_call import bounded
from prag_asp.stop_reason import StopKind
from prag_asp.wording import plural

LONGEST = 120
"""The time limit of physics for the task on a page, in seconds; almost all example tasks take less than 10 s."""

VERDICTS, EPISODES, PICTURES = 64, 12, 12
"""The numbers of verdicts, episodes and pictures that are cached; a picture takes 0.3 MB, a video or 3D scene up to 3
MB."""

Call = Callable[..., Any]
"""A function that calls a given function with arguments, in this process or in another one."""


@dataclass(frozen=True)
class TaskVerdict:
    """A verdict in plain values: its status (``feasible``, ``not_found`` or ``infeasible``), and the status in words.

    `cause` is the proof, or the most common cause of failed attempts. `nearest` says how close the best attempts came.
    Both are empty for a feasible task. `causes` counts the failed attempts. `effort` states the budget and the seed.
    """

    status: str
    words: str
    cause: str
    nearest: str
    causes: tuple[tuple[str, int], ...]
    effort: str
    same: tuple[SameResult, ...]


def call_here(function: Callable[..., Any], *arguments: Any) -> Any:
    """Call a function in this process."""
    return function(*arguments)


def calls_elsewhere(explored: ExploredDomain) -> Call:
    """Return a `Call` in another process, which ends after `LONGEST` seconds or when the page no longer needs it."""

    def call(function: Callable[..., Any], *arguments: Any) -> Any:
        limits = explored.limits
        try:
            return bounded(function, *arguments, seconds=LONGEST, memory_bytes=limits.memory_bytes, stop=limits.stop)
        except LimitReached as error:
            if error.reason.kind is not StopKind.TIME:
                raise
            told = f"physics takes longer than {LONGEST} s; choose a smaller budget, or run the command on this page"
            raise LimitReached(told, 0, error.reason) from None

    return call


@dataclass
class TaskPhysics:
    """The verdicts on a domain's tasks, their episodes and pictures, each computed by `call` only once while cached."""

    explored: ExploredDomain
    call: Call = call_here
    _verdicts: Cache = field(default_factory=lambda: Cache(VERDICTS))
    _episodes: Cache = field(default_factory=lambda: Cache(EPISODES))
    _pictures: Cache = field(default_factory=lambda: Cache(PICTURES))

    def verdict(self, trial: Trial) -> TaskVerdict:
        """Return the verdict on a task in plain values.

        Raises:
            PhysicsMissingError: PyBullet is not installed; the message says what to install.
            PragError: the scene does not fit the task, or a limit was reached.
        """
        return task_verdict(self.explored, trial, self._verdict(trial))

    def strip(self, trial: Trial) -> Picture:
        """Return the film strip of a feasible task.

        Raises:
            PragError: the task is not known to be feasible, a package is not installed, or a limit was reached.
        """
        verdict = self._feasible(trial)
        return self._pictures.get(
            ("strip", _key(trial)), lambda: Picture("image/png", self.call(draw_strip, trial, verdict))
        )

    def scene_file(self, trial: Trial) -> Picture:
        """Return the 3D scene of the robot executing a feasible task, as a .glb file.

        Raises:
            PragError: the task is not known to be feasible, the robot fails to execute it, a package is not installed,
                or a limit was reached.
        """
        shown = self._episode(trial)
        return self._pictures.get(
            ("scene", _key(trial)), lambda: Picture("model/gltf-binary", self.call(make_scene_file, trial, shown))
        )

    def animation(self, trial: Trial) -> Picture:
        """Return an animation of the robot executing a feasible task.

        Raises:
            PragError: the task is not known to be feasible, the robot fails to execute it, a package is not installed,
                or a limit was reached.
        """
        shown = self._episode(trial)
        return self._pictures.get(("film", _key(trial)), lambda: Picture(*self.call(draw_film, trial, shown)))

    def _episode(self, trial: Trial) -> Demonstration:
        verdict = self._feasible(trial)
        episode: Demonstration = self._episodes.get(_key(trial), lambda: self.call(execute, trial, verdict))
        return episode

    def _feasible(self, trial: Trial) -> Verdict:
        verdict = self._verdict(trial)
        if verdict.witness is None:
            told = f"{verdict.status.replace('_', ' ')}: {verdict.reason}"
            raise QueryError(f"{told}; only feasible tasks can be shown, try another seed or a larger budget")
        return verdict

    def _verdict(self, trial: Trial) -> Verdict:
        verdict: Verdict = self._verdicts.get(_key(trial), lambda: self.call(judge, trial))
        return verdict


def _key(trial: Trial) -> tuple[object, ...]:
    return trial.state.length, trial.state.where, trial.state.by, trial.task.actions, trial.seed, trial.budget


def task_verdict(explored: ExploredDomain, trial: Trial, verdict: Verdict) -> TaskVerdict:
    """Return a verdict in plain values, with the commands and the Python code that reproduce it."""
    tried = plural(verdict.restarts, "initial state")
    words = {
        "feasible": f"Feasible: the search found a witness after {tried}, which passes the tier {trial.budget.tier}.",
        "not_found": f"Not found: {tried} led to no witness. The task may still be feasible.",
        "infeasible": "Infeasible: this is proved without a search.",
    }
    detail = f" ({verdict.detail})" if verdict.detail else ""
    return TaskVerdict(
        verdict.status,
        words[verdict.status],
        verdict.reason + detail if verdict.reason else "",
        verdict.nearest,
        tuple(sorted(verdict.causes.items(), key=lambda pair: -pair[1])),
        f"budget {trial.budget}; seed {trial.seed}",
        same_by_physics(explored, trial, feasible=verdict.feasible),
    )


def same_by_physics(explored: ExploredDomain, trial: Trial, *, feasible: bool) -> tuple[SameResult, ...]:
    """Return commands and Python code for the verdict and, if the task is feasible, for its pictures.

    `prag-asp render` has no option for the search budget, so there are commands for pictures only with the default
    budget.
    """
    state, budget = trial.state, trial.budget
    effort = f"{budget.restarts}x{budget.samples}"
    task = f"next(space.tasks_of_plans([{list(state.chosen)}]))"
    python = (
        "from prag_asp import load_scene\nfrom prag_asp.physics import Budget, validate_task\n"
        f"{python_space(explored, state)}task, scene = {task}, load_scene(space.domain)\n"
        f"budget = Budget({budget.restarts}, {budget.samples}, {str(budget.tier)!r})\n"
        f"verdict = validate_task(task, scene, seed={trial.seed}, index={trial.index}, budget=budget)"
    )
    saved = _saved_task(explored, trial)
    options = f"--seed {trial.seed} --budget {effort} --tier {budget.tier}"
    same = [SameResult("the verdict", f"{saved} && prag-asp validate task.jsonl {options}" if saved else "", python)]
    if not feasible:
        return tuple(same)
    drawing = f"prag-asp render task.jsonl --seed {trial.seed}" if saved and budget == Budget() else ""
    same.append(
        SameResult(
            "the film strip",
            f"{drawing} --output task.png" if drawing else "",
            'from prag_asp.physics import film_strip\nfilm_strip(task, verdict.witness, scene).save("task.png")',
        )
    )
    same.append(
        SameResult(
            "the 3D scene",
            f"{drawing} --as html --output task.html" if drawing else "",
            "from pathlib import Path\nfrom prag_asp.physics import demonstrate, episode_page\n"
            "shown = demonstrate(task, verdict.witness, scene)\n"
            'Path("task.html").write_text(episode_page(task, shown, scene))',
        )
    )
    same.append(
        SameResult(
            "the animation",
            f"{drawing} --as mp4 --output task.mp4" if drawing else "",
            "from pathlib import Path\nfrom prag_asp.physics import animate, demonstrate\n"
            'animate(task, demonstrate(task, verdict.witness, scene), scene, Path("task.mp4"))',
        )
    )
    return tuple(same)


def _saved_task(explored: ExploredDomain, trial: Trial) -> str:
    """Return the command that saves a page's task, or "" if a file of tasks cannot name it or its domain."""
    if trial.rank is None or len(explored.words) > 1:
        return ""
    return f"{shell_line(explored, 'task', trial.state, '--index', str(trial.rank))} --format jsonl > task.jsonl"

"""Check the arguments of an environment and of its methods before anything begins."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from numbers import Real
from typing import Any, Literal, TypeGuard, get_args

import numpy as np
from numpy.typing import NDArray

from prag_asp.dataset.store.instructions import TaskTexts
from prag_asp.errors import QueryError
from prag_asp.physics import Budget
from prag_asp.physics.control.control import Control
from prag_asp.rl.observations import OBSERVATIONS
from prag_asp.rl.rewards import REWARDS
from prag_asp.wording import unknown

Until = Literal["subgoal", "task"]
UNTIL: tuple[Until, ...] = get_args(Until)

OPTIONS = ("task", "witness", "rank", "scenario", "stage", "steps", "texts")

ANY = "any"
"""The value of `stage` for a random stage."""

REAL = "biuf"
"""NumPy's kind codes of real numbers. They exclude complex numbers, and strings, which NumPy would parse as numbers."""


def check_arguments(given: Mapping[str, Any], render_modes: Sequence[str]) -> None:
    """Check the arguments of an environment that are checked nowhere else; `given` holds all arguments by name.

    Raises:
        QueryError: an argument has a value that is not allowed.
    """
    for name, choices, what in (
        ("until", UNTIL, "end"),
        ("reward", REWARDS, "reward"),
        ("observation", OBSERVATIONS, "observation"),
    ):
        if given[name] not in choices:
            raise QueryError(unknown(str(given[name]), choices, what))
    for name in ("everything", "goals", "trivial", "skeletons"):
        if not isinstance(given[name], bool):
            raise QueryError(f"{name} {given[name]!r:.80}: give True or False")
    stage, budget, render_mode = given["stage"], given["budget"], given["render_mode"]
    if not is_whole(stage) and not isinstance(stage, str):
        told = f"stage {stage!r}: give the number of a subgoal, from 0 or, from the last one, -1"
        raise QueryError(f"{told}; or {ANY}, or the name of an action")
    _check_steps(given["steps"])
    for name, what in (("discount", "a discount"), ("action_scale", "an action_scale")):
        figure = given[name]
        if not isinstance(figure, Real) or isinstance(figure, bool) or not 0.0 < float(figure) <= 1.0:
            raise QueryError(f"{what} is above 0 and at most 1; got {figure!r}")
    if budget is not None and not isinstance(budget, Budget):
        raise QueryError(f"budget {budget!r:.80}: give a prag_asp.physics.Budget")
    if render_mode is not None and render_mode not in render_modes:
        raise QueryError(unknown(str(render_mode), render_modes, "render mode"))


def conditions_of(where: Sequence[str], stage: object) -> Sequence[str]:
    """Return the conditions on tasks; if `stage` is the name of an action, tasks must have this action."""
    if isinstance(where, str) or not isinstance(stage, str) or stage == ANY:
        return where
    return (*where, f"has {stage}")


def options_of(options: object) -> Mapping[str, Any]:
    """Return the options of a reset.

    Raises:
        QueryError: the options are malformed, unknown or contradictory.
    """
    if options is None:
        return {}
    if not isinstance(options, Mapping):
        raise QueryError(f'options {options!r:.80}: give them by name, such as {{"stage": 1}}')
    for name in options:
        if name not in OPTIONS:
            raise QueryError(unknown(str(name), OPTIONS, "option"))
    given = [name for name in ("rank", "task", "scenario") if options.get(name) is not None]
    if len(given) > 1:
        raise QueryError(f"a {given[0]} and a {given[1]}: give one of them")
    if options.get("scenario") is not None and options.get("witness") is not None:
        raise QueryError("a scenario has its own witness; leave the other out")
    if not isinstance(options.get("texts"), TaskTexts | None):
        raise QueryError(f"texts {options['texts']!r:.80}: give a prag_asp.dataset.store.instructions.TaskTexts")
    if options.get("steps") is not None:
        _check_steps(options["steps"])
    return options


def moves_of(action: object, control: Control) -> NDArray[np.float64]:
    """Return an action as an array of floats, clipped to the bounds of a control.

    Raises:
        QueryError: the action has a wrong shape, or is not finite.
    """
    try:
        numbers = np.asarray(action)
        real = numbers.dtype.kind in REAL and not (isinstance(action, np.ma.MaskedArray) and np.ma.is_masked(action))
        moves = numbers.astype(np.float64) if real else np.array(np.nan)
    except (TypeError, ValueError, OverflowError):
        moves = np.array(np.nan)
    if moves.shape != control.low.shape or not all(map(math.isfinite, moves.tolist())):
        raise QueryError(f"an action has the shape {control.low.shape} and finite numbers; got {action!s:.80}")
    clipped: NDArray[np.float64] = np.minimum(np.maximum(moves, control.low), control.high)
    return clipped


def steps_left_of(info: object) -> NDArray[np.float64]:
    """Return the `steps_left` in the info for a step or a batch of steps, or infinity if it is missing.

    Gymnasium's vector environments return one info with arrays; replay buffers return a sequence of infos.
    """
    if isinstance(info, Mapping):
        return np.asarray(info.get("steps_left", np.inf), dtype=np.float64)
    if isinstance(info, Sequence | np.ndarray):
        return np.array([each.get("steps_left", np.inf) for each in info], dtype=np.float64)
    return np.array(np.inf)


def _check_steps(steps: object) -> None:
    """Check a number of steps.

    Raises:
        QueryError: the number is not a whole number of at least 1.
    """
    if not is_whole(steps) or steps < 1:
        raise QueryError(f"an episode needs at least 1 step; got {steps!r}")


def is_whole(number: object) -> TypeGuard[int | np.integer[Any]]:
    """Return whether a value is a whole number of a Python or NumPy type."""
    return isinstance(number, int | np.integer) and not isinstance(number, bool)

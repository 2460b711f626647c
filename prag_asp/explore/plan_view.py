"""The main view: the chosen actions, the possible next actions with exact counts, and the states beside the plan.

Numbers are strings of digits, because JavaScript's numbers are exact only up to 2^53. Shares are decimal strings.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from prag_asp.atom import Atom
from prag_asp.errors import PragError
from prag_asp.explore.explored_domain import ExploredDomain
from prag_asp.explore.page_state import PageState
from prag_asp.explore.same_result import SameResult, level_argument, level_options, python_space, shell_line
from prag_asp.integers import digits_of
from prag_asp.space.engines.engine import Letters
from prag_asp.space.plans.readings import Composite, Readings
from prag_asp.space.task_space import TaskSpace
from prag_asp.task import Task

SHARE_DIGITS = 6
"""The number of decimal places in shares."""

SHOWN_READINGS = 5
"""The maximum number of readings that a view lists."""


@dataclass(frozen=True)
class NextAction:
    """A possible next action: the number of tasks that remain, their share, the first rank, and the state after it."""

    action: str
    name: str
    count: str
    share: str
    first_rank: str
    query: str


@dataclass(frozen=True)
class Step:
    """One step of the plan: its action and the number of tasks that remain after it; the initial state has no action.

    `true` are the facts that hold after the step, `changed` are those that it made true, and `undone` are those that it
    made false. `query` is the state of the page after this step. The facts are None if they are not known.
    """

    action: str
    count: str
    true: tuple[str, ...] | None
    changed: tuple[str, ...]
    undone: tuple[str, ...]
    query: str


@dataclass(frozen=True)
class ReadingNode:
    """A node of a reading: an action or a composite with its parts."""

    term: str
    parts: tuple[ReadingNode, ...] = ()


@dataclass(frozen=True)
class Tree:
    """The readings of the plan as trees, their number, and the actions that no complete composite covers yet."""

    number: str
    readings: tuple[tuple[ReadingNode, ...], ...]
    unfinished: tuple[str, ...]


@dataclass(frozen=True)
class PlanView:
    """What a page shows of a plan.

    `total` is the number of tasks under the conditions and `count` the number of those that begin with the chosen
    actions. Their ranks are `first_rank`, `first_rank` + 1, ... `interchangeable` are groups of entities; `tree` is
    None if there are no composites.
    """

    query: str
    title: str
    level: str
    length: int
    total: str
    count: str
    share: str
    first_rank: str
    steps: tuple[Step, ...]
    actions: tuple[NextAction, ...]
    interchangeable: tuple[tuple[str, ...], ...]
    tree: Tree | None
    same: tuple[SameResult, ...]


def plan_view(explored: ExploredDomain, state: PageState) -> PlanView:
    """Return what a page shows of a plan.

    Raises:
        PragError: the state does not fit the domain, or a limit was reached.
    """
    space, chosen = explored.space_of(state), explored.chosen(state)
    state = replace(state, chosen=chosen)
    counts, rank = [_total(explored, state)], 0
    for place, action in enumerate(chosen):
        following = explored.following(state, chosen[:place])
        counts.append(following.get(action, 0))
        if action in following:
            names = list(following)
            rank += sum(following[name] for name in names[: names.index(action)])
    left = counts[-1]
    actions, first = [], rank
    for action, number in (explored.following(state, chosen) if left and len(chosen) < state.length else {}).items():
        query = state.choosing(action).query
        name = action.partition("(")[0]
        actions.append(NextAction(action, name, digits_of(number), share(number, left), digits_of(first), query))
        first += number
    return PlanView(
        state.query,
        space.title,
        state.by,
        state.length,
        digits_of(counts[0]),
        digits_of(left),
        share(left, counts[0]),
        digits_of(rank),
        _steps(explored, state, counts),
        tuple(actions),
        tuple(tuple(map(str, orbit)) for orbit in space.symmetries.orbits),
        _tree(space, chosen),
        _same(explored, state, rank),
    )


@dataclass(frozen=True)
class CountView:
    """The number of tasks under the conditions, and how many of them begin with the chosen actions."""

    total: str
    count: str


def count_view(explored: ExploredDomain, state: PageState) -> CountView:
    """Return only the counts on a page, for conditions that the user is still typing.

    Raises:
        PragError: the state does not fit the domain, or a limit was reached.
    """
    chosen = explored.chosen(state)
    count = explored.following(state, chosen[:-1]).get(chosen[-1], 0) if chosen else _total(explored, state)
    return CountView(digits_of(_total(explored, state)), digits_of(count))


def share(part: int, whole: int) -> str:
    """Return a share of a whole as a decimal string, rounded half to even unless it is exactly ``0`` or ``1``.

    The share of 0 in 0 is 0.
    """
    if part in (0, whole):
        return "1" if part else "0"
    places = 10**SHARE_DIGITS
    rounded = round(Fraction(part * places, whole or 1))
    return f"{rounded // places}.{rounded % places:0{SHARE_DIGITS}d}"


def _total(explored: ExploredDomain, state: PageState) -> int:
    if state.length:
        return sum(explored.following(state, ()).values())
    return explored.space_of(state).count(state.by)


def _steps(explored: ExploredDomain, state: PageState, counts: Sequence[int]) -> tuple[Step, ...]:
    """Return the steps of the plan, starting with the initial state."""
    task = _task(explored, state) if counts[-1] else None
    facts: list[Mapping[Atom, bool] | None] = [None] * len(counts)
    if task is not None:
        facts = [task.initial, *task.states]
    steps, before = [], None
    for place, (known, number) in enumerate(zip(facts, counts, strict=True)):
        true = None if known is None else tuple(sorted(str(fact) for fact, value in known.items() if value))
        earlier = before if before is not None and place else true
        changed = tuple(fact for fact in true or () if fact not in (earlier or ()))
        undone = tuple(fact for fact in earlier or () if fact not in (true or ()))
        action = state.chosen[place - 1] if place else ""
        query = replace(state, chosen=state.chosen[:place]).query
        steps.append(Step(action, digits_of(number), true, changed, undone, query))
        before = true
    return tuple(steps)


def _task(explored: ExploredDomain, state: PageState) -> Task | None:
    """Return the task with the chosen actions, or None if the states of an unfinished plan are not known.

    A goal in the conditions applies only to whole tasks.
    """
    finished = len(state.chosen) == state.length
    space = explored.space_of(state) if finished else explored.space(state.length)
    try:
        return next(space.tasks_of_plans([state.chosen]))
    except PragError:
        return None


def _tree(space: TaskSpace, chosen: Letters) -> Tree | None:
    """Return the readings of the longest prefix that has any, or None if the domain has no composites."""
    hierarchy = space.engines.hierarchy
    if hierarchy.units is None:
        return None
    by_text = {str(action): action for actions in hierarchy.units for action in actions}
    plan = tuple(by_text[action] for action in chosen)
    readings = next(
        found for size in range(len(plan), -1, -1) if (found := Readings(plan[:size], hierarchy)).count() or not size
    )
    listed = [tuple(map(_node, reading)) for reading, _ in zip(readings, range(SHOWN_READINGS), strict=False)]
    return Tree(digits_of(readings.count()), tuple(listed), chosen[len(readings.actions) :])


def _node(part: Atom | Composite) -> ReadingNode:
    if isinstance(part, Composite):
        return ReadingNode(str(part.term), tuple(map(_node, part.parts)))
    return ReadingNode(str(part))


def _same(explored: ExploredDomain, state: PageState, rank: int) -> tuple[SameResult, ...]:
    space, level = python_space(explored, state), level_argument(state)
    chosen = list(state.chosen)
    prefix = ("--prefix", ",".join(chosen)) if chosen else ()
    options = (*level_options(state), *prefix)
    same = [
        SameResult(
            "the number of tasks" if state.by == "task" else "the number of plans",
            shell_line(explored, "count", state, *options),
            f"{space}space.count(prefix={chosen}{level})",
        )
    ]
    if len(chosen) < state.length:
        view = SameResult(
            "this view", shell_line(explored, "explore", state, *options), f"{space}space.next_actions({chosen}{level})"
        )
        return (*same, view)
    if state.by == "task":
        line = shell_line(explored, "task", state, "--index", str(rank))
        same.append(SameResult("this task", line, f"{space}space[{rank}]"))
    return (
        *same,
        SameResult("this view", shell_line(explored, "explore", state, *options), f"{space}{chosen} in space"),
    )

"""A task: a plan with its initial state, its goal and one subgoal for each action."""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, NoReturn, Protocol, TypeVar

from prag_asp.atom import Atom

if TYPE_CHECKING:
    from prag_asp.similarity.background import Background, Trace, UpTo
    from prag_asp.similarity.measures import Distance
    from prag_asp.similarity.task_comparison import TaskComparison

State = Mapping[Atom, bool]
"""The known facts of a state; fluents that are not in it are unknown (they may have any value)."""


Key = TypeVar("Key", bound=Hashable)
Value = TypeVar("Value", bound=Hashable)


class FrozenDict(dict[Key, Value]):
    """An immutable, hashable dictionary, which equals any dictionary with the same items.

    It is a subclass of `dict`, so lookups are as fast as in a `dict`; ``dict(frozen)`` copies it to a plain dictionary.
    """

    __slots__ = ("_hash",)
    _hash: int

    def __hash__(self) -> int:  # type: ignore[override]
        try:
            return self._hash
        except AttributeError:
            self._hash = hash(frozenset(self.items()))
            return self._hash

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (dict(self),)

    def __copy__(self) -> FrozenDict[Key, Value]:
        return self

    def __deepcopy__(self, memo: dict[int, Any]) -> FrozenDict[Key, Value]:
        return self

    def __repr__(self) -> str:
        return f"FrozenDict({dict(self)!r})"

    def _refuse(self, *arguments: object, **items: object) -> NoReturn:
        raise TypeError("it is shared between tasks and cannot be changed; change a copy, dict(...)")

    __setitem__ = __delitem__ = __ior__ = _refuse
    clear = pop = popitem = setdefault = update = _refuse


KNOWN_VALUES = {True: "true", False: "false", None: ""}
"""The texts of a fluent's values in a table; an unknown value leaves its cell empty."""

SHOWN_ROWS, SHOWN_STATES = 100, 25
"""The maximum numbers of rows and of states that a notebook shows."""


class KnownDomain(Protocol):
    """An object that knows the classes and the interchangeable entities of tasks, such as a task space."""

    @property
    def background(self) -> Background:
        """The knowledge about the domain that comparisons of tasks use."""


@dataclass(frozen=True)
class Task:
    """A plan with the known facts of each state through which it passes.

    `entities` maps each entity that occurs in an action or a known fluent to its class. `states[k]` holds the facts
    that are known after action k+1, and `subgoals[k]` holds the facts that this action itself makes true or false; both
    are as long as `actions`. `goal` holds the facts that must hold at the end. `log_probability` is the natural
    logarithm of the probability with which the task was sampled, or None if it was not sampled. `constants` holds the
    values that were set for ``#const``s of the domain, by name.
    """

    domain: str
    actions: tuple[Atom, ...]
    entities: Mapping[str, str]
    initial: State
    states: tuple[State, ...]
    subgoals: tuple[State, ...]
    goal: State
    log_probability: float | None = None
    constants: Mapping[str, str] = field(default_factory=FrozenDict)

    def __len__(self) -> int:
        return len(self.actions)

    def __str__(self) -> str:
        return " ".join(map(str, self.actions))

    @property
    def skeleton(self) -> tuple[str, ...]:
        """The names of the actions, in order."""
        return tuple(action.name for action in self.actions)

    @property
    def trivial(self) -> bool:
        """Whether the initial and final states have the same known facts, so that doing nothing achieves the goal."""
        return not self.states or dict(self.states[-1]) == dict(self.initial)

    def _repr_html_(self) -> str:
        """Return the task for a notebook: its plan with the effects of each action, and a table of its states."""
        from prag_asp.html import element, fragment, scroll_table  # noqa: PLC0415 - a task alone needs no page

        def effects(facts: State, value: bool) -> str:
            return ", ".join(str(fluent) for fluent, known in facts.items() if known is value)

        steps = zip(self.actions, self.subgoals, strict=True)
        plan = [
            (str(number), str(action), effects(facts, True), effects(facts, False))
            for number, (action, facts) in enumerate(steps, 1)
        ]
        states = (self.initial, *self.states)[:SHOWN_STATES]
        fluents = sorted({fluent for state in states for fluent, value in state.items() if value}, key=str)
        values = [(str(fluent), *(KNOWN_VALUES[state.get(fluent)] for state in states)) for fluent in fluents]
        heads = ("true in the state", "initial", *(f"after {number}" for number in range(1, len(states))))
        table = scroll_table(heads, values, label="States", most=SHOWN_ROWS)
        return fragment(
            element("p", element("strong", f"A task of {self.domain}"), f", {len(self)} actions"),
            scroll_table(("step", "action", "makes true", "makes false"), plan, label="Plan", most=SHOWN_ROWS),
            element("p", f"Goal: {effects(self.goal, True) or 'no true fact'}"),
            element("details", element("summary", "States"), table),
        )

    def distance(
        self, other: Trace, metric: str = "combined", *, within: KnownDomain | None = None, up_to: UpTo = "names"
    ) -> Distance:
        """Return the distance between two tasks, minimised over all renamings of interchangeable entities.

        `metric` is a name in `prag_asp.similarity.METRICS`. `within` is a task space of the domain. Without it, classes
        have no hierarchy, the preconditions of an action are guessed from its effects, and entities match by name, or
        by class with ``up_to="classes"``.

        Raises:
            QueryError: there is no such metric, or it cannot compare these tasks.
            SimilarityMissingError: the metric needs rapidfuzz, which is not installed.
        """
        return self.compare(other, metric, within=within, up_to=up_to).distance

    def compare(
        self, other: Trace, metric: str = "combined", *, within: KnownDomain | None = None, up_to: UpTo = "names"
    ) -> TaskComparison:
        """Compare two tasks like `distance`, but also return the edits, the renaming, and a similarity from 0 to 1."""
        from prag_asp.similarity.task_comparison import compare  # noqa: PLC0415 - a task alone needs no metrics

        return compare(self, other, metric, None if within is None else within.background, up_to)

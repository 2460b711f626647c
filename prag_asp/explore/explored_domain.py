"""A domain that pages explore: its task spaces by length and conditions, and recent counts of next actions."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Hashable
from dataclasses import dataclass, field
from typing import Any, TypeVar

from prag_asp.domain.load import Domain
from prag_asp.errors import QueryError
from prag_asp.explore.page_state import PageState
from prag_asp.space.engines.engine import Letters
from prag_asp.space.engines.prefix import engine_prefix
from prag_asp.space.limits import UNLIMITED, Limits
from prag_asp.space.task_space import TaskSpace

SPACES, PREFIXES = 16, 2048
"""The numbers of task spaces and of prefixes that are cached."""

Value = TypeVar("Value")


@dataclass
class Cache:
    """The latest values by key, at most `size` of them."""

    size: int
    _values: OrderedDict[Hashable, Any] = field(default_factory=OrderedDict)

    def get(self, key: Hashable, make: Callable[[], Value]) -> Value:
        """Return the value for a key; if it is not cached, make it first."""
        if key not in self._values:
            self._values[key] = make()
            while len(self._values) > self.size:
                self._values.popitem(last=False)
        self._values.move_to_end(key)
        value: Value = self._values[key]
        return value


@dataclass
class ExploredDomain:
    """A domain with its task spaces.

    `words` are the arguments that name the domain on a command line, and `call` is the code that loads it in Python;
    both are shown beside each view. `progress` receives messages about progress.
    """

    domain: Domain
    words: tuple[str, ...]
    call: str
    engine: str = "auto"
    limits: Limits = UNLIMITED
    progress: Callable[[str], None] | None = None
    _spaces: Cache = field(default_factory=lambda: Cache(SPACES))
    _following: Cache = field(default_factory=lambda: Cache(PREFIXES))

    def space(self, length: int, where: tuple[str, ...] = ()) -> TaskSpace:
        """Return the task space with a given length and conditions.

        Raises:
            QueryError: a condition cannot be parsed, or names something that the domain does not have.
        """

        def make() -> TaskSpace:
            if where:
                return self.space(length).where(*where)
            return TaskSpace(self.domain, length, engine=self.engine, progress=self.progress, limits=self.limits)

        return self._spaces.get((length, where), make)

    def space_of(self, state: PageState) -> TaskSpace:
        """Return the task space with the length and the conditions of a page."""
        return self.space(state.length, state.where)

    def chosen(self, state: PageState) -> Letters:
        """Return the actions chosen on a page; for tasks, entities have their canonical names.

        Raises:
            QueryError: there are more actions than the length allows, or one of them is not an action of the domain.
        """
        if len(state.chosen) > state.length:
            raise QueryError(f"{len(state.chosen)} actions are chosen, but tasks have {state.length}; undo some")
        space = self.space_of(state)
        prefix = engine_prefix(state.chosen, state.by, state.length, self.domain, space.engines.model)
        for given, action in zip(state.chosen, prefix, strict=True):
            if action not in space.engines.actions:
                raise QueryError(f"{given}: only the name of an action; choose an action with its arguments")
        return prefix

    def following(self, state: PageState, prefix: Letters) -> dict[str, int]:
        """Return each action that may follow a canonical prefix in a page's space, with the number of words for it."""
        key = (state.length, state.where, state.by, prefix)
        space = self.space_of(state)
        return self._following.get(key, lambda: space.next_actions(prefix, state.by))

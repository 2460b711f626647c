"""The data that comparisons may use in addition to the tasks: classes, interchangeable entities and preconditions."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Literal, Protocol

from prag_asp.atom import Atom
from prag_asp.errors import QueryError
from prag_asp.similarity.class_tree import ClassTree
from prag_asp.similarity.interchange import Interchange

FactValues = Mapping[Atom, bool]
"""Known facts with their values."""

UpTo = Literal["names", "classes"]
"""The interchangeable entities of tasks without a domain: none, or the entities of each class."""


class Trace(Protocol):
    """The attributes of a task that metrics read; `prag_asp.Task` has them."""

    @property
    def actions(self) -> tuple[Atom, ...]:
        """The actions."""

    @property
    def entities(self) -> Mapping[str, str]:
        """The entities with their classes."""

    @property
    def initial(self) -> FactValues:
        """The known facts of the initial state."""

    @property
    def states(self) -> tuple[FactValues, ...]:
        """The known facts after each action."""

    @property
    def subgoals(self) -> tuple[FactValues, ...]:
        """The facts that each action itself makes true or false."""


@dataclass(frozen=True)
class Background:
    """The known data of a domain: `classes` of entities, `parents` of classes, and interchangeable entities.

    `preconditions` maps each action to the facts that it requires; None means that they are unknown.
    """

    classes: Mapping[str, str] = field(default_factory=dict)
    parents: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    interchange: Interchange[str] = field(default_factory=Interchange)
    preconditions: Mapping[Atom, FactValues] | None = None

    @cached_property
    def tree(self) -> ClassTree:
        """The tree of the classes."""
        return ClassTree(self.classes, self.parents)

    @classmethod
    def of_tasks(cls, tasks: Iterable[Trace], up_to: UpTo = "names") -> Background:
        """Return the background that the given tasks alone determine; in it, no class has a superclass.

        No two entities are interchangeable or, with ``classes``, all entities of a class are.

        Raises:
            QueryError: two tasks have an entity with the same name in different classes, or `up_to` is invalid.
        """
        classes: dict[str, str] = {}
        for task in tasks:
            for entity, name in task.entities.items():
                if classes.setdefault(entity, name) != name:
                    raise QueryError(
                        f"{entity} is of class {classes[entity]} in one task and of class {name} in another; compare "
                        "tasks of one domain"
                    )
        if up_to not in ("names", "classes"):
            raise QueryError(f"up_to={up_to!r}: write 'names' or 'classes'")
        members: dict[str, list[str]] = {}
        for entity in sorted(classes) if up_to == "classes" else ():
            members.setdefault(classes[entity], []).append(entity)
        return cls(classes, {}, Interchange(tuple(tuple(each) for each in members.values() if len(each) > 1)))

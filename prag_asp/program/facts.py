"""The facts of the base part of a domain."""

from __future__ import annotations

import copyreg
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from operator import itemgetter
from typing import Any

import clingo

from prag_asp.atom import symbol_of
from prag_asp.errors import DomainError
from prag_asp.program.atom_arrays import ground_atoms

# A symbol is an address within a process. Symbols are pickled as text, so that other processes can read them.
copyreg.pickle(clingo.Symbol, lambda symbol: (symbol_of, (str(symbol),)))

VALUES = ("true", "false", "unknown")

LATER = "_later"
"""The attribute that holds the function by which facts are grounded on first use."""

Assignment = tuple[tuple[clingo.Symbol, str], ...]
"""Fluents with their values; only postconditions can have the value ``unknown``."""


@dataclass(frozen=True)
class Facts:
    """The predicates of the contract in the grounded base program.

    Terms are clingo symbols, in clingo's order of terms. `parents` maps each class to its direct superclasses, and
    `entities` maps each entity to its declared class; `memberships` contains the derived ``is_a`` facts. `pruned`
    contains the declared actions and composites that every state rejects; all other facts about them are removed.
    `unreachable` contains the actions whose preconditions are relaxed-unreachable: no step tries them, but their
    preconditions and effects remain. `static` maps fluents to the values that they have in every state because no tried
    action sets them; it may be incomplete.
    """

    parents: Mapping[clingo.Symbol, tuple[clingo.Symbol, ...]]
    entities: Mapping[clingo.Symbol, clingo.Symbol]
    memberships: frozenset[tuple[clingo.Symbol, clingo.Symbol]]
    fluents: tuple[clingo.Symbol, ...]
    actions: tuple[clingo.Symbol, ...]
    preconditions: Mapping[clingo.Symbol, Assignment]
    postconditions: Mapping[clingo.Symbol, Assignment]
    initially: Assignment
    exclusive: tuple[tuple[clingo.Symbol, clingo.Symbol], ...]
    implies: tuple[tuple[clingo.Symbol, clingo.Symbol], ...]
    impossible: tuple[tuple[clingo.Symbol, clingo.Symbol], ...]
    goal: Assignment
    composites: tuple[clingo.Symbol, ...]
    stages: Mapping[clingo.Symbol, tuple[tuple[clingo.Symbol, clingo.Symbol], ...]]
    free: tuple[clingo.Symbol, ...]
    pruned: tuple[clingo.Symbol, ...] = field(default_factory=tuple)
    unreachable: tuple[clingo.Symbol, ...] = field(default_factory=tuple)
    static: Assignment = field(default_factory=tuple)

    def __getattr__(self, name: str) -> Any:
        """Ground the facts on first use (see `ground_later`)."""
        ground = self.__dict__.pop(LATER, None)
        if ground is None:
            raise AttributeError(name)
        self.__dict__.update(ground().__dict__)
        return getattr(self, name)

    def __getstate__(self) -> dict[str, Any]:
        """Ground the facts before they are pickled."""
        _ = self.fluents
        return self.__dict__

    @property
    def classes(self) -> set[clingo.Symbol]:
        """All classes, whether they are declared or only named as superclasses."""
        return {name for _, name in self.memberships}.union(self.parents)

    @cached_property
    def tried(self) -> tuple[clingo.Symbol, ...]:
        """The actions that steps try."""
        never = set(self.unreachable)
        return tuple(action for action in self.actions if action not in never)

    @cached_property
    def actions_by_text(self) -> Mapping[str, clingo.Symbol]:
        """The actions, keyed by their text."""
        return {str(action): action for action in self.actions}

    @cached_property
    def entity_names(self) -> Mapping[str, str]:
        """The entities with their classes, as text."""
        return {str(entity): str(name) for entity, name in self.entities.items()}

    @cached_property
    def class_names(self) -> Mapping[str, tuple[str, ...]]:
        """The classes with their direct superclasses, as text."""
        return {str(name): tuple(map(str, above)) for name, above in self.parents.items()}

    @cached_property
    def declared_actions(self) -> tuple[clingo.Symbol, ...]:
        """The actions, including pruned ones."""
        composites = set(self.composites)
        return (*self.actions, *(term for term in self.pruned if term not in composites))

    @cached_property
    def action_names(self) -> frozenset[str]:
        """The names of the actions, including pruned ones."""
        return frozenset(action.name for action in self.declared_actions)

    @cached_property
    def action_arguments(self) -> Mapping[tuple[str, int], list[set[str]]]:
        """The texts of the arguments at each position of actions, including pruned ones, keyed by name and arity."""
        return _arguments(self.declared_actions)

    @cached_property
    def fluent_arguments(self) -> Mapping[tuple[str, int], list[set[str]]]:
        """The texts of the arguments at each position of fluents, keyed by name and arity."""
        return _arguments(self.fluents)

    @property
    def closed(self) -> bool:
        """Whether every fluent has an initial value."""
        return set(self.fluents) <= {fluent for fluent, _ in self.initially}


def _arguments(terms: Iterable[clingo.Symbol]) -> dict[tuple[str, int], list[set[str]]]:
    by_signature: dict[tuple[str, int], list[set[str]]] = {}
    for term in terms:
        arguments = term.arguments
        places = by_signature.setdefault((term.name, len(arguments)), [set() for _ in arguments])
        for place, argument in zip(places, arguments, strict=True):
            place.add(str(argument))
    return by_signature


def ground_later(ground: Callable[[], Facts]) -> Facts:
    """Return facts that are grounded on first use."""
    facts = object.__new__(Facts)
    facts.__dict__[LATER] = ground
    return facts


def read_facts(control: clingo.Control) -> Facts:
    """Read the facts of a grounded base part.

    Raises:
        DomainError: a predicate of the contract depends on a choice.
    """
    parents: dict[clingo.Symbol, tuple[clingo.Symbol, ...]] = {name: () for (name,) in rows(control, "class", 1)}
    for child, parent in rows(control, "class", 2):
        parents[child] = (*parents.get(child, ()), parent)
    fluents, actions = (tuple(term for (term,) in rows(control, each, 1)) for each in ("fluent", "action"))
    stages: dict[clingo.Symbol, tuple[tuple[clingo.Symbol, clingo.Symbol], ...]] = {}
    for composite, number, part in rows(control, "stage", 3):
        stages[composite] = (*stages.get(composite, ()), (number, part))
    return Facts(
        parents=parents,
        entities={entity: name for entity, name in rows(control, "entity", 2)},  # noqa: C416 - a row is a list
        memberships=frozenset((entity, name) for entity, name in rows(control, "is_a", 2)),
        fluents=fluents,
        actions=actions,
        preconditions=_by_action(control, "precondition", actions, fluents),
        postconditions=_by_action(control, "postcondition", actions, fluents),
        initially=tuple((fluent, str(value)) for fluent, value in rows(control, "initially", 2)),
        exclusive=tuple((first, second) for first, second in rows(control, "exclusive", 2)),
        implies=tuple((first, second) for first, second in rows(control, "implies", 2)),
        impossible=tuple((first, second) for first, second in rows(control, "impossible", 2)),
        goal=tuple((fluent, str(value)) for fluent, value in rows(control, "goal", 2)),
        composites=tuple(composite for (composite,) in rows(control, "composite", 1)),
        stages=stages,
        free=tuple(action for (action,) in rows(control, "free", 1)),
    )


def without(facts: Facts, pruned: Iterable[clingo.Symbol]) -> Facts:
    """Return facts without pruned actions and composites.

    Composites remain in `composites`, because in a domain without composites, all actions are free.
    """
    gone = set(pruned)
    if not gone:
        return facts
    return replace(
        facts,
        actions=tuple(action for action in facts.actions if action not in gone),
        preconditions={action: values for action, values in facts.preconditions.items() if action not in gone},
        postconditions={action: values for action, values in facts.postconditions.items() if action not in gone},
        free=tuple(action for action in facts.free if action not in gone),
        pruned=tuple(term for term in (*facts.actions, *facts.composites) if term in gone),
    )


def flattened(facts: Facts) -> Facts:
    """Return facts without composites, so that any sequence of actions can be a plan."""
    composites = set(facts.composites)
    pruned = tuple(term for term in facts.pruned if term not in composites)
    return replace(facts, composites=(), stages={}, free=(), pruned=pruned)


def rows(control: clingo.Control, predicate: str, arity: int) -> list[list[clingo.Symbol]]:
    """Return the arguments of every ground atom of a predicate, sorted.

    Raises:
        DomainError: an atom depends on a choice.
    """
    return sorted(unsorted_rows(control, predicate, arity))


def unsorted_rows(control: clingo.Control, predicate: str, arity: int) -> Iterator[list[clingo.Symbol]]:
    """Yield the arguments of each ground atom of a predicate; they are unsorted, because comparing terms is slow.

    Raises:
        DomainError: an atom depends on a choice.
    """
    for arguments, _, is_fact in ground_atoms(control, predicate, arity):
        if not is_fact:
            atom = clingo.Function(predicate, arguments)
            raise DomainError(f"{atom} depends on a choice; what a domain states must follow from facts")
        yield arguments


def _by_action(
    control: clingo.Control, predicate: str, actions: Iterable[clingo.Symbol], fluents: Iterable[clingo.Symbol]
) -> dict[clingo.Symbol, Assignment]:
    """Return, for each action, the sorted fluents and values that a predicate assigns to it.

    `actions` and `fluents` are sorted, and each term is looked up once, because comparing thousands of clingo's terms
    is slow. Later lookups use the identity of terms, which are kept alive, because hashing terms is also slow.
    """
    ranks = {fluent: (rank, fluent) for rank, fluent in enumerate(fluents)}
    spelled = {clingo.Function(value): value for value in VALUES}
    by_action: dict[clingo.Symbol, list[tuple[int, str, clingo.Symbol]]] = {action: [] for action in actions}
    declared = len(by_action)
    places: dict[int, tuple[clingo.Symbol, tuple[int, clingo.Symbol]]] = {}
    words: dict[int, tuple[clingo.Symbol, str]] = {}
    lists: dict[int, tuple[clingo.Symbol, list[tuple[int, str, clingo.Symbol]]]] = {}
    for action, fluent, value in unsorted_rows(control, predicate, 3):
        rows_of = lists.get(id(action)) or lists.setdefault(id(action), (action, by_action.setdefault(action, [])))
        place = places.get(id(fluent)) or places.setdefault(
            id(fluent), (fluent, ranks.setdefault(fluent, (len(ranks), fluent)))
        )
        word = words.get(id(value)) or words.setdefault(id(value), (value, spelled.setdefault(value, str(value))))
        rank, same_fluent = place[1]
        rows_of[1].append((rank, word[1], same_fluent))
    table: dict[clingo.Symbol, Assignment] = {}
    for action in by_action if len(by_action) == declared else sorted(by_action):
        if by_action[action]:
            by_action[action].sort(key=itemgetter(0, 1))
            table[action] = tuple([(fluent, value) for _, value, fluent in by_action[action]])
    return table

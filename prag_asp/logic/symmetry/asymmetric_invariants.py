"""A test of whether a domain states the same invariants for all entities of a class.

If it does not, the invariants that some entities lack may still be entailed for them, so that the entities differ only
in syntax. `rules/closed_invariants.lp` states all entailed invariants, which do not depend on how the invariants are
stated.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from itertools import pairwise

import clingo

from prag_asp.logic.symmetry.renaming import Shaped, Shapes
from prag_asp.program.facts import Facts
from prag_asp.program.invariants import conflict, entailed, invariant_graph

_Stated = tuple[str, Shaped, Shaped]
"""An invariant: its predicate and its fluents; or a goal that always holds, with its fluent given twice."""


def states_unevenly(facts: Facts, groups: Collection[Sequence[clingo.Symbol]]) -> bool:
    """Return whether some entities lack invariants that others of their class have but that may be entailed for them.

    The result is False if the `groups` of interchangeable entities already are whole classes.
    """
    # A goal with the value false also follows from the invariants if its fluent is false in every state.
    negative = [fluent for fluent, value in facts.goal if value == "false"]
    graph = invariant_graph(facts) if negative else {}
    idle = [fluent for fluent in negative if conflict(entailed([(fluent, True)], graph))]
    if not (facts.implies or facts.impossible or idle):
        return False  # nothing follows from exclusive fluents alone
    numbers = {entity: number for number, entity in enumerate(facts.entities)}
    members: dict[clingo.Symbol, list[int]] = {}
    for entity, name in facts.entities.items():
        members.setdefault(name, []).append(numbers[entity])
    whole = {facts.entities[group[0]] for group in groups if len(group) == len(members[facts.entities[group[0]]])}
    classes = [each for name, each in members.items() if len(each) > 1 and name not in whole]
    if not classes:
        return False
    shapes = Shapes(numbers)
    stated: set[_Stated] = set()
    for predicate, pairs in (
        ("goal", [(fluent, fluent) for fluent in idle]),
        ("exclusive", [*facts.exclusive, *((second, first) for first, second in facts.exclusive)]),
        ("impossible", [*facts.impossible, *((second, first) for first, second in facts.impossible)]),
        ("implies", [(first, second) for first, second in facts.implies if first != second]),
    ):
        stated |= {(predicate, shapes.of(first), shapes.of(second)) for first, second in pairs}
    naming: dict[int, list[_Stated]] = {}
    for each in stated:
        for number in {*each[1][1], *each[2][1]}:
            naming.setdefault(number, []).append(each)
    # swaps of neighbours generate all renamings of a class
    return not all(_kept(*pair, stated, naming) for each in classes for pair in pairwise(each))


def _kept(first: int, second: int, stated: Collection[_Stated], naming: Mapping[int, Sequence[_Stated]]) -> bool:
    """Return whether the swap of two entities maps the invariants onto themselves."""
    names = {first: second, second: first}

    def swapped(fluent: Shaped) -> Shaped:
        shape, entities = fluent
        return shape, tuple(names.get(entity, entity) for entity in entities)

    return all(
        (predicate, swapped(one), swapped(other)) in stated
        for entity in names
        for predicate, one, other in naming.get(entity, ())
    )

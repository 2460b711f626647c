"""The arguments of an action that are the source and the destination of an object, inferred from the effects."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Set
from functools import cache, reduce
from typing import Any, NamedTuple

from prag_asp.atom import Atom, atom_of
from prag_asp.program.facts import Facts

Signature = tuple[str, int]
"""The name and the arity of an action or a fluent."""


PLACES_OF_ROBOT = frozenset(["robot_at", "at_robot"])
"""Unary fluents that state where the robot is: an action that changes their argument moves the robot."""


class Way(NamedTuple):
    """A source (``from``) or destination (``to``) of an action.

    `moved` is the position of the moved argument, or -1 for a robot. The action makes `fluent` false at a source, or
    true at a destination; `predicate` is the fluent's spatial predicate, or its name.
    """

    word: str
    moved: int
    fluent: Atom
    predicate: str


def ways_of_actions(
    facts: Facts, predicates: Mapping[str, Any], robots: Set[str]
) -> dict[Signature, dict[str, dict[int, Way]]]:
    """Return, for each signature and each of its actions, the source and destination arguments by position.

    `predicates` maps fluents to spatial predicates, where the names differ.

    The action makes a binary fluent false or true; its second argument is the place, and its first argument is an
    earlier argument of the action. The first argument is not a robot, and the fluent's predicate is not about a robot,
    unless the action makes the fluent false for one place and true for another: then the robot moves itself.
    """
    from prag_asp.scene.predicate_names import PREDICATE_ROLES  # noqa: PLC0415 - not needed for counting

    found: dict[Signature, dict[str, dict[int, Way]]] = {}
    atom = cache(atom_of)  # actions share their effects
    for action in facts.declared_actions:
        name, arguments = atom(action)
        here = found.setdefault((name, len(arguments)), {}).setdefault(str(action), {})
        effects = [(atom(fluent), value) for fluent, value in facts.postconditions.get(action, ())]
        moves = [(fluent, value) for fluent, value in effects if len(fluent.arguments) == 2]
        changes = Counter((fluent.name, fluent.arguments[0], value) for fluent, value in moves)
        for fluent, value in effects:
            if fluent.name in PLACES_OF_ROBOT and len(fluent.arguments) == 1 and fluent.arguments[0] in arguments:
                here[arguments.index(fluent.arguments[0])] = Way(
                    "to" if value == "true" else "from", -1, fluent, fluent.name
                )
        for fluent, value in moves:
            subject, landmark = fluent.arguments
            if value == "unknown" or subject not in arguments or landmark not in arguments:
                continue
            predicate = str(predicates.get(fluent.name, fluent.name))
            itself = PREDICATE_ROLES.get(predicate, ())[:1] == ("robot",) or subject in robots
            if itself and not all(changes[fluent.name, subject, each] == 1 for each in ("true", "false")):
                continue
            place = len(arguments) - 1 - arguments[::-1].index(landmark)
            moved = arguments.index(subject)
            if moved < place and (value == "true" or place not in here):
                here[place] = Way("to" if value == "true" else "from", -1 if itself else moved, fluent, predicate)
    return found


def common_ways(ways_of: Iterable[Mapping[int, Way]]) -> dict[int, Way]:
    """Return the ways that all actions of a signature have in common: the same word at the same position."""

    def shared(both: Mapping[int, Way], here: Mapping[int, Way]) -> dict[int, Way]:
        return {
            place: way._replace(moved=max(way.moved, here[place].moved))
            for place, way in both.items()
            if place in here and here[place].word == way.word
        }

    each = [dict(ways) for ways in ways_of]
    return reduce(shared, each) if each else {}

"""A problem without variables: its objects with their kinds, its initial facts, and its goal."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from prag_asp.atom import Atom
from prag_asp.bddl.bddl_problem import BddlProblem, facts_of
from prag_asp.bddl.ground_goals import FactValue, GroundFormula, fact_values, ground_goal, literal_of
from prag_asp.errors import DomainError

ROOM, AGENT = "inroom", "agent"
"""The predicate with which BEHAVIOR places fixtures, and the class of its robot up to the first dot."""

LOCATIONS = {"on": False, "ontop": False, "in": True, "inside": True}
"""The predicates that state where an object is, each with a flag that is true if the object is within a place, and thus
behind the door of that place, if it has one.
"""


@dataclass(frozen=True)
class GroundProblem:
    """A problem of a benchmark, whatever its format.

    `kinds` holds the class of each object; the kind of a region consists of its target's kind and its name. `parts`
    holds the regions, each with its target and its name. `movable` are the objects that can be carried.
    """

    name: str
    kinds: Mapping[str, str]
    initial: tuple[FactValue, ...]
    goal: GroundFormula
    language: str = ""
    parts: Mapping[str, tuple[str, str]] = field(default_factory=dict)
    movable: frozenset[str] = frozenset()

    @property
    def true_facts(self) -> frozenset[Atom]:
        """The facts that are true in the initial state."""
        return frozenset(each.fact for each in self.initial if each.value)


def ground_problem(problem: BddlProblem, path: object = "<bddl>") -> GroundProblem:
    """Return a BDDL problem with its variables replaced by objects; `path` is named in messages.

    Raises:
        DomainError: a fact of the initial state or the goal names an undeclared object.
    """
    classes = problem.classes
    regions = problem.region_by_name
    rooms = {fact.terms[1]: "room" for fact, _ in problem.initial if fact.predicate == ROOM and len(fact.terms) == 2}
    region_kinds = {name: f"{each.name}_of_{classes.get(each.target, each.target)}" for name, each in regions.items()}
    kinds = {**rooms, **region_kinds, **classes}
    initial = tuple(dict.fromkeys(literal_of(fact, value) for fact, value in problem.initial))
    goal = ground_goal(problem)
    undeclared = {name: fact.line for fact, _ in problem.initial for name in fact.terms if name not in kinds}
    undeclared |= {
        name: fact.line
        for fact in facts_of(problem.goal)
        for name in fact.terms
        if name not in kinds and not name.startswith("?")
    }
    for name, line in undeclared.items():
        raise DomainError(f"{path}:{line}: {name} is not an object, fixture or region of the problem; declare it")
    in_rooms = {classes.get(fact.terms[0]) for fact, _ in problem.initial if fact.predicate == ROOM and fact.terms}
    in_rooms -= {
        kinds[each.fact.arguments[0]]
        for each in fact_values(goal)
        if each.fact.name in LOCATIONS and each.fact.arguments
    }
    fixed = {*problem.fixtures.values(), *in_rooms, *(each for each in classes.values() if each.split(".")[0] == AGENT)}
    return GroundProblem(
        problem.name,
        kinds,
        initial,
        goal,
        problem.language,
        {name: (each.target, each.name) for name, each in regions.items()},
        frozenset(name for name, of_class in classes.items() if of_class not in fixed),
    )

"""A problem of a suite with its forms; two problems are the same task if their forms are equal."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

from prag_asp.atom import Atom, atom_of
from prag_asp.audit.canonical_facts import Form, Relation, canonical_form
from prag_asp.bddl.ground_goals import FactValue, GroundFormula, conjuncts, fact_values
from prag_asp.bddl.ground_problems import GroundProblem

if TYPE_CHECKING:
    import clingo

    from prag_asp.domain.load import Domain


@dataclass(frozen=True)
class AuditedProblem:
    """A problem with its suite and its location, which is a file or a row.

    `load` returns its domain with its goal, or is None if it has no actions; problems of one domain may share it.
    `own_fact` maps a fluent of the domain to a fact of the problem. `remarks` holds the mistakes that the reader of the
    problem found, each with its location.
    """

    suite: str
    name: str
    place: str
    problem: GroundProblem
    load: Callable[[], Domain] | None = None
    own_fact: Callable[[clingo.Symbol], Atom] = atom_of
    remarks: tuple[str, ...] = field(default=(), compare=False)

    @property
    def label(self) -> str:
        """The suite and the name."""
        return f"{self.suite}/{self.name}"

    @cached_property
    def goal_form(self) -> Form:
        """The form of the goal, up to renaming objects within a class; only objects in the goal matter."""
        structure = _Structure(self.problem)
        structure.add_goal()
        return structure.form()

    @cached_property
    def task_form(self) -> Form:
        """The form of the goal together with the initial state and all objects."""
        structure = _Structure(self.problem)
        structure.add_goal()
        structure.add_start()
        return structure.form()

    @cached_property
    def goal_facts(self) -> tuple[Relation, ...]:
        """The conjuncts of the goal as relations of objects; a conjunct other than a fact has its form as the label."""
        structure = _Structure(self.problem)
        rows = []
        for each in conjuncts(self.problem.goal):
            if isinstance(each, FactValue):
                rows.append(structure.relation("goal", each))
            else:
                own = _Structure(self.problem)
                own.add_formula(each, None)
                rows.append((repr(own.form()), ()))
        return tuple(rows)


@dataclass
class _Structure:
    """A collector of coloured vertices (objects, and formulas that are not facts) and the relations between them."""

    problem: GroundProblem
    colours: dict[Hashable, str] = field(default_factory=dict)
    relations: list[Relation] = field(default_factory=list)

    def form(self) -> Form:
        return canonical_form(self.colours, self.relations)

    def relation(self, mark: str, literal: FactValue, *before: Hashable) -> Relation:
        """Return a fact as a relation of objects; a region becomes part of the label, and is replaced by its target."""
        label, objects = [mark, "" if literal.value else "not", literal.fact.name], [*before]
        for name in literal.fact.arguments:
            target, region = self.problem.parts.get(name, (name, ""))
            label.append(region)
            objects.append(target)
            kind = self.problem.kinds.get(target, target)
            self.colours.setdefault(target, f"room {target}" if kind == "room" else f"object {kind}")
        return " ".join(label), tuple(objects)

    def add_goal(self) -> None:
        for each in conjuncts(self.problem.goal):
            self.add_formula(each, None)

    def add_formula(self, formula: GroundFormula, parent: Hashable) -> None:
        """Add a formula that is a conjunct of the goal, or a part of the formula `parent`."""
        above = () if parent is None else (parent,)
        if isinstance(formula, FactValue):
            self.relations.append(self.relation("goal", formula, *above))
            return
        vertex = ("formula", len(self.colours))
        self.colours[vertex] = f"formula {formula.low} {formula.high}"
        if parent is not None:
            self.relations.append(("part", (parent, vertex)))
        for part in formula.parts:
            self.add_formula(part, vertex)

    def add_start(self) -> None:
        for fact in self.problem.true_facts:
            self.relations.append(self.relation("start", FactValue(fact)))
        for name, kind in self.problem.kinds.items():
            if name not in self.problem.parts and kind != "room":
                self.colours.setdefault(name, f"object {kind}")


def moved_pairs(problem: GroundProblem) -> Iterator[tuple[str, str]]:
    """Yield the class and the target of each object that a goal moves; a target is a relation to a class or region."""
    for each in fact_values(problem.goal):
        if len(each.fact.arguments) == 2 and each.value:
            yield pair_of(problem, each.fact)


def pair_of(problem: GroundProblem, fact: Atom) -> tuple[str, str]:
    """Return the class of the first argument of a fact, and its relation to the class or region of the second."""
    first, second = fact.arguments
    return problem.kinds.get(first, first), f"{fact.name} {target_kind(problem, second)}"


def target_kind(problem: GroundProblem, name: str) -> str:
    """Return the class of an object, or the region with the class of its target."""
    target, region = problem.parts.get(name, (name, ""))
    kind: Mapping[str, str] = problem.kinds
    return f"{region} of {kind.get(target, target)}" if region else kind.get(name, name)

"""The plans of a given length as a formula in conjunctive normal form, and its DIMACS text."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from weakref import WeakValueDictionary

import clingo

from prag_asp.errors import EngineError
from prag_asp.logic.formula.clark_completion import complete
from prag_asp.logic.formula.clause_builder import TRUE, Literal
from prag_asp.logic.ground.ground_step import unrolled
from prag_asp.logic.ground.rules import GroundRecorder, Rule
from prag_asp.processes.progress_events import stage
from prag_asp.program.grounding import Grounder
from prag_asp.program.predicates import OCCURS, EncodingPredicate
from prag_asp.program.sources import Program


@dataclass(frozen=True)
class Cnf:
    """A formula with exactly one model for each answer set of a program with a given number of steps.

    `literals` holds the literal of every atom; the first variable is true, and represents the facts. `shown` are the
    variables of the atoms ``occurs(A,t)`` or ``_step_name(N,t)``, sorted: they distinguish words. `plans` is the
    formula of which this one is another projection, if any.
    """

    variables: int
    clauses: tuple[tuple[Literal, ...], ...]
    literals: Mapping[clingo.Symbol, Literal]
    shown: tuple[int, ...]
    plans: Cnf | None = field(default=None, repr=False, compare=False)

    def literal(self, symbol: clingo.Symbol) -> Literal:
        """Return the literal of an atom; an atom without rules is false."""
        return self.literals.get(symbol, -TRUE)


_in_use: WeakValueDictionary[tuple[Program, int], Cnf] = WeakValueDictionary()
"""The formulas in use, keyed by program and length, which levels and engines share; they are never modified."""


def plan_cnf(program: Program, length: int, shown: EncodingPredicate = OCCURS) -> Cnf:
    """Return the formula for the answer sets with a given number of steps, projected onto the atoms of a predicate.

    Raises:
        DomainError: clingo cannot ground the program.
        EngineError: the program has no counterpart in clauses: a disjunctive head, or statements other than rules.
    """
    plans = _in_use.get((program, length))
    if plans is None:
        rules, atoms = _unroll(program, length)
        stage("writing clauses")
        completion = complete(rules)
        clauses = completion.clauses
        literals = {symbol: completion.values.get(atom, -TRUE) for symbol, atom in atoms.items()}
        plans = Cnf(clauses.variables, tuple(clauses.clauses), literals, _variables(literals, OCCURS))
        _in_use[program, length] = plans
    return plans if shown == OCCURS else replace(plans, shown=_variables(plans.literals, shown), plans=plans)


def _unroll(program: Program, length: int) -> tuple[list[Rule], dict[clingo.Symbol, int]]:
    """Return the ground rules for all steps of plans of a given length, and the number of each atom."""
    grounder, recorder = Grounder(program), GroundRecorder()
    grounder.control.register_observer(recorder)
    grounder.ground([("base", [])])
    grounder.ground(unrolled(length))
    rules = recorder.all_rules
    unsupported = [each.value for each in recorder.unsupported]
    if any(rule.is_disjunctive for rule in rules):
        unsupported.append("a rule has a disjunction as its head")
    if any(value is not clingo.TruthValue.False_ for value in recorder.externals.values()):
        unsupported.append("the program has an external atom that is not false")
    if unsupported:
        raise EngineError(f"{unsupported[0]}, which has no counterpart in clauses; choose the engine clingo")
    return rules, {atom.symbol: atom.literal for atom in grounder.control.symbolic_atoms}


def _variables(literals: Mapping[clingo.Symbol, Literal], shown: EncodingPredicate) -> tuple[int, ...]:
    """Return the variables of the atoms of a predicate, sorted; facts have no variables."""
    return tuple(sorted(v for symbol, v in literals.items() if abs(v) != TRUE and symbol.match(*shown)))


def dimacs(cnf: Cnf, comments: Sequence[str] = ()) -> Iterator[str]:
    """Yield the lines of a formula in the format that model counters read.

    ``c t pmc`` and ``c p show`` select projected counting, as in the Model Counting Competition (2021 and later); each
    line ``c V ATOM`` gives the atom of variable V.
    """
    yield from (f"c {line}" for line in comments)
    names = {literal: symbol for symbol, literal in cnf.literals.items() if literal != TRUE and literal > 0}
    yield from (f"c {variable} {names[variable]}" for variable in sorted(names))
    yield "c t pmc"
    yield f"p cnf {cnf.variables} {len(cnf.clauses)}"
    yield " ".join(["c p show", *map(str, cnf.shown), "0"])
    yield from (" ".join([*map(str, clause), "0"]) for clause in cnf.clauses)

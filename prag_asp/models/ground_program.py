"""A program as clingo's ground rules, with its shown symbols and projection atoms."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import clingo

from prag_asp.logic.ground.rules import Condition, GroundRecorder, Rule, Unsupported
from prag_asp.models.program_reader import GivenProgram
from prag_asp.program.grounding import REMARKS, Grounder
from prag_asp.program.problem import allowed_in_sources


@dataclass(frozen=True)
class GroundModels:
    """The ground rules of a program.

    `names` holds the atoms by their symbols, sorted, and `shown` holds the shown symbols, sorted, each with alternative
    conditions. `projected` holds the atoms of ``#project``, or is None if there is no such statement. `acyclic` is true
    if a graph must be acyclic (``#edge``), which rules do not express; `contested` holds the externals that are not
    false and that rules also derive. `minimized` holds the weighted literals of each priority, highest first. `notes`
    are clingo's notes on instances that are dropped because an operation is undefined, and `remarks` are its notes on
    atoms that no rule derives, unless their line has a comment ``% lint: allow undefined``. `grounder` holds the ground
    program, without optimisation.
    """

    rules: tuple[Rule, ...]
    names: tuple[tuple[clingo.Symbol, int], ...]
    shown: tuple[tuple[clingo.Symbol, tuple[Condition, ...]], ...]
    projected: frozenset[int] | None
    acyclic: bool
    contested: frozenset[int]
    minimized: tuple[tuple[int, tuple[tuple[int, int], ...]], ...]
    notes: tuple[str, ...]
    remarks: tuple[str, ...]
    grounder: Grounder = field(repr=False, compare=False)

    @cached_property
    def facts(self) -> frozenset[int]:
        """The atoms of facts."""
        single = (rule for rule in self.rules if not rule.body and not rule.choice and len(rule.heads) == 1)
        return frozenset(rule.heads[0] for rule in single)

    @property
    def projection_variables(self) -> frozenset[int]:
        """The projection variables and the facts, which are constant."""
        if self.projected is not None:
            return self.projected | self.facts
        single = (conditions[0] for _, conditions in self.shown if len(conditions) == 1)
        shown = {abs(condition[0]) for condition in single if len(condition) == 1}
        return self.facts | shown


def ground_models(given: GivenProgram) -> GroundModels:
    """Ground the part `base` of a program, as clingo does by default.

    An ``#external`` is false unless it is declared ``[true]`` or ``[free]``. If a rule derives the atom, clingo ignores
    the statement, unless the rule is simplified away, for example because of an earlier rule.

    Raises:
        DomainError: clingo cannot ground the program.
    """
    recorder = GroundRecorder()
    grounder = given.grounder(REMARKS, "--opt-mode=ignore", "--stats=2", observer=recorder)
    grounder.ground([("base", [])])
    # atom 0 stands for symbols that no rule can derive
    names = sorted((atom.symbol, atom.literal) for atom in grounder.control.symbolic_atoms if atom.literal)
    shown = sorted((symbol, tuple(dict.fromkeys(conditions))) for symbol, conditions in recorder.shown.items())
    projected = None if recorder.projected is None else frozenset(recorder.projected)
    values = {clingo.TruthValue.True_: False, clingo.TruthValue.Free: True}
    either = {atom: values[value] for atom, value in recorder.externals.items() if value in values}
    stated = recorder.all_rules
    rules = (*stated, *(Rule((atom,), (), free) for atom, free in either.items()))
    minimized = sorted(((each, tuple(sums)) for each, sums in recorder.minimized.items()), reverse=True)
    contested = frozenset(head for rule in stated for head in rule.heads) & either.keys()
    acyclic = Unsupported.ACYCLIC in recorder.unsupported
    allowed = allowed_in_sources(given.program.sources)
    remarks = (each for each in grounder.remarks if each.name not in allowed.get((each.path, each.line), ()))
    told = tuple(f"{each.path}:{each.line}: info: {each.text} [{each.name}]" for each in remarks)
    return GroundModels(
        rules,
        tuple(names),
        tuple(shown),
        projected,
        acyclic,
        contested,
        tuple(minimized),
        tuple(grounder.notes),
        told,
        grounder,
    )

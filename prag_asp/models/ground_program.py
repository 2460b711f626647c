"""A program as ground rules, exactly as clingo made them, with what it shows and what it projects on."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import clingo

from prag_asp.logic.ground.rules import Condition, GroundRecorder, Rule, Unsupported
from prag_asp.models.program_reader import GivenProgram
from prag_asp.program.grounding import Grounder


@dataclass(frozen=True)
class GroundModels:
    """The ground rules of a program.

    `names` are its atoms by their symbols, sorted, and `shown` what is printed of an answer set, sorted, each with the
    conditions of which one has to hold. `projected` are the atoms of ``#project``, None where there is no such
    statement. `acyclic` says whether a graph has to be (``#edge``), which no rule expresses; `contested` are the
    externals that are not false, but that rules derive, too. `notes` are what clingo remarks: instances that it leaves
    out since an operation has no value.
    """

    rules: tuple[Rule, ...]
    names: tuple[tuple[clingo.Symbol, int], ...]
    shown: tuple[tuple[clingo.Symbol, tuple[Condition, ...]], ...]
    projected: frozenset[int] | None
    acyclic: bool
    contested: frozenset[int]
    notes: tuple[str, ...]

    @cached_property
    def facts(self) -> frozenset[int]:
        """The atoms that every answer set has, by a rule without a body."""
        single = (rule for rule in self.rules if not rule.body and not rule.choice and len(rule.heads) == 1)
        return frozenset(rule.heads[0] for rule in single)

    @property
    def projection_variables(self) -> frozenset[int]:
        """The projection variables, and facts, which have one value anyhow."""
        if self.projected is not None:
            return self.projected | self.facts
        shown = {abs(found[0][0]) for _, found in self.shown if len(found) == 1 and len(found[0]) == 1}
        return self.facts | shown


def ground_models(given: GivenProgram) -> GroundModels:
    """Ground the part `base` of a program, as clingo does where it is run on its files.

    An ``#external`` is false, as clingo takes it, unless it says ``[true]`` or ``[free]``. One that a rule derives is
    none to clingo, but where it simplifies that rule away, even for another that stands before it.

    Raises:
        DomainError: clingo cannot ground it.
    """
    grounder, recorder = Grounder(given.program, *given.arguments, strict=False), GroundRecorder()
    grounder.control.register_observer(recorder)
    grounder.ground([("base", [])])
    # What clingo has come across, but no rule can derive, is atom 0.
    names = sorted((atom.symbol, atom.literal) for atom in grounder.control.symbolic_atoms if atom.literal)
    shown = sorted((symbol, tuple(dict.fromkeys(found))) for symbol, found in recorder.shown.items())
    projected = None if recorder.projected is None else frozenset(recorder.projected)
    values = {clingo.TruthValue.True_: False, clingo.TruthValue.Free: True}
    either = {atom: values[value] for atom, value in recorder.externals.items() if value in values}
    stated = recorder.all_rules
    rules = (*stated, *(Rule((atom,), (), free) for atom, free in either.items()))
    contested = frozenset(head for rule in stated for head in rule.heads) & either.keys()
    acyclic = Unsupported.ACYCLIC in recorder.unsupported
    return GroundModels(rules, tuple(names), tuple(shown), projected, acyclic, contested, tuple(grounder.notes))

"""A program as ground rules, exactly as clingo made them, with what it shows and what it projects on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import clingo

from prag_asp.logic.ground.ground_step import Rule
from prag_asp.models.program_reader import GivenProgram
from prag_asp.program.grounding import Grounder

Condition = tuple[int, ...]
"""Literals that have to be true together."""


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
    def telling(self) -> frozenset[int]:
        """The atoms whose values a projection tells, and facts, which have one value anyhow."""
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
    grounder, recorder = Grounder(given.program, *given.arguments, strict=False), _Recorder()
    grounder.control.register_observer(recorder)
    grounder.ground([("base", [])])
    # What clingo has come across, but no rule can derive, is atom 0.
    names = sorted((atom.symbol, atom.literal) for atom in grounder.control.symbolic_atoms if atom.literal)
    shown = sorted((symbol, tuple(dict.fromkeys(found))) for symbol, found in recorder.shown.items())
    projected = None if recorder.projected is None else frozenset(recorder.projected)
    rules = (*recorder.rules, *recorder.external_rules())
    return GroundModels(
        rules, tuple(names), tuple(shown), projected, recorder.acyclic, recorder.contested, tuple(grounder.notes)
    )


class _Recorder(clingo.Observer):
    """Keeps what clingo grounds."""

    def __init__(self) -> None:
        self.rules: list[Rule] = []
        self.shown: dict[clingo.Symbol, list[Condition]] = {}
        self.projected: set[int] | None = None
        self.acyclic = False
        self._externals: dict[int, clingo.TruthValue] = {}

    def rule(self, choice: bool, head: Sequence[int], body: Sequence[int]) -> None:
        self.rules.append(Rule(_once(head), tuple(body), choice))

    def weight_rule(self, choice: bool, head: Sequence[int], lower_bound: int, body: Sequence[tuple[int, int]]) -> None:
        if lower_bound <= 0:
            self.rules.append(Rule(_once(head), (), choice))
        elif body:
            literals, weights = zip(*body, strict=True)
            self.rules.append(Rule(_once(head), literals, choice, lower_bound, weights))

    def output_atom(self, symbol: clingo.Symbol, atom: int) -> None:
        self.shown.setdefault(symbol, []).append((atom,) if atom else ())

    def output_term(self, symbol: clingo.Symbol, condition: Sequence[int]) -> None:
        self.shown.setdefault(symbol, []).append(tuple(condition))

    def project(self, atoms: Sequence[int]) -> None:
        self.projected = (self.projected or set()) | {atom for atom in atoms if atom}

    def external(self, atom: int, value: clingo.TruthValue) -> None:
        self._externals[atom] = value

    def acyc_edge(self, node_u: int, node_v: int, condition: Sequence[int]) -> None:
        self.acyclic = True

    @property
    def free(self) -> dict[int, bool]:
        """The externals that are not false, and whether they may have either value."""
        values = {clingo.TruthValue.True_: False, clingo.TruthValue.Free: True}
        return {atom: values[value] for atom, value in self._externals.items() if value in values}

    @property
    def contested(self) -> frozenset[int]:
        """The externals that are not false, but that rules derive, too."""
        return frozenset(head for rule in self.rules for head in rule.heads) & self.free.keys()

    def external_rules(self) -> list[Rule]:
        """Return rules for the externals that are not false."""
        return [Rule((atom,), (), free) for atom, free in self.free.items()]


def _once(heads: Sequence[int]) -> tuple[int, ...]:
    return tuple(dict.fromkeys(heads))

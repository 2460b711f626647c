"""Ground rules, and the observer that records the statements that clingo grounds."""

from __future__ import annotations

from collections.abc import Sequence
from enum import Enum
from typing import NamedTuple

import clingo

BASE = "base"
"""The name of the program part that is grounded first."""

Condition = tuple[int, ...]
"""Literals that must all be true."""


class Unsupported(Enum):
    """Ground statements that rules cannot express."""

    MINIMIZE = "the program minimizes a sum"
    ACYCLIC = "the program has a graph that must stay acyclic"
    THEORY = "the program uses a theory"


class Rule(NamedTuple):
    """A ground rule: some head follows if the weights of the true body literals sum to at least `bound`.

    Literals are atoms, negative if negated. Without `weights`, all literals of the body must be true.
    """

    heads: tuple[int, ...]
    body: tuple[int, ...]
    choice: bool = False
    bound: int = 0
    weights: tuple[int, ...] = ()

    @property
    def is_disjunctive(self) -> bool:
        """Whether the rule derives one of several heads."""
        return len(self.heads) > 1 and not self.choice


class GroundRecorder(clingo.Observer):
    """An observer that records the ground statements of a control.

    `rules` holds the rules of each program part; the caller sets `part` before it grounds a part. Without `base_facts`,
    facts of the base part are not recorded. `shown` holds the conditions under which a symbol is shown; `projected`
    holds the atoms of ``#project``, or is None if there is no such statement. `externals` holds the last value of each
    external atom, `minimized` the weighted literals of each priority.
    """

    def __init__(self, *, base_facts: bool = True) -> None:
        self.part = BASE
        self.rules: dict[str, list[Rule]] = {}
        self.shown: dict[clingo.Symbol, list[Condition]] = {}
        self.projected: set[int] | None = None
        self.externals: dict[int, clingo.TruthValue] = {}
        self.minimized: dict[int, list[tuple[int, int]]] = {}
        self.unsupported: dict[Unsupported, None] = {}
        self._base_facts = base_facts

    @property
    def all_rules(self) -> list[Rule]:
        """The rules of all parts."""
        return [rule for rules in self.rules.values() for rule in rules]

    def rule(self, choice: bool, head: Sequence[int], body: Sequence[int]) -> None:
        """Record a rule."""
        if self._base_facts or body or choice or len(head) != 1 or self.part != BASE:
            self._add(head, tuple(body), choice)

    def weight_rule(self, choice: bool, head: Sequence[int], lower_bound: int, body: Sequence[tuple[int, int]]) -> None:
        """Record a rule whose body is a sum, unless the sum cannot reach its bound."""
        if lower_bound <= 0:
            self._add(head, (), choice)
        elif body:
            literals, weights = zip(*body, strict=True)
            self._add(head, literals, choice, lower_bound, weights)

    def output_atom(self, symbol: clingo.Symbol, atom: int) -> None:
        """Record a shown atom; a fact has the number 0."""
        self.shown.setdefault(symbol, []).append((atom,) if atom else ())

    def output_term(self, symbol: clingo.Symbol, condition: Sequence[int]) -> None:
        """Record a shown term."""
        self.shown.setdefault(symbol, []).append(tuple(condition))

    def project(self, atoms: Sequence[int]) -> None:
        """Record projection variables."""
        self.projected = (self.projected or set()) | {atom for atom in atoms if atom}

    def external(self, atom: int, value: clingo.TruthValue) -> None:
        """Record the value of an external atom."""
        self.externals[atom] = value

    def minimize(self, priority: int, literals: Sequence[tuple[int, int]]) -> None:
        """Record terms of the sum to minimize at a priority, as literals with their weights."""
        self.minimized.setdefault(priority, []).extend(literals)
        self.unsupported[Unsupported.MINIMIZE] = None

    def acyc_edge(self, *_: object) -> None:
        """Record that there is a graph that must stay acyclic."""
        self.unsupported[Unsupported.ACYCLIC] = None

    def theory_atom(self, *_: object) -> None:
        """Record that there is a theory."""
        self.unsupported[Unsupported.THEORY] = None

    def theory_atom_with_guard(self, *_: object) -> None:
        """Record that there is a theory."""
        self.unsupported[Unsupported.THEORY] = None

    def _add(self, head: Sequence[int], body: Condition, choice: bool, bound: int = 0, weights: Condition = ()) -> None:
        """Add a rule; a disjunction may list an atom twice, and a choice without atoms has no effect."""
        if choice and not head:
            return
        heads = tuple(head) if len(head) < 2 else tuple(dict.fromkeys(head))
        self.rules.setdefault(self.part, []).append(Rule(heads, body, choice, bound, weights))

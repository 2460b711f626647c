"""The rules that derive the ground atoms of the base part, which clingo does not record."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

import clingo
from clingo.ast import ASTType

from prag_asp.program.syntax import Statement

TRACE = "_stated"
VIOLATED = "_violated"


class RulePlace(NamedTuple):
    """A file and a line in it."""

    path: Path
    line: int


class Origins:
    """The lines of the rules that derive the atoms of the base part, which is grounded once more on first use."""

    def __init__(self, statements: Sequence[Statement]) -> None:
        self._statements = statements
        self._marked: dict[str, list[int]] = {}
        """The numbers of the rules with each predicate in the head, for predicates whose atoms have been marked."""

    @cached_property
    def _base(self) -> list[Statement]:
        return [each for each in self._statements if each.part == "base" and each.kind != ASTType.Program]

    @cached_property
    def _control(self) -> clingo.Control:
        """The ground base part, without constraints."""
        control = clingo.Control(["--warn=none"], logger=lambda *_: None)
        control.add("base", [], "\n".join(each.text for each in self._base if not each.is_rule or each.heads))
        control.ground([("base", [])])
        return control

    def _mark(self, predicate: str) -> list[int]:
        """Mark the atoms of a predicate with the numbers of the rules that derive them; return these numbers."""
        lines: list[str] = []
        numbers: list[int] = []
        for number, statement in enumerate(self._base):
            if statement.is_rule and statement.node.head.ast_type == ASTType.Literal:
                body = "; ".join(text for _, text in statement.literals) or "#true"
                heads = [(atom.name.lstrip("-"), str(atom).lstrip("-")) for atom in statement.heads] or [
                    (VIOLATED, VIOLATED)
                ]
                own = [f"{TRACE}({number},{stated}) :- {body}." for name, stated in heads if name == predicate]
                lines += own
                numbers += [number] if own else []
        part = f"{TRACE}_{predicate}"
        try:
            self._control.add(part, [], "\n".join(lines))
            self._control.ground([(part, [])])
        except RuntimeError:
            return []
        return numbers

    def _deriving(self, predicate: str, arguments: Sequence[clingo.Symbol] = ()) -> Iterator[Statement]:
        """Yield the rules that derive an atom."""
        if predicate not in self._marked:
            self._marked[predicate] = self._mark(predicate)
        atom = clingo.Function(predicate, arguments)
        for number in self._marked[predicate]:
            if self._control.symbolic_atoms[clingo.Function(TRACE, [clingo.Number(number), atom])] is not None:
                yield self._base[number]

    def place(self, predicate: str, *arguments: clingo.Symbol) -> RulePlace:
        """Return the file and line of the first rule that derives an atom or, if there is none, its predicate."""
        traced = next(self._deriving(predicate, arguments), None)
        if traced:
            return RulePlace(traced.path, traced.line)
        own = [each for each in self._statements if each.own] or list(self._statements)
        stating = [each for each in own if any(atom.name == predicate for atom in each.heads)]
        return RulePlace(stating[0].path, stating[0].line) if stating else RulePlace(own[0].path, 1)

    def violated(self) -> list[Statement]:
        """Return the author's constraints in the base part that its facts violate."""
        return [each for each in self._deriving(VIOLATED) if each.own]

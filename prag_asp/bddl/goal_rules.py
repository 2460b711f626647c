"""Write rules for goals that are not conjunctions of facts; they count the parts that are true in the final state."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import count

from prag_asp.atom import Atom
from prag_asp.bddl.ground_goals import FactValue, GroundFormula, Threshold
from prag_asp.pddl.program_text import statement


def goal_rules(formulas: Sequence[GroundFormula], fluent: Callable[[Atom], str], body: str, problem: str) -> list[str]:
    """Return rules for ``#program check(t).`` that require formulas in the final state if condition `body` holds."""
    if not formulas:
        return []
    writer = _GoalRules(fluent, problem)
    atoms = [writer.atom(each) for each in formulas]
    tests = [statement("", [*([body] if body else []), f"not {atom}"]).strip() for atom in atoms]
    return ["", "#program check(t).", *dict.fromkeys(writer.lines), *tests]


@dataclass
class _GoalRules:
    """A collector of rules for `satisfied(P,N,t)`: formula N of problem P is true in the final state."""

    fluent: Callable[[Atom], str]
    problem: str
    lines: list[str] = field(default_factory=list)
    atoms: dict[GroundFormula, str] = field(default_factory=dict)
    numbers: Iterator[int] = field(default_factory=lambda: count(1))

    def atom(self, formula: GroundFormula) -> str:
        """Return an atom that is true if a formula is true, and add the rules that define the atom."""
        if isinstance(formula, FactValue):
            return f"holds({self.fluent(formula.fact)},{str(formula.value).lower()},t)"
        if formula not in self.atoms:
            number = next(self.numbers)
            self.atoms[formula] = f"satisfied({self.problem},{number},t)"
            self.lines += self.rules(self.atoms[formula], formula, number)
        return self.atoms[formula]

    def rules(self, head: str, formula: Threshold, number: int) -> list[str]:
        """Return the rules that count true parts; `true_parts(P,N,I,J,t)`: at least J of the first I parts are true."""
        parts = [self.atom(each) for each in formula.parts]
        if formula.low == formula.high == len(parts):
            return [statement(head, parts)]
        if formula.low == 1 and formula.high == len(parts):
            return [statement(head, [each]) for each in parts] or [f"{head} :- #false."]
        rows: list[str] = []

        def reached(index: int, least: int) -> str:
            return f"true_parts({self.problem},{number},{index},{least},t)"

        limit = min(len(parts), formula.high + 1)
        for index, part in enumerate(parts, 1):
            for least in range(1, min(index, limit) + 1):
                before = [reached(index - 1, least - 1)] if least > 1 else []
                rows.append(statement(reached(index, least), [*before, part]))
                if least < index:
                    rows.append(statement(reached(index, least), [reached(index - 1, least)]))
        total = len(parts)
        enough = [reached(total, formula.low)] if formula.low else []
        too_many = [f"not {reached(total, formula.high + 1)}"] if formula.high < total else []
        return [*rows, statement(head, [*enough, *too_many])]

"""The lines of a program that together exclude all plans of a given length."""

from __future__ import annotations

from collections.abc import Sequence
from types import TracebackType

import clingo

from prag_asp.logic.formula.clause_builder import TRUE, Literal
from prag_asp.logic.formula.cnf import plan_cnf
from prag_asp.logic.formula.liftable import KEPT, LOOSE, RestrictingLine, make_liftable
from prag_asp.logic.formula.solver import Solver, smallest_conflict
from prag_asp.logic.ground.ground_step import unrolled
from prag_asp.processes.progress_events import stage
from prag_asp.processes.workers import uninterrupted
from prag_asp.program.grounding import Grounder
from prag_asp.program.predicates import OCCURS
from prag_asp.program.sources import Program

Occurring = Sequence[tuple[clingo.Symbol, int]]
"""Actions, each with the number of its step, from 1."""


def has_plan(program: Program, length: int, occurring: Occurring | None = None) -> bool:
    """Return whether a program has a plan of a given length.

    With `occurring`, a plan counts only if one of these actions occurs in it at its step.

    Raises:
        DomainError: clingo cannot ground the program.
    """
    grounder = Grounder(program)
    grounder.ground([("base", [])])
    grounder.ground(unrolled(length))
    control, assumptions = grounder.control, []
    if occurring is not None:
        atoms = control.symbolic_atoms
        occurrences = (atoms[_occurs(action, step)] for action, step in occurring)
        with control.backend() as backend:
            some = backend.add_atom()
            for atom in occurrences:
                if atom is not None:
                    backend.add_rule([some], [atom.literal])
        assumptions = [some]
    stage("looking for a plan")
    with uninterrupted():  # an error in a callback of clingo ends the process
        return bool(control.solve(assumptions=assumptions).satisfiable)


class LiftableLines:
    """The lines of a program that restrict its plans of a given length, each of which can be lifted.

    With `occurring`, a plan counts only if one of these actions occurs in it at its step.

    Raises:
        DomainError: clingo cannot ground the program.
        EngineError: the program has no counterpart in clauses.
    """

    def __init__(self, program: Program, length: int, occurring: Occurring | None = None) -> None:
        liftable = make_liftable(program)
        cnf = plan_cnf(liftable.program, length)
        literals = [cnf.literal(clingo.Function(KEPT, [clingo.Number(i)])) for i in range(len(liftable.lines))]
        self._lines = dict(zip(literals, liftable.lines, strict=True))
        self._loose = cnf.literal(clingo.Function(LOOSE))
        self._solver = Solver(cnf.variables, cnf.clauses)
        if occurring is not None:
            self._solver.add([-TRUE, *(cnf.literal(_occurs(action, step)) for action, step in occurring)])
        stage("looking for the lines")

    def __enter__(self) -> LiftableLines:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self._solver.close()

    def conflict(self, *, smallest: bool = False) -> tuple[RestrictingLine, ...]:
        """Return a minimal set of lines that together exclude all plans; there must be no plan.

        All other lines are lifted: the fluents that they change may have any value. With `smallest`, no smaller set
        excludes all plans, provided that lifting a line only adds plans.
        """
        literals, again = list(self._lines), True
        if smallest:
            literals = smallest_conflict(self._solver, [self._loose], literals)
        # Lines are removed one by one until none can be removed. A line may become removable once others have been
        # removed.
        while again:
            again = False
            for each in list(literals):
                rest = [at for at in literals if at != each]
                if each in literals and not self._open(rest):
                    core = set(self._solver.core())
                    fewer = [at for at in rest if at in core]
                    literals = rest if len(fewer) == len(rest) or self._open(fewer) else fewer
                    again = True
        return self._lines_of(literals)

    def changes(self) -> tuple[tuple[RestrictingLine, ...], ...]:
        """Return the single lines whose removal allows a plan, or otherwise one smallest set whose removal does.

        A removed line has no effect at all. The result is empty if there is no plan even without all lines. A smallest
        set hits every set of lines that excludes all plans. Therefore smallest hitting sets of the known sets are tried
        until there is a plan (Reiter, "A theory of diagnosis from first principles", 1987).
        """
        single = [each for each in self._lines if self._open([at for at in self._lines if at != each], loose=False)]
        if single:
            return tuple((line,) for line in self._lines_of(single))
        from pysat.examples.hitman import Hitman  # noqa: PLC0415

        with Hitman(solver="g4") as hitting:
            removed: list[Literal] = []
            while not self._solver.satisfiable([-self._loose, *(each for each in self._lines if each not in removed)]):
                core = [each for each in self._solver.core() if each in self._lines]
                if not core:
                    return ()
                hitting.hit(core)
                removed = sorted(hitting.get(), key=abs)
        model = self._solver.model()
        return (self._lines_of([each for each in removed if model[abs(each) - 1] < 0]),)

    def _lines_of(self, literals: Sequence[Literal]) -> tuple[RestrictingLine, ...]:
        """Return the lines of the given literals, sorted by file and line."""
        return tuple(sorted((self._lines[each] for each in literals), key=lambda at: (at.path, at.line, at.text)))

    def _open(self, literals: Sequence[Literal], *, loose: bool = True) -> bool:
        """Return whether there is a plan if only the given lines hold."""
        lifted = self._lines.keys() - literals
        loose_literal = self._loose if loose else -self._loose
        return self._solver.satisfiable([loose_literal, *literals, *(-each for each in lifted)])


def _occurs(action: clingo.Symbol, step: int) -> clingo.Symbol:
    return OCCURS(action, clingo.Number(step))

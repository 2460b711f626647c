"""The answer sets of a ground program, or their projections, as the projected models of a formula."""

from __future__ import annotations

from dataclasses import dataclass

import clingo

from prag_asp.logic.formula.clark_completion import Completion, complete
from prag_asp.logic.formula.clause_builder import TRUE, Literal
from prag_asp.logic.formula.cnf import Cnf
from prag_asp.models.ground_program import GroundModels
from prag_asp.models.shifting import shift_disjunctions
from prag_asp.processes.progress_events import stage


@dataclass(frozen=True)
class ModelFormula:
    """A formula, with the symbols that its models show.

    `cnf.shown` are the projection variables, which distinguish answer sets or their projections. `printed` holds the
    symbols that may be shown, sorted, each with its literal. If `whole` is true, all other variables are functions of
    `cnf.shown`.
    """

    completion: Completion
    cnf: Cnf
    printed: tuple[tuple[clingo.Symbol, Literal], ...]
    whole: bool


def model_formula(ground: GroundModels, *, project: bool, copied: bool, sums_apart: bool = False) -> ModelFormula:
    """Return the formula for a head-cycle-free program.

    With `copied`, atoms in loops have copies (see `clark_completion`), and the models without open copies are the
    answer sets. With `project`, answer sets that agree on the atoms of ``#project`` (or, without such a statement, on
    the shown symbols) count as one, as with clingo's option ``--project``. These atoms are then the printed symbols.
    With `sums_apart`, the clauses do not define the sums (see `ClauseBuilder`).
    """
    stage("writing clauses")
    completion = complete(shift_disjunctions(ground.rules), copied=copied, sums_apart=sums_apart)
    clauses, value = completion.clauses, completion.value

    names = {symbol: value(atom) for symbol, atom in ground.names}
    if project and ground.projected is not None:
        printed = [(symbol, value(atom)) for symbol, atom in ground.names if atom in ground.projected]
        projection = list(map(value, ground.projected))  # in aspif, some atoms have no names
    else:
        printed = [
            (symbol, clauses.any_of([clauses.all_of(map(value, condition)) for condition in conditions]))
            for symbol, conditions in ground.shown
        ]
        projection = [literal for _, literal in printed] if project else list(completion.values.values())
    shown = tuple(sorted({abs(literal) for literal in projection} | {TRUE}))
    cnf = Cnf(clauses.variables, tuple(clauses.clauses), names, shown)
    return ModelFormula(completion, cnf, tuple(printed), whole=not project)

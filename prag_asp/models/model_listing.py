"""The models of a formula one by one, lazily and in a fixed order."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import closing

from prag_asp.logic.formula.clause_builder import TRUE, Literal
from prag_asp.models.answer_set_formula import ModelFormula
from prag_asp.models.foundedness import FoundednessOracle


def list_models(formula: ModelFormula, order: Sequence[Literal]) -> Iterator[list[Literal]]:
    """Yield the values of the literals of `order` in models, each combination once, true before false.

    Each literal of a model takes one solver call to decide whether another model first differs there.
    """
    # Keep one of a literal and its negation, because a symbol may be shown exactly if another is not.
    first = {abs(literal): literal for literal in reversed(order) if abs(literal) != TRUE}
    order = [literal for literal in dict.fromkeys(order) if first.get(abs(literal)) == literal]
    with closing(FoundednessOracle(formula.completion)) as oracle:
        model = oracle.model()
        if model is None:
            return
        chosen: list[Literal] = []
        while True:
            while len(chosen) < len(order):  # find the first model with this prefix
                literal = order[len(chosen)]
                if (model[abs(literal) - 1] > 0) != (literal > 0):
                    model = oracle.model([*chosen, literal]) or model
                true = (model[abs(literal) - 1] > 0) == (literal > 0)
                chosen.append(literal if true else -literal)
            yield [*chosen]
            following = None
            while chosen and following is None:
                literal = chosen.pop()
                if literal == order[len(chosen)]:
                    following = oracle.model([*chosen, -literal])
                    if following is not None:
                        chosen.append(-literal)
            if following is None:
                return
            model = following

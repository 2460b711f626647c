"""The conversion of action costs to weights: each unit of cost multiplies an action's weight by the same factor."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from decimal import MAX_EMAX, MAX_PREC, MIN_EMIN, Context, Decimal
from fractions import Fraction

from prag_asp.errors import DomainError, QueryError
from prag_asp.pddl.definitions import DomainFile, ProblemFile
from prag_asp.pddl.formulas import FunctionTerm, Variable, conjuncts, function_terms
from prag_asp.pddl.reading.comparisons import quantity_value
from prag_asp.pddl.reading.scopes import TOTAL

DIGITS = 2000
"""The maximum number of digits after the decimal point in a weight."""

LONGEST = 100
"""The maximum number of characters in a factor."""

EXACT = Context(prec=MAX_PREC, Emax=MAX_EMAX, Emin=MIN_EMIN)
"""The decimal context for exact sums, which keep all digits of their terms."""

MOST_COST = 10_000
"""The largest cost that is converted to a weight; the power of a factor has about this number of digits."""


def factor_of(text: str) -> Fraction:
    """Parse a factor.

    Raises:
        QueryError: the text is not a number above 0 and at most 1, or has too many digits.
    """
    if len(text) > LONGEST or re.search(r"e[+-]?\d{4}", text.replace("_", ""), re.IGNORECASE):
        raise QueryError(f"factor {text}: it has too many digits; write a shorter one, such as 1/2 or 0.8")
    try:
        factor = Fraction(text)
    except (ValueError, ZeroDivisionError):
        factor = Fraction(0)
    if not 0 < factor <= 1:
        raise QueryError(f"factor {text}: write a number above 0 and at most 1, such as 1/2 or 0.8")
    return factor


def cost_of(domain: DomainFile, problem: ProblemFile, action: str, terms: Sequence[str]) -> Decimal:
    """Return the cost that a ground action adds to ``total-cost``; `action` is the name of its schema.

    Raises:
        DomainError: the cost depends on the state, has no value in the problem, or has no finite decimal expansion.
    """
    schema = next(each for each in domain.actions if each.name == action)
    objects = dict(zip((each.name for each in schema.parameters), terms, strict=True))
    changed = {effect.function.function for each in domain.actions for effect in each.numeric}
    total = Fraction(0)
    for effect in schema.numeric:
        if effect.function.function != TOTAL:
            continue
        functions = [*function_terms(effect.value)]
        constant = not effect.variables and next(conjuncts(effect.condition), None) is None
        if not constant or effect.operator != "increase" or any(each.function in changed for each in functions):
            raise DomainError(f"{action}: its cost depends on the state, so it has no weight; leave --cost-factor out")
        values: dict[FunctionTerm, Fraction] = {}
        for each in functions:
            names = tuple(objects[term.name] if isinstance(term, Variable) else term for term in each.terms)
            if (each.function, names) not in problem.values:
                text = " ".join([each.function, *names])
                raise DomainError(f"{action}: the problem has no value for ({text}), its cost; state it in :init")
            values[each] = problem.values[each.function, names]
        value = quantity_value(effect.value, values)
        if value is None:
            raise DomainError(f"{action}: its cost divides by 0; correct it")
        total += value
    return _decimal(action, total)


def _decimal(action: str, cost: Fraction) -> Decimal:
    """Return a cost as an exact decimal."""
    rest, digits = cost.denominator, 0
    for prime in (2, 5):
        exponent = 0
        while rest % prime == 0:
            rest, exponent = rest // prime, exponent + 1
        digits = max(digits, exponent)
    if rest > 1:
        raise DomainError(f"{action}: its cost {cost} has no finite decimal expansion; multiply all costs by a number")
    return Decimal(cost.numerator * 10**digits // cost.denominator).scaleb(-digits, EXACT).normalize(EXACT)


def weight_of_cost(factor: Fraction, cost: Decimal) -> Decimal:
    """Return a factor raised to the power of a cost, exactly.

    Raises:
        QueryError: the cost is not an integer from 0 to `MOST_COST`, or the weight has too many digits.
    """
    if cost < 0:
        raise QueryError(f"cost {cost}: negative costs cannot become weights; add the same number to all")
    if cost != cost.to_integral_value():
        raise QueryError(f"cost {cost}: only integer costs become weights; multiply all costs by the same number")
    if cost > MOST_COST:
        raise QueryError(f"cost {cost:.6g}: costs above {MOST_COST} cannot become weights; divide all by one number")
    exact = Context(prec=DIGITS)
    base = exact.divide(Decimal(factor.numerator), Decimal(factor.denominator))
    if Fraction(base) != factor:
        raise QueryError(f"factor {factor}: its power {cost} has no finite decimal expansion; use one such as 1/2")
    digits = -min(int(base.as_tuple().exponent), 0) * int(cost)
    if digits > DIGITS:
        problem = f"its power {cost} has {digits:,} digits, more than the limit of {DIGITS:,}"
        raise QueryError(f"factor {factor}: {problem}; use one such as 1/2 or 0.9, or divide all costs by a number")
    weight = factor ** int(cost)
    return exact.divide(Decimal(weight.numerator), Decimal(weight.denominator))


def weights_table(weights: Mapping[str, Decimal]) -> str:
    """Return the weights of ground actions as the ``[weights]`` table for a domain.toml."""
    return "".join(["[weights]\n", *(f'"{action}" = {weight:f}\n' for action, weight in weights.items())])

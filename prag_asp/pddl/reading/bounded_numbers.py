"""Numbers that actions change and conditions read, as predicates, one for each possible value of a function.

The values are a least fixpoint within the bounds of `number_bounds`: the values of the initial state, and those that an
action computes from them if its own comparisons hold. The fixpoint contains all reachable values, because objects are
ignored. If it is finite, the translation is exact: in each state, exactly one of the predicates is true for each
function term that has a value.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import combinations, product
from math import prod

from prag_asp.pddl.clingo_names import unused
from prag_asp.pddl.definitions import Declaration, DomainFile, NumericEffect, ProblemFile, Schema, SchemaEffect
from prag_asp.pddl.formulas import (
    Arithmetic,
    Comparison,
    Formula,
    FunctionTerm,
    Junction,
    Literal,
    Quantity,
    certainly_unlike,
    conjuncts,
    function_terms,
    replaced,
    subformulas,
)
from prag_asp.pddl.reading.comparisons import COMPARE, quantity_value
from prag_asp.pddl.reading.number_bounds import SIGNS, is_unconditional, value_bounds
from prag_asp.pddl.reading.pddl_source import PddlSource

MOST_VALUES = 200
"""The maximum number of values of a function, because each becomes a predicate."""

MOST_ROWS = 20_000
"""The maximum number of combinations of values in a comparison or an effect, because each becomes a condition. They
take 20 ms."""

MOST_TRIED = 300_000
"""The maximum number of combinations that are computed in total. They take 5 s."""

Row = dict[FunctionTerm, Fraction]


def bounded(
    source: PddlSource, problem_source: PddlSource, domain: DomainFile, problem: ProblemFile
) -> tuple[DomainFile, ProblemFile]:
    """Return a domain and a problem in which no condition reads a function that an action changes.

    Raises:
        DomainError: such a function has too many values, has no value in the initial state, or is changed twice by the
            same action.
    """
    read = read_functions(domain, problem)
    domain = replace(domain, actions=tuple(joined(each, read) for each in domain.actions))
    effects = [(action, each) for action in domain.actions for each in action.numeric]
    changing = {each.function.function for _, each in effects if each.function.function in read}
    if not changing:
        return domain, problem
    numbers = _Numbers(source, domain, problem, _FunctionValues(source, problem, effects, changing, domain.actions))
    actions = tuple(numbers.schema(each) for each in domain.actions)
    goal = numbers.formula(problem.goal, problem_source)
    derived = tuple(replace(each, formula=numbers.formula(each.formula, source)) for each in domain.derived)
    predicates = {**domain.predicates, **numbers.predicates}
    return (
        replace(domain, actions=actions, derived=derived, predicates=predicates),
        replace(problem, initial=(*problem.initial, *numbers.initial), goal=goal),
    )


def joined(action: Schema, functions: Collection[str]) -> Schema:
    """Return an action that changes each term of the given functions once, by summing its unconditional changes.

    If two changes cancel each other, they are dropped, but the action still requires that every function that they read
    has a value.
    """
    groups: dict[FunctionTerm, list[NumericEffect]] = {}
    for each in action.numeric:
        if each.function.function in functions and is_unconditional(each) and each.operator in SIGNS:
            groups.setdefault(each.function, []).append(each)
    several = [each for changes in groups.values() if len(changes) > 1 for each in changes]
    numeric = [each for each in action.numeric if each not in several]
    needed: list[Formula] = []
    for function, changes in groups.items():
        if len(changes) < 2:
            continue
        sums: Counter[Quantity] = Counter()
        for each in changes:
            sums[each.value] += SIGNS[each.operator]
        terms = dict.fromkeys(term for value in (function, *sums) for term in function_terms(value))
        needed += (Comparison("=", term, term, True, changes[0].line) for term in terms)
        parts: list[Quantity] = [Arithmetic("*", (Fraction(n), value)) for value, n in sums.items() if n]
        if parts:
            numeric.append(
                NumericEffect(
                    (), changes[0].condition, "increase", function, Arithmetic("+", tuple(parts)), changes[0].line
                )
            )
    whole = Junction(True, (action.precondition, *needed), action.line) if needed else action.precondition
    return replace(action, precondition=whole, numeric=tuple(numeric))


def read_functions(domain: DomainFile, problem: ProblemFile) -> set[str]:
    """Return the functions that comparisons read, and the functions that changes to these functions read."""
    formulas = [problem.goal, *(each.formula for each in domain.derived)]
    for action in domain.actions:
        formulas += [action.precondition, *(each.condition for each in action.effects)]
    comparisons = (each for formula in formulas for each in subformulas(formula) if isinstance(each, Comparison))
    read = {term.function for each in comparisons for term in terms_of(each)}
    changes = [each for action in domain.actions for each in action.numeric]
    while True:
        made = [each for each in changes if each.function.function in read]
        conditions = (part for each in made for part in subformulas(each.condition))
        more = {term.function for each in conditions if isinstance(each, Comparison) for term in terms_of(each)}
        more |= {term.function for each in made for term in function_terms(each.value)}
        if more <= read:
            return read
        read |= more


def terms_of(comparison: Comparison) -> dict[FunctionTerm, None]:
    """Return the function terms in a comparison."""
    return dict.fromkeys((*function_terms(comparison.left), *function_terms(comparison.right)))


def holds(comparison: Comparison, values: Mapping[FunctionTerm, Fraction]) -> bool:
    """Return whether a comparison holds, given the values of its functions; it needs all of them."""
    left, right = quantity_value(comparison.left, values), quantity_value(comparison.right, values)
    known = left is not None and right is not None
    return known and COMPARE[comparison.operator](left, right) == comparison.positive  # type: ignore[arg-type]


def _changed(effect: NumericEffect, row: Row) -> Fraction | None:
    """Return the value that a function has after an effect, or None if it has no value."""
    operators = {"increase": "+", "decrease": "-", "scale-up": "*", "scale-down": "/"}
    if effect.operator == "assign":
        return quantity_value(effect.value, row)
    return quantity_value(Arithmetic(operators[effect.operator], (effect.function, effect.value)), row)


class _FunctionValues:
    """The possible values of functions, by name."""

    def __init__(
        self,
        source: PddlSource,
        problem: ProblemFile,
        effects: Iterable[tuple[Schema, NumericEffect]],
        changing: set[str],
        all_actions: Sequence[Schema],
    ) -> None:
        self._source = source
        self.changing = changing
        self._tried = 0
        self._values: dict[str, set[Fraction]] = {}
        for (function, _), value in problem.values.items():
            self._values.setdefault(function, set()).add(value)
        made = [(action, each) for action, each in effects if each.function.function in changing]
        bounds = {name: value_bounds(name, all_actions, problem, changing) for name in changing}
        fresh: dict[str, set[Fraction]] | None = None  # the values that the latest round added
        while fresh is None or any(fresh.values()):
            added: dict[str, set[Fraction]] = {}
            for action, effect in made:
                name = effect.function.function
                known, found = self._values.setdefault(name, set()), added.setdefault(name, set())
                values = (_changed(effect, row) for row in self.rows(effect, action, fresh))
                found |= {each for each in values if each is not None and bounds[name].hold(each)} - known
                if len(known) + len(found) > MOST_VALUES:
                    text = f"{name} takes more than {MOST_VALUES} values, and conditions read it"
                    source.refuse(effect.line, f"{text}; bound its changes by conditions, or write predicates")
            for name, found in added.items():
                self._values[name] |= found
            fresh = added

    def of(self, term: FunctionTerm) -> list[Fraction]:
        """Return the values of a function, in ascending order."""
        return sorted(self._values.get(term.function, ()))

    def rows(
        self, effect: NumericEffect, action: Schema, fresh: Mapping[str, set[Fraction]] | None = None
    ) -> list[Row]:
        """Return the combinations of function values for which an effect may occur.

        With `fresh`, return only the combinations that contain at least one of these values.
        """
        needed = dict.fromkeys(function_terms(effect.value))
        needed |= {} if effect.operator == "assign" else {effect.function: None}
        parts = (*conjuncts(action.precondition), *conjuncts(effect.condition))
        guards = [
            each for each in parts if isinstance(each, Comparison) and not needed.keys().isdisjoint(terms_of(each))
        ]
        further = dict.fromkeys(term for each in guards for term in terms_of(each))
        found: dict[tuple[Fraction, ...], Row] = {}
        for row in self.combinations({**needed, **further}, effect.line, self._source, fresh):
            if all(holds(each, row) for each in guards):
                key = tuple(row[term] for term in needed)
                found.setdefault(key, dict(zip(needed, key, strict=True)))
        return [*found.values()]

    def combinations(
        self,
        terms: Iterable[FunctionTerm],
        line: int,
        source: PddlSource,
        fresh: Mapping[str, set[Fraction]] | None = None,
    ) -> Iterator[Row]:
        """Return the combinations of values of functions; with `fresh`, only those that contain a value of `fresh`."""
        terms = [*terms]
        values = [self.of(each) for each in terms]
        choices = [values]
        if fresh is not None:
            new = [
                [each for each in found if each in fresh.get(term.function, ())]
                for term, found in zip(terms, values, strict=True)
            ]
            old = [
                [each for each in found if each not in added]
                for found, added in zip(values, map(set, new), strict=True)
            ]
            choices = [[*old[:place], new[place], *values[place + 1 :]] for place in range(len(terms))]
        rows = sum(prod(map(len, each)) for each in choices)
        self._tried += rows
        if rows > MOST_ROWS or self._tried > MOST_TRIED:
            source.refuse(line, "its functions take too many values together; bound them by conditions")
        return (dict(zip(terms, row, strict=True)) for each in choices for row in product(*each))


@dataclass
class _Numbers:
    """The predicates that stand for values, in conditions and effects that replace comparisons and changes."""

    source: PddlSource
    domain: DomainFile
    problem: ProblemFile
    values: _FunctionValues

    def __post_init__(self) -> None:
        self.predicates: dict[str, Declaration] = {}
        self._names: dict[tuple[str, Fraction], str] = {}
        for function in sorted(self.values.changing):
            declared = self.domain.functions.get(function, Declaration((), 1))
            for value in self.values.of(FunctionTerm(function, ())):
                name = unused(f"{function}-is-{value}", {*self.domain.predicates, *self.predicates})
                self._names[function, value] = name
                self.predicates[name] = declared
        self.initial = tuple(
            Literal(self._names[function, value], terms, True, 1)
            for (function, terms), value in self.problem.values.items()
            if function in self.values.changing
        )

    def formula(self, formula: Formula, source: PddlSource) -> Formula:
        """Return a formula without comparisons of changing functions."""
        return replaced(formula, lambda part: self._cases(part, source) if isinstance(part, Comparison) else part)

    def _cases(self, comparison: Comparison, source: PddlSource) -> Formula:
        changing = [each for each in terms_of(comparison) if each.function in self.values.changing]
        if not changing:
            return comparison
        still = len(changing) < len(terms_of(comparison))
        cases: list[Formula] = []
        for row in self.values.combinations(changing, comparison.line, source):
            literals = [self._literal(term, value, comparison.line) for term, value in row.items()]
            if still:
                left, right = (_with_values(each, row) for each in (comparison.left, comparison.right))
                rest = replace(comparison, left=left, right=right)
                cases.append(Junction(True, (*literals, rest), comparison.line))
            elif holds(comparison, row):
                cases.append(Junction(True, tuple(literals), comparison.line))
        return Junction(False, tuple(cases), comparison.line)

    def _literal(self, term: FunctionTerm, value: Fraction, line: int, *, positive: bool = True) -> Literal:
        return Literal(self._names[term.function, value], term.terms, positive, line)

    def schema(self, action: Schema) -> Schema:
        """Return an action with its changes as effects on predicates."""
        made = [each for each in action.numeric if each.function.function in self.values.changing]
        for one, other in combinations(made, 2):
            if one.function.function == other.function.function and not certainly_unlike(
                one.function.terms, other.function.terms, action.precondition
            ):
                text = f"{one.function.function} is changed twice by one action, and conditions read it"
                self.source.refuse(other.line, f"{text}; join both changes, or require their objects to differ")
        needed: list[Formula] = []
        effects: list[SchemaEffect] = []
        for effect in made:
            if any(variable not in effect.function.terms for variable in effect.variables):
                text = f"a 'forall' changes {effect.function.function} several times, and conditions read it"
                self.source.refuse(effect.line, f"{text}; write the sum of its changes")
            needed += self._needed(effect)
            effects += self._effects(effect, action)
        effects += (replace(each, condition=self.formula(each.condition, self.source)) for each in action.effects)
        whole = Junction(True, (action.precondition, *needed), action.line)
        return replace(action, precondition=self.formula(whole, self.source), effects=tuple(effects))

    def _needed(self, effect: NumericEffect) -> Iterator[Formula]:
        """Yield the conditions that the functions in an effect have values, without which the effect cannot occur."""
        terms = dict.fromkeys(function_terms(effect.value))
        for term in {**terms, **({} if effect.operator == "assign" else {effect.function: None})}:
            stated = sum(function == term.function for function, _ in self.problem.values)
            declared = self.domain.functions.get(term.function)
            if declared:
                above = [self.domain.above(kind) for kind in self.problem.objects.values()]
                if stated >= prod(sum(not each.isdisjoint(kinds) for each in above) for kinds in declared.types):
                    continue
            if effect.variables or next(conjuncts(effect.condition), None) is not None or not declared:
                text = f"{term.function} has no initial value for all its objects"
                self.source.refuse(effect.line, f"{text}, and a condition reads what it changes; state them in :init")
            yield Comparison("=", term, term, True, effect.line)

    def _effects(self, effect: NumericEffect, action: Schema) -> Iterator[SchemaEffect]:
        condition, term, line = self.formula(effect.condition, self.source), effect.function, effect.line
        known = set(self.values.of(term))
        for row in self.values.rows(effect, action):
            value = _changed(effect, row)
            if value is None:
                self.source.refuse(line, "it divides by 0; exclude this by a condition")
            if value not in known:
                continue
            parts = [condition]
            for each, number in row.items():
                if each.function in self.values.changing:
                    parts.append(self._literal(each, number, line))
                else:
                    parts.append(Comparison("=", each, number, True, line))
            when = Junction(True, tuple(parts), line)
            old = known if effect.operator == "assign" else {row[term]}
            for before in sorted(old - {value}):
                yield SchemaEffect(effect.variables, when, self._literal(term, before, line, positive=False))
            if old != {value}:
                yield SchemaEffect(effect.variables, when, self._literal(term, value, line))


def _with_values(quantity: Quantity, row: Mapping[FunctionTerm, Fraction]) -> Quantity:
    """Return a quantity in which the given functions are replaced by their values."""
    if isinstance(quantity, FunctionTerm):
        return row.get(quantity, quantity)
    if isinstance(quantity, Arithmetic):
        return replace(quantity, operands=tuple(_with_values(each, row) for each in quantity.operands))
    return quantity

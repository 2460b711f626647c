"""Plans of PDDL by forward search over ground states: the definition, with no code of the library."""

from __future__ import annotations

import itertools
import operator
import re
from collections import Counter
from collections.abc import Iterator
from fractions import Fraction
from functools import reduce
from typing import Any

Tree = Any
State = frozenset[tuple[Any, ...]]
"""The true atoms, and ("=", FUNCTION, OBJECTS..., VALUE) for each value that actions change and conditions read."""


def tree_of(text: str) -> Tree:
    stack: list[list[Any]] = [[]]
    for word in re.findall(r"[()]|[^\s()]+", re.sub(r";[^\n]*", "", text).lower()):
        if word == "(":
            stack.append([])
        elif word == ")":
            done = stack.pop()
            stack[-1].append(done)
        else:
            stack[-1].append(word)
    return stack[0][0]


def typed(words: list[Any]) -> list[tuple[str, tuple[str, ...]]]:
    found: list[tuple[str, tuple[str, ...]]] = []
    waiting: list[str] = []
    given = iter(words)
    for word in given:
        if word == "-":
            kind = next(given)
            kinds = tuple(kind[1:]) if isinstance(kind, list) else (kind,)
            found += [(each, kinds) for each in waiting]
            waiting = []
        else:
            waiting.append(word)
    return found + [(each, ("object",)) for each in waiting]


ASSIGNMENTS = ("increase", "decrease", "assign", "scale-up", "scale-down")
COMPARE = {"<": operator.lt, "<=": operator.le, ">": operator.gt, ">=": operator.ge, "=": operator.eq}


class Search:
    """The actions, the start and the goal of a problem."""

    def __init__(self, domain: str, problem: str) -> None:
        parts = tree_of(domain)[2:] + tree_of(problem)[2:]
        self.above = {name: kinds for part in parts if part[0] == ":types" for name, kinds in typed(part[1:])}
        self.objects = {
            name: kinds[0] for part in parts if part[0] in (":constants", ":objects") for name, kinds in typed(part[1:])
        }
        self.rules = [(part[1], part[2]) for part in parts if part[0] == ":derived"]
        self.derived = {head[0] for head, _ in self.rules}
        self.goal = next(part[1] for part in parts if part[0] == ":goal")
        init = next(part[1:] for part in parts if part[0] == ":init")
        listed = {key: [part[1:] for part in parts if part[0] == key] for key in (":predicates", ":functions")}
        self.predicates, self.functions = (
            {each[0] for part in parts for each in part if isinstance(each, list)} for parts in listed.values()
        )
        self.values_at_start = {tuple(each[1]): Fraction(each[2]) for each in init if each[0] == "="}
        self.actions = [
            (part[1], dict(zip(part[2::2], part[3::2], strict=True))) for part in parts if part[0] == ":action"
        ]
        self.counted = self.counted_functions()
        numbers = {("=", *key, value) for key, value in self.values_at_start.items() if key[0] in self.counted}
        self.start: State = frozenset(tuple(each) for each in init if each[0] not in ("=", "not")) | numbers

    def counted_functions(self) -> set[str]:
        """Return the functions that actions change and conditions read, if only to change such a function."""
        trees = [self.goal, *(each for _, parts in self.actions for each in parts.values())]
        read = {name for tree in trees for part in subtrees(tree) if part[0] in COMPARE for name in words(part)}
        changes = [
            part for _, parts in self.actions for part in subtrees(parts.get(":effect", [])) if self.is_change(part)
        ]
        for _ in changes:
            read |= {name for part in changes if words(part[1])[0] in read for name in words(part[2])}
        return read & {words(part[1])[0] for part in changes} & self.functions

    def is_change(self, tree: Tree) -> bool:
        return tree[0] in ASSIGNMENTS and len(tree) == 3 and tree[0] not in self.predicates

    def of(self, kinds: tuple[str, ...]) -> list[str]:
        return [name for name, kind in self.objects.items() if any(self.is_below(kind, each) for each in kinds)]

    def is_below(self, kind: str, other: str) -> bool:
        return other in ("object", kind) or any(self.is_below(each, other) for each in self.above.get(kind, ()))

    def values(self, words: list[Any], given: dict[str, str]) -> Iterator[dict[str, str]]:
        names = typed(words)
        for values in itertools.product(*(self.of(kinds) for _, kinds in names)):
            yield {**given, **{name: value for (name, _), value in zip(names, values, strict=True)}}

    def holds(self, formula: Tree, state: State, given: dict[str, str]) -> bool:  # noqa: PLR0911
        if not formula:
            return True
        word, *rest = formula
        if word == "and":
            return all(self.holds(each, state, given) for each in rest)
        if word == "or":
            return any(self.holds(each, state, given) for each in rest)
        if word == "not":
            return not self.holds(rest[0], state, given)
        if word == "imply":
            return not self.holds(rest[0], state, given) or self.holds(rest[1], state, given)
        if word == "forall":
            return all(self.holds(rest[1], state, each) for each in self.values(rest[0], given))
        if word == "exists":
            return any(self.holds(rest[1], state, each) for each in self.values(rest[0], given))
        quantities = [isinstance(each, list) or each in self.functions for each in rest]
        if word in COMPARE and (word != "=" or any(quantities)):
            values = [self.number(each, state, given) for each in rest]
            return None not in values and COMPARE[word](*values)
        terms = [given.get(each, each) for each in rest]
        return terms[0] == terms[1] if word == "=" else (word, *terms) in state

    def number(self, tree: Tree, state: State, given: dict[str, str]) -> Fraction | None:
        """Return the value of a function, a number or an operation; None if it has none."""
        if isinstance(tree, str) and re.fullmatch(r"-?[\d.]+", tree):
            return Fraction(tree)
        word, *rest = [tree] if isinstance(tree, str) else tree
        if word in ("+", "-", "*"):
            values = [self.number(each, state, given) for each in rest]
            if None in values:
                return None
            if word == "-" and len(values) == 1:
                return -values[0]
            return reduce({"+": operator.add, "-": operator.sub, "*": operator.mul}[word], values)
        key = (word, *(given.get(each, each) for each in rest))
        if word in self.counted:
            return next((each[-1] for each in state if each[:-1] == ("=", *key)), None)
        return self.values_at_start.get(key)

    def closed(self, state: State) -> State:
        """Add what the rules derive; a rule that negates a derived predicate comes after those of that predicate."""
        found = state
        for predicates in self.strata():
            while True:
                new = {
                    (head[0], *(values[name] for name, _ in typed(head[1:])))
                    for head, formula in self.rules
                    if head[0] in predicates
                    for values in self.values(head[1:], {})
                    if self.holds(formula, found, values)
                }
                if new <= found:
                    break
                found |= new
        return found

    def strata(self) -> list[set[str]]:
        level = dict.fromkeys(self.derived, 0)
        for _ in range(len(level) + 1):
            for head, formula in self.rules:
                for name, positive in signed(formula):
                    if name in level:
                        level[head[0]] = max(level[head[0]], level[name] + (not positive))
        return [{name for name, each in level.items() if each == n} for n in range(max(level.values(), default=-1) + 1)]

    def changes(self, effect: Tree, state: State, given: dict[str, str]) -> Iterator[tuple[bool, tuple[str, ...]]]:
        if not effect or self.is_change(effect):
            return
        word, *rest = effect
        if word == "and":
            for each in rest:
                yield from self.changes(each, state, given)
        elif word == "forall":
            for values in self.values(rest[0], given):
                yield from self.changes(rest[1], state, values)
        elif word == "when":
            if self.holds(rest[0], state, given):
                yield from self.changes(rest[1], state, given)
        elif word == "not":
            yield False, (rest[0][0], *(given.get(each, each) for each in rest[0][1:]))
        else:
            yield True, (word, *(given.get(each, each) for each in rest))

    def number_changes(self, effect: Tree, state: State, given: dict[str, str]) -> Iterator[tuple[Any, ...]]:
        """Yield each change of a counted function: its key, the operator and the number, None if it has no value."""
        word, *rest = effect or ["and"]
        if effect and self.is_change(effect):
            name, *terms = [rest[0]] if isinstance(rest[0], str) else rest[0]
            if name in self.counted:
                yield (name, *(given.get(each, each) for each in terms)), word, self.number(rest[1], state, given)
        elif word == "and":
            for each in rest:
                yield from self.number_changes(each, state, given)
        elif word == "forall":
            for values in self.values(rest[0], given):
                yield from self.number_changes(rest[1], state, values)
        elif word == "when" and self.holds(rest[0], state, given):
            yield from self.number_changes(rest[1], state, given)

    def with_numbers(self, effect: Tree, state: State, given: dict[str, str]) -> State | None:
        """Return a state with changed numbers; None if one has no value. Increases and decreases add up."""
        new = {each[1:-1]: each[-1] for each in state if each[0] == "="}
        for key, word, number in list(self.number_changes(effect, state, given)):
            if number is None or (word != "assign" and key not in new):
                return None
            sums = {"increase": 1, "decrease": -1}
            new[key] = number if word == "assign" else new[key] + sums[word] * number
        return frozenset(each for each in state if each[0] != "=") | {("=", *key, each) for key, each in new.items()}

    def after(self, state: State) -> Iterator[tuple[tuple[str, ...], State]]:
        """Yield the actions that are applicable in a state, with the states after them."""
        seen = self.closed(state)
        for name, parts in self.actions:
            for given in self.values(parts[":parameters"], {}):
                if self.holds(parts.get(":precondition"), seen, given):
                    counted = self.with_numbers(parts.get(":effect"), seen, given)
                    if counted is None:
                        continue
                    numbers = frozenset(each for each in counted if each[0] == "=")
                    changes = list(self.changes(parts.get(":effect"), seen, given))
                    added = {atom for positive, atom in changes if positive}
                    atoms = frozenset(each for each in state if each[0] != "=")
                    yield (name, *given.values()), (atoms - {atom for _, atom in changes}) | added | numbers

    def count(self, length: int) -> list[int]:
        """Return how many plans of each length from 0 on lead to the goal."""
        states: Counter[State] = Counter([self.start])
        steps: dict[State, list[State]] = {}
        counts = []
        for left in reversed(range(length + 1)):
            counts.append(sum(n for state, n in states.items() if self.holds(self.goal, self.closed(state), {})))
            if not left:
                break
            following: Counter[State] = Counter()
            for state, number in states.items():
                if state not in steps:
                    steps[state] = [new for _, new in self.after(state)]
                for new in steps[state]:
                    following[new] += number
            states = following
        return counts


def subtrees(tree: Tree) -> Iterator[Tree]:
    if isinstance(tree, list) and tree:
        yield tree
        for each in tree:
            yield from subtrees(each)


def words(tree: Tree) -> list[str]:
    return [tree] if isinstance(tree, str) else [word for each in tree for word in words(each)]


def signed(formula: Tree, positive: bool = True) -> Iterator[tuple[str, bool]]:
    if not formula:
        return
    word, *rest = formula
    if word in ("and", "or"):
        for each in rest:
            yield from signed(each, positive)
    elif word == "not":
        yield from signed(rest[0], not positive)
    elif word == "imply":
        yield from signed(rest[0], not positive)
        yield from signed(rest[1], positive)
    elif word in ("forall", "exists"):
        yield from signed(rest[1], positive)
    elif word not in COMPARE:
        yield word, positive

"""Random conditions of every kind, in words, with what they mean."""

from __future__ import annotations

import itertools
import random
import re
from collections.abc import Callable
from functools import cache

from tests.orbits.case import Clause, Plan

Kind = Callable[[random.Random, Plan, Plan, dict[str, str]], Clause]


def draw_clauses(
    chance: random.Random, actions: Plan, fluents: Plan, entities: dict[str, str], first: Kind | None = None
) -> tuple[Clause, ...]:
    """Draw none to two clauses, or, with a kind that comes first, that and none to two more."""
    drawn = chance.choices(KINDS, k=chance.choice([0, 1, 1, 1, 2, 2]))
    chosen = [draw(chance, actions, fluents, entities) for draw in ([first, *drawn] if first else drawn)]
    return tuple({clause.words: clause for clause in chosen}.values())


@cache
def head(action: str) -> str:
    return action.partition("(")[0]


@cache
def named_in(action: str) -> frozenset[str]:
    return frozenset(re.findall(r"\b[xy]\d\b", action))


def quantity(chance: random.Random) -> tuple[str, Callable[[int], bool]]:
    k = chance.randint(0, 2)
    return chance.choice([
        (f"at least {k} ", lambda n: n >= k), (f"at most {k} ", lambda n: n <= k), (f"exactly {k} ", lambda n: n == k),
    ])  # fmt: skip


def begins(chance: random.Random, actions: Plan, *_: object) -> Clause:
    items = [chance.choice([*actions, *map(head, actions)]) for _ in range(chance.randint(1, 2))]
    return Clause(f"begins {', '.join(items)}", lambda plan: len(plan) >= len(items) and all(
        item in (action, head(action)) for item, action in zip(items, plan, strict=False)
    ))  # fmt: skip


def pattern(chance: random.Random, actions: Plan) -> tuple[str, Callable[[str], bool]]:
    action = chance.choice(actions)
    name, arguments = head(action), action.partition("(")[2].removesuffix(")").split(",")
    if "(" not in action or chance.random() < 0.3:
        return name, lambda each: head(each) == name
    some = [each if chance.random() < 0.7 else "_" for each in arguments]
    test = re.compile(f"{name}\\({','.join('..' if each == '_' else each for each in some)}\\)")
    return f"{name}({','.join(some)})", lambda each: bool(test.fullmatch(each))


def has(chance: random.Random, actions: Plan, *_: object) -> Clause:
    (words, test), (text, fits) = quantity(chance), pattern(chance, actions)
    return Clause(f"has {words}{text}", lambda plan: test(sum(map(fits, plan))))


def lacks(chance: random.Random, actions: Plan, *_: object) -> Clause:
    text, fits = pattern(chance, actions)
    return Clause(f"lacks {text}", lambda plan: not any(map(fits, plan)))


def pairs(chance: random.Random, actions: Plan, *_: object) -> Clause:
    words, test = quantity(chance)
    one, other = (head(chance.choice(actions)) for _ in range(2))
    return Clause(f"has {words}{one}>{other}", lambda plan: test(
        sum(head(a) == one and head(b) == other for a, b in itertools.pairwise(plan))
    ))  # fmt: skip


def uses(chance: random.Random, actions: Plan, fluents: Plan, entities: dict[str, str]) -> Clause:
    words, test = chance.choice([quantity(chance), ("", lambda n: n > 0)])
    kind, members = chance.choice(kinds_of(entities))
    return Clause(f"uses {words}{kind}", lambda plan: test(len(members & set().union(*map(named_in, plan)))))


def avoids(chance: random.Random, actions: Plan, fluents: Plan, entities: dict[str, str]) -> Clause:
    kind, members = chance.choice(kinds_of(entities))
    return Clause(f"avoids {kind}", lambda plan: not members & set().union(*map(named_in, plan)))


def kinds_of(entities: dict[str, str]) -> list[tuple[str, set[str]]]:
    classes = {each: {e for e, c in entities.items() if c == each} for each in sorted(set(entities.values()))}
    return [*((e, {e}) for e in entities), *classes.items()]


def matches(chance: random.Random, actions: Plan, *_: object) -> Clause:
    name = head(chance.choice(actions))
    expression = chance.choice([f"{name} .*", f".* {name}", f"({name} | .) .?", f"{name}*"])
    wanted = chance.random() < 0.7
    test = re.compile(expression.replace(" ", ""))
    words = f"{'' if wanted else 'not '}matches {expression}"
    return Clause(words, lambda plan: bool(test.fullmatch("".join(map(head, plan)))) == wanted)


def part(chance: random.Random, actions: Plan, *_: object) -> Clause:
    """Draw some parts of five: a skeleton belongs where its names, each a shuffle of the parts, lead from the first."""
    seed, low = chance.randrange(9), chance.randrange(4)
    shuffled: dict[str, list[int]] = {}
    for name in sorted({*map(head, actions)}):
        shuffled[name] = list(range(5))
        random.Random(f"{seed} {name}").shuffle(shuffled[name])

    def belongs(plan: Plan) -> bool:
        place = 0
        for action in plan:
            place = shuffled[head(action)][place]
        return low <= place

    return Clause(f"part {low}-4 of 5 by seed {seed}", belongs)


def conjunction(chance: random.Random, fluents: Plan) -> tuple[str, Callable[[dict[str, bool]], bool]]:
    values = {fluent: chance.random() < 0.6 for fluent in chance.sample(fluents, chance.randint(1, 2))}
    words = ", ".join(f"{'' if value else 'not '}{fluent}" for fluent, value in values.items())
    return words, lambda state: all(state[fluent] == value for fluent, value in values.items())


def starts(chance: random.Random, actions: Plan, fluents: Plan, *_: object) -> Clause:
    words, test = conjunction(chance, fluents)
    return Clause(f"starts {words}", None, 0, test)


def after(chance: random.Random, actions: Plan, fluents: Plan, *_: object) -> Clause:
    (words, test), step = conjunction(chance, fluents), chance.randint(0, 2)
    return Clause(f"after {step}: {words}", None, step, test)


def ends(chance: random.Random, actions: Plan, fluents: Plan, *_: object) -> Clause:
    words, test = formula(chance, fluents, chance.randint(0, 2))
    return Clause(f"ends {words}", None, -1, test)


def achieves(chance: random.Random, actions: Plan, fluents: Plan, *_: object) -> Clause:
    words, test = formula(chance, fluents, chance.randint(0, 2))
    return Clause(f"achieves {words}", None, -1, test, achieves=True)


def formula(chance: random.Random, fluents: Plan, depth: int) -> tuple[str, Callable[[dict[str, bool]], bool]]:
    if depth == 0:
        fluent = chance.choice(fluents)
        if chance.random() < 0.2:
            return f"({fluent} or not {fluent})", lambda state: True
        return fluent, lambda state: state[fluent]
    kind = chance.choice(["and", "or", "or", "not", "alike"])
    one, first = formula(chance, fluents, depth - 1)
    if kind == "not":
        return f"not ({one})", lambda state: not first(state)
    if kind == "alike":  # the same of every entity of the class
        scheme = head(chance.choice(fluents))
        every = [fluent for fluent in fluents if head(fluent) == scheme]
        return f"({' or '.join(every)})", lambda state: any(state[each] for each in every)
    other, second = formula(chance, fluents, depth - 1)
    if kind == "and":
        return f"({one} and {other})", lambda state: first(state) and second(state)
    return f"({one} or {other})", lambda state: first(state) or second(state)


def nontrivial(*_: object) -> Clause:
    return Clause("nontrivial")


def loop_free(*_: object) -> Clause:
    return Clause("loop-free")


KINDS: tuple[Kind, ...] = (begins, has, lacks, pairs, uses, avoids, matches, part, starts, after, ends, ends, achieves,
                           nontrivial, loop_free)  # fmt: skip
"""Every kind of condition; one that has most meanings stands twice."""

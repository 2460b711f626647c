"""Compare counting by our decision diagrams with CUDD and OxiDD: python benchmarks/diagrams.py.

Requires `pip install dd oxidd`. The domain `carry` has 1.8 * 10^8 states. For both libraries the actions are encoded by
hand, and a count is a list of diagrams, one for each binary digit: CUDD's diagrams with numeric terminals hold floats,
which are not exact, and OxiDD has none in Python.
"""

from __future__ import annotations

import json
import resource
import subprocess
import sys
from collections.abc import Callable, Mapping
from fractions import Fraction
from importlib import import_module
from math import factorial
from pathlib import Path
from time import process_time
from typing import Any

from rich.console import Console
from rich.table import Table

from prag_asp import TaskSpace, load_domain

THINGS, PLACES = 8, 10
LENGTHS = (20,)


def formula(steps: int) -> int:
    """Return the number of plans by exponential generating functions: a thing carried c times, in PLACES^(c-1) ways."""
    moves = steps // 2
    one = [Fraction(PLACES ** (c - 1), factorial(c)) if c else Fraction(0) for c in range(moves + 1)]
    whole = [Fraction(1), *[Fraction(0)] * moves]
    for _ in range(THINGS):
        whole = [sum((whole[i] * one[n - i] for i in range(n + 1)), Fraction(0)) for n in range(moves + 1)]
    return int(whole[moves] * factorial(moves))


def ours(steps: int) -> int:
    """Count as `prag-asp count benchmarks/carry --by plan --engine symbolic` does."""
    return TaskSpace(load_domain(Path(__file__).parent / "carry"), steps, engine="symbolic").count("plan")


def cudd(steps: int) -> int:
    """Count with CUDD: compute the reachable states, then go backwards and add up binary digits."""
    bdd = import_module("dd.cudd").BDD()
    bdd.configure(reordering=False)
    at = {(t, p): f"at{t}_{p}" for t in range(THINGS) for p in range(PLACES)}
    held = [f"held{t}" for t in range(THINGS)]
    bdd.declare(*held, *at.values())
    free = bdd.true
    for name in held:
        free &= ~bdd.var(name)
    actions = []
    for (thing, _), place in at.items():
        actions.append((bdd.var(place) & free, {place: False, held[thing]: True}))
        actions.append((bdd.var(held[thing]), {place: True, held[thing]: False}))
    start = dict.fromkeys((*held, *at.values()), False) | {at[t, t]: True for t in range(THINGS)}
    reached = frontier = bdd.cube(start)
    while frontier != bdd.false:
        successors = bdd.false
        for guard, changes in actions:
            successors |= bdd.exist(list(changes), frontier & guard) & bdd.cube(changes)
        frontier = successors & ~reached
        reached |= successors
    row = [reached & bdd.cube({at[t, t + 1]: True for t in range(THINGS)})]
    for _ in range(steps):
        total: list[Any] = []
        for guard, changes in actions:
            total = added(bdd, total, [bdd.let(changes, digit) & guard & reached for digit in row])
        row = total
    return sum((bdd.let(start, digit) == bdd.true) << place for place, digit in enumerate(row))


def oxidd(steps: int) -> int:
    """Count with OxiDD in the same way as with CUDD."""
    manager = import_module("oxidd.bcdd").BCDDManager(20_000_000, 4_000_000, 1)
    conjunction = import_module("oxidd.util").BooleanOperator.AND
    places = {(t, p): THINGS + PLACES * t + p for t in range(THINGS) for p in range(PLACES)}
    variables = [manager.var(each) for each in manager.add_vars(THINGS + len(places))]

    def cube(values: Mapping[int, bool]) -> Any:
        product = manager.true()
        for number, value in values.items():
            product &= variables[number] if value else ~variables[number]
        return product

    free = cube(dict.fromkeys(range(THINGS), False))
    actions = []
    for (thing, _), place in places.items():
        read = cube({place: True, thing: True})
        actions.append((variables[place] & free, cube({place: False, thing: True}), read))
        actions.append((variables[thing], cube({place: True, thing: False}), read))
    first = dict.fromkeys((*range(THINGS), *places.values()), False) | {places[t, t]: True for t in range(THINGS)}
    start, nothing = cube(first), manager.false()
    reached = frontier = start
    while frontier != nothing:
        successors = nothing
        for guard, changes, read in actions:
            successors |= frontier.apply_exists(conjunction, guard, read) & changes
        frontier = successors & ~reached
        reached |= successors
    row = [reached & cube({places[t, t + 1]: True for t in range(THINGS)})]
    for _ in range(steps):
        total: list[Any] = []
        for guard, changes, read in actions:
            behind = [digit.apply_exists(conjunction, changes, read) & guard & reached for digit in row]
            total = added_by_oxidd(nothing, total, behind)
        row = total
    return sum((digit & start != nothing) << place for place, digit in enumerate(row))


def added_by_oxidd(nothing: Any, first: list[Any], second: list[Any]) -> list[Any]:
    """Return the sum of two numbers given by their binary digits, the lowest first."""
    carry, digits = nothing, []
    for place in range(max(len(first), len(second))):
        one, other = (each[place] if place < len(each) else nothing for each in (first, second))
        digits.append(one ^ other ^ carry)
        carry = (one & other) | (carry & (one ^ other))
    return digits if carry == nothing else [*digits, carry]


def added(bdd: Any, first: list[Any], second: list[Any]) -> list[Any]:
    """Return the sum of two numbers given by their binary digits, the lowest first."""
    carry, digits = bdd.false, []
    for place in range(max(len(first), len(second))):
        one, other = (each[place] if place < len(each) else bdd.false for each in (first, second))
        either = bdd.apply("xor", one, other)
        digits.append(bdd.apply("xor", either, carry))
        carry = (one & other) | (carry & either)
    return digits if carry == bdd.false else [*digits, carry]


WAYS: Mapping[str, Callable[[int], int]] = {"ours": ours, "cudd": cudd, "oxidd": oxidd}


def main() -> None:
    """Print the table, each count from a separate process; with arguments METHOD LENGTH, count in this process."""
    if len(sys.argv) > 1:
        begun = process_time()
        count = WAYS[sys.argv[1]](int(sys.argv[2]))
        memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1000
        sys.stdout.write(json.dumps([str(count), process_time() - begun, memory]))
        return
    table = Table("length", "method", "plans", "equals the formula", "CPU, s", "memory, MB")
    for length in LENGTHS:
        for way in WAYS:
            done = subprocess.run(
                [sys.executable, __file__, way, str(length)], capture_output=True, text=True, check=False
            )
            if done.returncode:
                table.add_row(str(length), way, f"failed: {done.stderr.splitlines()[-1]}")
                continue
            count, seconds, memory = json.loads(done.stdout)
            same = "yes" if int(count) == formula(length) else "NO"
            table.add_row(str(length), way, f"{int(count):,}", same, f"{seconds:.1f}", f"{memory:.0f}")
    Console().print(table)


if __name__ == "__main__":
    main()

"""Check PDDL problems with about 250,000 instances of one action: processor time and memory, beside clingo alone.

    python benchmarks/instances.py --instances 250000

In the problem `apart`, each parameter has another type, static predicates join them in pairs at random, and no two
objects are alike. In the problem `alike`, the parameters have one type and all objects are interchangeable. clingo
grounds a hand-written encoding of the same actions, preconditions and effects: a lower bound for any tool that uses it.
Fast Downward's translator takes part if the package `fast_downward` is installed. Exits with code 1 if a check of ours
takes more than 60 s or 2 GB.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
from collections.abc import Sequence
from importlib.util import find_spec
from itertools import product
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory
from typing import NamedTuple

from rich.console import Console
from rich.table import Table

MOST_SECONDS, MOST_BYTES = 60, 2 * 10**9
"""The processor time and the memory that a check may take."""

SIZE = 60
"""The number of objects of each type of `apart`."""

APART = """(define (domain haul) (:requirements :strips :typing)
 (:types crate truck dock driver)
 (:predicates (fits ?c - crate ?t - truck) (serves ?t - truck ?d - dock) (knows ?p - driver ?d - dock)
  (waiting ?c - crate) (free ?t - truck) (open ?d - dock) (rested ?p - driver) (moved ?c - crate ?d - dock))
 (:action haul :parameters (?c - crate ?t - truck ?d - dock ?p - driver)
  :precondition (and (fits ?c ?t) (serves ?t ?d) (knows ?p ?d) (waiting ?c) (free ?t) (open ?d) (rested ?p))
  :effect (and (not (waiting ?c)) (moved ?c ?d) (not (free ?t)) (not (rested ?p)))))
"""
APART_ENCODING = """
haul(C,T,D,P) :- fits(C,T), serves(T,D), knows(P,D).
needs(haul(C,T,D,P), (waiting(C); free(T); open(D); rested(P))) :- haul(C,T,D,P).
deletes(haul(C,T,D,P), (waiting(C); free(T); rested(P))) :- haul(C,T,D,P).
adds(haul(C,T,D,P), moved(C,D)) :- haul(C,T,D,P).
"""
ALIKE = """(define (domain knots) (:requirements :strips)
 (:predicates (tied ?a ?b) (loose ?a))
 (:action tie :parameters (?a ?b ?c ?d)
  :precondition (and (loose ?a) (loose ?b) (loose ?c) (loose ?d))
  :effect (and (tied ?a ?b) (tied ?c ?d) (not (loose ?a)))))
"""
ALIKE_ENCODING = """
tie(A,B,C,D) :- rope(A), rope(B), rope(C), rope(D).
needs(tie(A,B,C,D), (loose(A); loose(B); loose(C); loose(D))) :- tie(A,B,C,D).
deletes(tie(A,B,C,D), loose(A)) :- tie(A,B,C,D).
adds(tie(A,B,C,D), (tied(A,B); tied(C,D))) :- tie(A,B,C,D).
"""


class Task(NamedTuple):
    """A domain and a problem, the same for clingo, and the number of instances."""

    domain: str
    problem: str
    encoding: str
    instances: int


class Cost(NamedTuple):
    """What a command took: its exit code, its processor time in seconds, and its peak memory in bytes."""

    code: int
    seconds: float
    memory: int


def main() -> None:
    """Write the problems, run the tools, print a table."""
    options = _options()
    table = Table(title="one action with many instances")
    for column in ("problem", "instances", "tool", "CPU, s", "memory, MB"):
        table.add_column(column, justify="left" if column in ("problem", "tool") else "right")
    too_much = False
    for name, task in {"apart": apart(options.instances), "alike": alike(options.instances)}.items():
        with TemporaryDirectory() as folder:
            domain, problem, encoding = (Path(folder, each) for each in ("domain.pddl", "problem.pddl", "encoding.lp"))
            for path, text in zip((domain, problem, encoding), task, strict=False):
                path.write_text(text)
            commands = {
                "prag-asp check": [sys.executable, "-m", "prag_asp", "check", str(domain), str(problem)],
                "clingo": [sys.executable, "-m", "clingo", "--mode=gringo", str(encoding)],
            }
            if find_spec("fast_downward"):
                translate = [sys.executable, "-m", "fast_downward.translate", str(domain), str(problem)]
                commands["Fast Downward's translator"] = translate
            for tool, command in commands.items():
                cost = measured(command, Path(folder))
                within = cost.seconds <= MOST_SECONDS and cost.memory <= MOST_BYTES
                too_much |= cost.code != 0 or (tool == "prag-asp check" and not within)
                size = f"{cost.memory / 1e6:,.0f}" if cost.code == 0 else f"exit code {cost.code}"
                table.add_row(name, f"{task.instances:,}", tool, f"{cost.seconds:.1f}", size)
    Console().print(table)
    sys.exit(too_much)


def apart(instances: int) -> Task:
    """Return the task whose objects all differ; the last predicate has as many rows as make the instances."""
    draw = Random(1)
    crates, trucks, docks, drivers = ([f"{word}{n}" for n in range(SIZE)] for word in ("c", "t", "d", "p"))
    fits = [pair for pair in product(crates, trucks) if draw.random() < 0.3]
    serves = [pair for pair in product(trucks, docks) if draw.random() < 0.3]
    loads = {
        dock: sum((crate, truck) in set(fits) for crate in crates for truck, at in serves if at == dock)
        for dock in docks
    }
    knows: list[tuple[str, str]] = []
    number = 0
    for pair in draw.sample(list(product(drivers, docks)), SIZE * SIZE):
        if number < instances:
            knows.append(pair)
            number += loads[pair[1]]
    facts = {"fits": fits, "serves": serves, "knows": knows, **_each("waiting", crates), **_each("free", trucks)}
    facts |= {**_each("open", docks), **_each("rested", drivers)}
    types = {"crate": crates, "truck": trucks, "dock": docks, "driver": drivers}
    objects = " ".join(f"{' '.join(names)} - {kind}" for kind, names in types.items())
    reached = knows[0][1]
    goals = (f"(moved {crate} {reached})" for crate, truck in fits if (truck, reached) in serves)
    problem = _problem("haul", objects, facts, next(goals))
    return Task(APART, problem, _facts(facts) + APART_ENCODING, number)


def alike(instances: int) -> Task:
    """Return the task whose objects are interchangeable."""
    ropes = [f"r{n}" for n in range(round(instances**0.25 + 0.5))]
    facts = _each("loose", ropes)
    encoding = _facts({**facts, **_each("rope", ropes)}) + ALIKE_ENCODING
    return Task(ALIKE, _problem("knots", " ".join(ropes), facts, "(tied r0 r1)"), encoding, len(ropes) ** 4)


def _each(predicate: str, names: Sequence[str]) -> dict[str, list[tuple[str, ...]]]:
    return {predicate: [(name,) for name in names]}


def _problem(domain: str, objects: str, facts: dict[str, list[tuple[str, ...]]], goal: str) -> str:
    atoms = " ".join(f"({' '.join([name, *row])})" for name, rows in facts.items() for row in rows)
    return f"(define (problem many) (:domain {domain}) (:objects {objects}) (:init {atoms}) (:goal {goal}))"


def _facts(facts: dict[str, list[tuple[str, ...]]]) -> str:
    return " ".join(f"{name}({','.join(row)})." for name, rows in facts.items() for row in rows)


def measured(command: Sequence[str], folder: Path) -> Cost:
    """Run a command in a folder without showing its output, and return what it took."""
    with subprocess.Popen(command, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    return Cost(process.returncode, usage.ru_utime + usage.ru_stime, usage.ru_maxrss * 1024)


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--instances", type=int, default=250_000, help="instances of each action")
    return parser.parse_args()


if __name__ == "__main__":
    main()

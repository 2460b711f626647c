"""Count or sample the answer sets of one program with one tool: python benchmarks/peers_models.py SECONDS TOOL PROGRAM.

Model counters for clauses are timed alone, on our clauses; answer-set counters from the text to the count.
"""

from __future__ import annotations

import random
import re
import subprocess
import sys
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from time import monotonic

import clingo
from peers_process import limit_processor_time, processor_seconds, report, timed

from prag_asp import answer_sets
from prag_asp.logic.formula.cnf import Cnf
from prag_asp.logic.formula.counter import count_models
from prag_asp.models.answer_set_formula import model_formula

GRID = "v(1..n,1..m). e((X,Y),(X+1,Y)) :- v(X,Y), v(X+1,Y). e((X,Y),(X,Y+1)) :- v(X,Y), v(X,Y+1). "
INDEPENDENT = GRID + "{ in(A) } :- v(X,Y), A = (X,Y). :- e(A,B), in(A), in(B)."
CONNECTED = (
    GRID + "{ t(A,B) } :- e(A,B). r((1,1)). r(B) :- r(A), t(A,B). r(A) :- r(B), t(A,B). :- v(X,Y), not r((X,Y))."
)
CIRCLE = "{ c(X,1..k) } = 1 :- X = 1..n. :- c(X,C), c(X+1,C). :- c(1,C), c(n,C)."

ENUMERATED = 1_000_000
"""The number of answer sets that clingo enumerates; the time for all of them is extrapolated."""

REPORT = 5.0
"""Seconds between two results of a sampler, so that there is a result if it is stopped."""

OURS = "prag-asp models"

Model = tuple[object, ...]


@dataclass(frozen=True)
class Program:
    """A program, with values for its constants."""

    text: str
    constants: dict[str, int]

    @property
    def full_text(self) -> str:
        """The text with the values of its constants."""
        return "".join(f"#const {name} = {value}.\n" for name, value in self.constants.items()) + self.text

    def clauses(self) -> tuple[Cnf, bool]:
        """Return the clauses for all counters, and whether the program has positive loops."""
        ground = answer_sets(text=self.text, constants=self.constants).ground
        formula = model_formula(ground, project=False, copied=False)
        return formula.cnf, bool(formula.completion.loops)


PROGRAMS = {
    "independent sets of 6 x 290, tight": Program(INDEPENDENT, {"n": 6, "m": 290}),
    "connected subgraphs of 3 x 6, loops": Program(CONNECTED, {"n": 3, "m": 6}),
    "connected subgraphs of 3 x 7, loops": Program(CONNECTED, {"n": 3, "m": 7}),
    "connected subgraphs of 4 x 6, loops": Program(CONNECTED, {"n": 4, "m": 6}),
}
COLOURINGS = Program(CIRCLE, {"n": 6, "k": 5})
"""4,100 answer sets."""


def ours(program: Program) -> tuple[int, float]:
    """Count as the command `prag-asp models count` does."""
    answer_sets(text="{a;b}. a :- b. b :- a.").count()  # load lazy imports
    return timed(lambda: answer_sets(text=program.text, constants=program.constants).count())


def ganak(program: Program) -> tuple[int, float]:
    """Count with pyganak."""
    cnf, _ = program.clauses()
    return timed(lambda: count_models(cnf))


def d4(program: Program) -> tuple[int, float]:
    """Count with d4, whose bindings do not support projection: hidden atoms must be determined by shown ones."""
    import py_d4  # noqa: PLC0415

    cnf, loops = program.clauses()
    if loops:
        raise SystemExit("the bindings do not support projection")
    clauses = [list(clause) for clause in cnf.clauses]
    return timed(lambda: int(py_d4.Solver(clauses, cnf.variables).count().getResult()))


def aspmc(program: Program) -> tuple[int, float]:
    """Count with aspmc and its default compiler, sharpsat-td."""

    def count() -> int:
        with TemporaryDirectory() as folder:
            (Path(folder) / "program.lp").write_text(program.full_text, encoding="utf-8")
            command = [Path(sys.executable).with_name("aspmc"), "-m", "asp", "-c", "program.lp"]
            process = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True)
        match = re.search(r"overall weight of the program is (\d+)", process.stdout + process.stderr)
        if match is None:
            raise SystemExit((process.stdout + process.stderr).strip().splitlines()[-1])
        return int(match[1])

    return timed(count)


def enumerated(program: Program) -> tuple[int, float]:
    """Enumerate answer sets with clingo, without a callback, up to `ENUMERATED`."""

    def enumerate_models() -> int:
        control = clingo.Control([str(ENUMERATED)])
        control.add("base", [], program.full_text)
        control.ground([("base", [])])
        control.solve()
        return int(control.statistics["summary"]["models"]["enumerated"])

    return timed(enumerate_models)


COUNTERS: dict[str, Callable[[Program], tuple[int, float]]] = {
    OURS: ours,
    "pyganak": ganak,
    "d4": d4,
    "aspmc": aspmc,
    "clingo": enumerated,
}


def sampled(program: Program) -> Iterator[Model]:
    """Sample as the command `prag-asp models sample` does."""
    yield from answer_sets(text=program.text, constants=program.constants).sample(10**9, seed=1)


def unigen(program: Program) -> Iterator[Model]:
    """Sample almost uniformly with unigen, in batches of 50."""
    import pyunigen  # noqa: PLC0415

    cnf, _ = program.clauses()
    seeds = random.Random(0)
    while True:
        sampler = pyunigen.Sampler(seed=seeds.randrange(2**31))
        for clause in cnf.clauses:
            sampler.add_clause(list(clause))
        _, _, models = sampler.sample(num=50, sampling_set=list(cnf.shown))
        for model in models:
            yield tuple(literal for literal in model if literal > 0)


def cmsgen(program: Program) -> Iterator[Model]:
    """Sample with cmsgen, which gives no guarantee of uniformity."""
    import pycmsgen  # noqa: PLC0415

    cnf, _ = program.clauses()
    solver = pycmsgen.Solver(seed=1)
    solver.add_clauses([list(clause) for clause in cnf.clauses])
    while True:
        _, values = solver.solve()
        yield tuple(variable for variable in cnf.shown if values[variable])


SAMPLERS: dict[str, Callable[[Program], Iterator[Model]]] = {OURS: sampled, "pyunigen": unigen, "pycmsgen": cmsgen}


def sample(tool: str) -> None:
    """Take 100 samples for each colouring; report the rate and the deviation from the uniform distribution."""
    number = answer_sets(text=COLOURINGS.text, constants=COLOURINGS.constants).count()
    begun, reported = processor_seconds(), monotonic()
    seen: Counter[Model] = Counter()
    for draws, model in enumerate(SAMPLERS[tool](COLOURINGS), 1):
        seen[model] += 1
        if draws == 100 * number or monotonic() - reported > REPORT:
            reported = monotonic()
            expected = draws / number
            squares = sum((often - expected) ** 2 for often in seen.values()) + (number - len(seen)) * expected**2
            spread = squares / expected / (number - 1)
            report(draws=draws, seconds=processor_seconds() - begun, spread=spread, distinct=len(seen), of=number)
        if draws == 100 * number:
            return


def main() -> None:
    """Count a program, or sample colourings if no program is given."""
    seconds, tool, *program = sys.argv[1:]
    limit_processor_time(float(seconds))
    if not program:
        sample(tool)
        return
    count, taken = COUNTERS[tool](PROGRAMS[program[0]])
    report(count=str(count), seconds=taken)


if __name__ == "__main__":
    main()

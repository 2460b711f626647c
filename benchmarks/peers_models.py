"""Count or draw the answer sets of one program with one tool: python benchmarks/peers_models.py SECONDS TOOL PROGRAM.

Counters of clauses are timed alone, on the clauses that we make; those of programs from the text to the count.
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
from peers_process import limit_processor_time, processor_seconds, tell, timed

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
"""Answer sets that clingo finds of each program; the time for all of them is extrapolated."""

REPORT = 5.0
"""Seconds between two results of a sampler, so that one that is stopped has told one."""

OURS = "prag-asp models"

Model = tuple[object, ...]


@dataclass(frozen=True)
class Asked:
    """A program, with values for its constants."""

    text: str
    constants: dict[str, int]

    @property
    def whole(self) -> str:
        """Its text, values and all."""
        return "".join(f"#const {name} = {value}.\n" for name, value in self.constants.items()) + self.text

    def clauses(self) -> tuple[Cnf, bool]:
        """Return the clauses that all counters get, and whether atoms of the program depend on themselves."""
        ground = answer_sets(text=self.text, constants=self.constants).ground
        formula = model_formula(ground, project=False, copied=False)
        return formula.cnf, bool(formula.completion.loops)


PROGRAMS = {
    "independent sets of 6 x 290, tight": Asked(INDEPENDENT, {"n": 6, "m": 290}),
    "connected subgraphs of 3 x 6, loops": Asked(CONNECTED, {"n": 3, "m": 6}),
    "connected subgraphs of 3 x 7, loops": Asked(CONNECTED, {"n": 3, "m": 7}),
    "connected subgraphs of 4 x 6, loops": Asked(CONNECTED, {"n": 4, "m": 6}),
}
COLOURINGS = Asked(CIRCLE, {"n": 6, "k": 5})
"""4,100 answer sets."""


def ours(asked: Asked) -> tuple[int, float]:
    """Count as the command does."""
    answer_sets(text="{a;b}. a :- b. b :- a.").count()  # what is imported when it is first used
    return timed(lambda: answer_sets(text=asked.text, constants=asked.constants).count())


def ganak(asked: Asked) -> tuple[int, float]:
    """Count with pyganak."""
    cnf, _ = asked.clauses()
    return timed(lambda: count_models(cnf))


def d4(asked: Asked) -> tuple[int, float]:
    """Count with d4, which its bindings let count models alone: atoms that nothing shows have to follow from others."""
    import py_d4  # noqa: PLC0415

    cnf, loops = asked.clauses()
    if loops:
        raise SystemExit("the bindings count without projection only")
    clauses = [list(clause) for clause in cnf.clauses]
    return timed(lambda: int(py_d4.Solver(clauses, cnf.variables).count().getResult()))


def aspmc(asked: Asked) -> tuple[int, float]:
    """Count with aspmc, by its usual compiler, sharpsat-td."""

    def count() -> int:
        with TemporaryDirectory() as folder:
            (Path(folder) / "program.lp").write_text(asked.whole, encoding="utf-8")
            command = [Path(sys.executable).with_name("aspmc"), "-m", "asp", "-c", "program.lp"]
            done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True)
        found = re.search(r"overall weight of the program is (\d+)", done.stdout + done.stderr)
        if found is None:
            raise SystemExit((done.stdout + done.stderr).strip().splitlines()[-1])
        return int(found[1])

    return timed(count)


def enumerated(asked: Asked) -> tuple[int, float]:
    """Return how many answer sets clingo finds, with no callback, up to a bound."""

    def find() -> int:
        control = clingo.Control([str(ENUMERATED)])
        control.add("base", [], asked.whole)
        control.ground([("base", [])])
        control.solve()
        return int(control.statistics["summary"]["models"]["enumerated"])

    return timed(find)


COUNTERS: dict[str, Callable[[Asked], tuple[int, float]]] = {
    OURS: ours,
    "pyganak": ganak,
    "d4": d4,
    "aspmc": aspmc,
    "clingo": enumerated,
}


def drawn(asked: Asked) -> Iterator[Model]:
    """Draw as the command does."""
    yield from answer_sets(text=asked.text, constants=asked.constants).sample(10**9, seed=1)


def unigen(asked: Asked) -> Iterator[Model]:
    """Draw almost uniformly with unigen, 50 at a time."""
    import pyunigen  # noqa: PLC0415

    cnf, _ = asked.clauses()
    seeds = random.Random(0)
    while True:
        sampler = pyunigen.Sampler(seed=seeds.randrange(2**31))
        for clause in cnf.clauses:
            sampler.add_clause(list(clause))
        _, _, found = sampler.sample(num=50, sampling_set=list(cnf.shown))
        for model in found:
            yield tuple(literal for literal in model if literal > 0)


def cmsgen(asked: Asked) -> Iterator[Model]:
    """Draw with cmsgen, which promises nothing but looks at random."""
    import pycmsgen  # noqa: PLC0415

    cnf, _ = asked.clauses()
    solver = pycmsgen.Solver(seed=1)
    solver.add_clauses([list(clause) for clause in cnf.clauses])
    while True:
        _, values = solver.solve()
        yield tuple(variable for variable in cnf.shown if values[variable])


SAMPLERS: dict[str, Callable[[Asked], Iterator[Model]]] = {OURS: drawn, "pyunigen": unigen, "pycmsgen": cmsgen}


def draw(tool: str) -> None:
    """Draw 100 times as many colourings as there are, and tell the rate and how far they are from uniform."""
    number = answer_sets(text=COLOURINGS.text, constants=COLOURINGS.constants).count()
    begun, told = processor_seconds(), monotonic()
    seen: Counter[Model] = Counter()
    for draws, model in enumerate(SAMPLERS[tool](COLOURINGS), 1):
        seen[model] += 1
        if draws == 100 * number or monotonic() - told > REPORT:
            told = monotonic()
            expected = draws / number
            squares = sum((often - expected) ** 2 for often in seen.values()) + (number - len(seen)) * expected**2
            spread = squares / expected / (number - 1)
            tell(draws=draws, seconds=processor_seconds() - begun, spread=spread, distinct=len(seen), of=number)
        if draws == 100 * number:
            return


def main() -> None:
    """Count a program, or draw colourings where none is named."""
    seconds, tool, *program = sys.argv[1:]
    limit_processor_time(float(seconds))
    if not program:
        draw(tool)
        return
    count, taken = COUNTERS[tool](PROGRAMS[program[0]])
    tell(count=str(count), seconds=taken)


if __name__ == "__main__":
    main()

"""Draw with one tool, in a process of its own: python benchmarks/peers_sampling.py SECONDS TOOL FOLDER LENGTH DRAWS."""

from __future__ import annotations

import random
import sys
from collections import Counter
from collections.abc import Callable, Iterator
from time import monotonic

import clingo
from peers_process import limit_processor_time, processor_seconds, tell

from prag_asp import Domain, TaskSpace, load_domain
from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.logic.formula.cnf import Cnf
from prag_asp.logic.ground.ground_step import unrolled
from prag_asp.program.grounding import Grounder
from prag_asp.space.engines.word_formula import word_formula

REPORT = 5.0
"""Seconds between two results, so that a tool that is stopped has told one."""

Draws = Iterator[tuple[object, ...]]


def plan_formula(domain: Domain, length: int) -> Cnf:
    """Return the clauses that all samplers get."""
    return word_formula(DomainLogic(domain), "plan", length).cnf


def automaton(domain: Domain, length: int) -> Draws:
    """Draw with our engine."""
    for draw in TaskSpace(domain, length, engine="automaton").sampling(weights={}, by="plan").draws(seed=0):
        yield draw.word


def unigen(domain: Domain, length: int) -> Draws:
    """Draw almost uniformly with unigen, 50 at a time."""
    import pyunigen  # noqa: PLC0415

    cnf = plan_formula(domain, length)
    seeds = random.Random(0)
    while True:
        sampler = pyunigen.Sampler(seed=seeds.randrange(2**31))
        for clause in cnf.clauses:
            sampler.add_clause(list(clause))
        _, _, found = sampler.sample(num=50, sampling_set=list(cnf.shown))
        for model in found:
            yield tuple(literal for literal in model if literal > 0)


def cmsgen(domain: Domain, length: int) -> Draws:
    """Draw with cmsgen, which promises nothing but looks at random."""
    import pycmsgen  # noqa: PLC0415

    cnf = plan_formula(domain, length)
    solver = pycmsgen.Solver(seed=1)
    solver.add_clauses([list(clause) for clause in cnf.clauses])
    while True:
        _, values = solver.solve()
        yield tuple(variable for variable in cnf.shown if values[variable])


def clingo_signs(domain: Domain, length: int) -> Draws:
    """Draw with clingo, all decisions and signs at random, by a new search for each plan."""
    grounder = Grounder(DomainLogic(domain).program, "1", "--rand-freq=1", "--sign-def=rnd")
    grounder.ground([("base", []), *unrolled(length)])
    found: list[tuple[object, ...]] = []

    def keep(model: clingo.Model) -> None:
        atoms = model.symbols(atoms=True)
        found.append(tuple(sorted(str(atom) for atom in atoms if atom.match("occurs", 2))))

    seeds = random.Random(0)
    while True:
        solver = grounder.control.configuration.solver
        assert isinstance(solver, clingo.Configuration)
        solver[0].seed = str(seeds.randrange(2**31))
        grounder.control.solve(on_model=keep)
        yield found.pop()


TOOLS: dict[str, Callable[[Domain, int], Draws]] = {
    "automaton": automaton,
    "pyunigen": unigen,
    "pycmsgen": cmsgen,
    "clingo, random signs": clingo_signs,
}


def main() -> None:
    """Draw, and tell the rate and how far the frequencies are from uniform, every few seconds and at the end."""
    seconds, tool, folder, length, wanted = sys.argv[1:]
    limit_processor_time(float(seconds))
    domain = load_domain(folder)
    plans = TaskSpace(domain, int(length)).count("plan")
    begun, told = processor_seconds(), monotonic()
    seen: Counter[tuple[object, ...]] = Counter()
    for number, word in enumerate(TOOLS[tool](domain, int(length)), 1):
        seen[word] += 1
        if number == int(wanted) or monotonic() - told > REPORT:
            told = monotonic()
            tell(draws=number, seconds=processor_seconds() - begun, spread=_spread(seen, plans), plans=plans)
        if number == int(wanted):
            break


def _spread(seen: Counter[tuple[object, ...]], plans: int) -> float:
    """Return chi-square over its degrees of freedom: about 1 for uniform draws, however many there are."""
    expected = seen.total() / plans
    assert len(seen) <= plans
    squares = sum((number - expected) ** 2 for number in seen.values()) + (plans - len(seen)) * expected**2
    return squares / expected / (plans - 1)


if __name__ == "__main__":
    main()

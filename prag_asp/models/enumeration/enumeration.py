"""Enumeration by clingo for programs without a formula: cyclic disjunctions, acyclic graphs and derived externals."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from math import prod
from time import monotonic

import clingo

from prag_asp.logic.ground.rules import Condition, GroundRecorder
from prag_asp.models.atom_weights import weight_of
from prag_asp.models.ground_program import GroundModels
from prag_asp.models.program_reader import GivenProgram
from prag_asp.models.questions.choices import AtomChoice, add_choices
from prag_asp.models.questions.optimum import Optimum
from prag_asp.processes.progress_events import stage
from prag_asp.program.grounding import Grounder
from prag_asp.random_bits import SeededBits

POLL = 0.05
"""The time between two checks for interrupts, in seconds."""

PROJECT = "--project=auto"
"""The option for projection onto the atoms of ``#project`` or, without such a statement, onto the shown symbols."""

Printed = tuple[clingo.Symbol, ...]


@dataclass(frozen=True)
class Enumeration:
    """The answer sets of a program, re-enumerated for each query; memory does not grow with their number."""

    given: GivenProgram
    ground: GroundModels
    project: bool
    stated: Mapping[clingo.Symbol, Fraction]
    optimum: Optimum | None = None
    progress: Callable[[str], None] | None = None
    choices: tuple[AtomChoice, ...] = ()

    def __iter__(self) -> Iterator[Printed]:
        return (printed for printed, _ in self._enumerate())

    def count(self) -> int:
        """Return the number of answer sets."""
        grounder, counted = self._grounder("--stats"), 0

        def one_more(_: clingo.Model) -> None:
            nonlocal counted
            counted += 1

        with grounder.control.solve(async_=True, on_model=one_more) as handle:
            try:
                while not handle.wait(POLL):
                    self._report(counted)
            finally:
                handle.cancel()
        # clasp counts in doubles; an enumeration that reached 2**53 would take centuries.
        return int(grounder.control.statistics["summary"]["models"]["enumerated"])

    def total(self) -> Fraction:
        """Return the sum of the weights of all answer sets, which is their number if there are no weights."""
        return sum((weight for _, weight in self.reported()), start=Fraction(0))

    def marginals(self) -> dict[clingo.Symbol, Fraction]:
        """Return, for each symbol, the total weight of the answer sets that show it."""
        weights: dict[clingo.Symbol, Fraction] = {}
        for printed, weight in self.reported():
            for symbol in printed:
                weights[symbol] = weights.get(symbol, Fraction(0)) + weight
        return weights

    def sample(self, seed: int, number: int, total: Fraction) -> list[Printed]:
        """Return a given number of answer sets, each sampled with a probability proportional to its weight.

        Each sample is a point between 0 and the total weight; a second enumeration finds the answer sets at these
        points by cumulative weight.
        """
        bits = SeededBits(seed, "models")
        scale = prod(weight.denominator for weight in self.stated.values())  # makes the weights of answer sets integers
        points = [(bits.randrange(int(total * scale)), place) for place in range(number)]
        points.sort(reverse=True)
        samples: list[Printed] = [()] * number
        passed = 0
        for printed, weight in self._enumerate() if points else ():
            passed += int(weight * scale)
            while points and points[-1][0] < passed:
                samples[points.pop()[1]] = printed
            if not points:
                break
        return samples

    @cached_property
    def _projected(self) -> frozenset[clingo.Symbol]:
        """The atoms of ``#project`` if answer sets are projected onto them."""
        projected = (self.ground.projected or ()) if self.project else ()
        return frozenset(symbol for symbol, atom in self.ground.names if atom in projected)

    def _grounder(self, *arguments: str) -> Grounder:
        project = [PROJECT] if self.project else []
        values = [] if self.optimum is None else [str(value) for _, value in self.optimum.values]
        mode = f"--opt-mode={','.join(['enum', *values])}"  # all answer sets that are at least as good
        recorder = GroundRecorder()
        observed = self.project or self.choices
        grounder = self.given.grounder(*arguments, "0", mode, *project, observer=recorder if observed else None)
        grounder.ground([("base", [])])
        if self.choices:
            atoms = grounder.control.symbolic_atoms
            projected = {symbol: ((atom.literal,),) for symbol in self._projected if (atom := atoms[symbol])}
            add_choices(grounder.control, self.choices, projected or recorder.shown)
        if self.project and recorder.projected is None:
            project_on_shown(grounder.control, recorder.shown.items())
        stage("enumerating answer sets")
        return grounder

    def reported(self) -> Iterator[tuple[Printed, Fraction]]:
        """Yield the answer sets, and report their number periodically."""
        latest = monotonic()
        for number, answer_set in enumerate(self._enumerate(), 1):
            if monotonic() > latest + POLL:
                latest = monotonic()
                self._report(number)
            yield answer_set

    def _report(self, counted: int) -> None:
        if self.progress is not None and counted:
            self.progress(f"at least {counted:,} answer set{'s' if counted > 1 else ''}")

    def _enumerate(self) -> Iterator[tuple[Printed, Fraction]]:
        grounder = self._grounder()
        by_statement = self.project and self.ground.projected is not None
        with grounder.control.solve(yield_=True, async_=True) as handle:
            try:
                while True:
                    handle.resume()
                    while not handle.wait(POLL):
                        pass
                    model = handle.model()
                    if model is None:
                        return
                    atoms = model.symbols(atoms=True)
                    shown = self._projected.intersection(atoms) if by_statement else set(model.symbols(shown=True))
                    printed = tuple(sorted(shown))  # clingo repeats a symbol that is both an atom and a term
                    yield printed, weight_of(self.stated, iter(atoms))
            finally:
                handle.cancel()


def project_on_shown(control: clingo.Control, shown: Iterable[tuple[clingo.Symbol, Iterable[Condition]]]) -> None:
    """Make a control with the option `PROJECT` project onto shown symbols, each with the conditions that show it.

    By default, clingo omits symbols whose names begin with ``_``, and distinguishes the conditions of a symbol.
    """
    with control.backend() as backend:
        projected = []
        for _, conditions in shown:
            alternatives = list(dict.fromkeys(conditions))
            if alternatives == [()]:
                continue
            if len(alternatives) == 1 and len(alternatives[0]) == 1:
                projected.append(abs(alternatives[0][0]))
                continue
            projected.append(backend.add_atom())
            for condition in alternatives:
                backend.add_rule([projected[-1]], condition)
        backend.add_project(projected)

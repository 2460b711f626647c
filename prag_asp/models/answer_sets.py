"""The answer sets of any logic program: exact counts, lists, samples and marginals."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import islice
from pathlib import Path

import clingo

from prag_asp.errors import NotFound, QueryError
from prag_asp.logic.formula.approximate import Estimate, Tolerance, estimate_models
from prag_asp.logic.formula.clause_builder import TRUE, Literal
from prag_asp.logic.formula.counter import D4, GANAK, Counter, count_models, has_counter
from prag_asp.models import ENGINES
from prag_asp.models.answer_set_formula import ModelFormula, model_formula
from prag_asp.models.atom_weights import (
    PLAIN,
    LiteralWeights,
    literal_weights,
    projected_away,
    stated_weights,
    unknown_weights,
)
from prag_asp.models.compiler import PreparedFormula, Progress, compile_formula, prepare
from prag_asp.models.counting_race import Turn, count_or_compile
from prag_asp.models.diagram import WeightedDiagram
from prag_asp.models.enumeration.bounded_enumeration import BoundedEnumeration
from prag_asp.models.enumeration.effort import SECOND, first_effort, is_worth_enumerating, turns_of_counters
from prag_asp.models.enumeration.enumeration import Enumeration
from prag_asp.models.foundedness import list_models
from prag_asp.models.ground_program import GroundModels, ground_models
from prag_asp.models.program_reader import GivenProgram, places_of_costs, read_program
from prag_asp.models.questions.conflict import Conflict, find_conflict
from prag_asp.models.questions.facets import Facet, facets_of_diagram, facets_of_lists
from prag_asp.models.questions.optimum import Optimum, find_optimum, only_optimal
from prag_asp.models.shifting import is_head_cycle_free
from prag_asp.processes.progress_events import stage
from prag_asp.program.constants import Constant
from prag_asp.program.sources import Source, text_source

AnswerSet = tuple[clingo.Symbol, ...]
"""The shown symbols of an answer set, sorted."""

Tell = Callable[[str], None]

COUNTERS = {"ganak": GANAK, "d4": D4}
"""The engines that only count, on the clauses."""


def answer_sets(
    *files: str | Path | Source,
    text: str | None = None,
    constants: Mapping[str, Constant] | None = None,
    project: bool = False,
    weighted: bool = False,
    optimal: bool = False,
    engine: str = "auto",
    tell: Tell | None = None,
    progress: Progress | None = None,
) -> AnswerSets:
    """Return the answer sets of a logic program, given as files, a text, or both.

    With `project`, answer sets that agree on the projection variables count as one: the atoms of ``#project`` or,
    without such a statement, all shown symbols. With `weighted`, the weight of an answer set is the product over its
    atoms of the facts ``weight(Atom, W)``. With `optimal`, only the answer sets of best value count, by the weak
    constraints, ``#minimize`` and ``#maximize`` of the program. `tell` receives notes, such as that another engine
    counts in parallel, and `progress` the progress of long computations.

    Raises:
        DomainError: a file cannot be read or ground, or has unsupported statements, one per line of the message.
        QueryError: there is no such engine, no weight, or nothing to optimise.
    """
    if engine not in ENGINES:
        raise QueryError(f"engine {engine!r}: there is none; choose {', '.join(ENGINES)}")
    program = read_program(
        [*files, *([] if text is None else [text_source("text", text)])], constants or {}, optimal=optimal
    )
    if optimal and next(places_of_costs(program.program), None) is None:
        raise QueryError(
            "--optimal: the program optimises nothing; add #minimize or a weak constraint, or leave it out"
        )
    stage("grounding the program")
    ground = ground_models(program)
    stated = stated_weights(ground, program.program) if weighted else {}
    optimum = find_optimum(program, ground) if optimal else None
    if optimum is not None:
        ground = only_optimal(ground, optimum)
    answers = AnswerSets(program, ground, project, stated, engine, optimum, tell, progress)
    for note in ground.notes:
        answers.note(f"{note}; clingo leaves this out")
    if optimum is not None:
        answers.note(str(optimum))
    unknown = unknown_weights(stated, ground, program.program)
    if unknown:
        answers.note(unknown)
    return answers


@dataclass(frozen=True)
class AnswerSets:
    """The answer sets of one program; compiled formulas are cached between queries.

    Iteration is lazy and in a fixed order: of two answer sets, that with the first symbol in clingo's order that only
    one of them has comes first. If clingo enumerates, its own order is used. With an `optimum`, they are the optimal
    answer sets only.
    """

    given: GivenProgram
    ground: GroundModels
    project: bool
    stated: Mapping[clingo.Symbol, Fraction]
    engine: str
    optimum: Optimum | None = None
    tell: Tell | None = None
    progress: Progress | None = None

    def count(self) -> int:
        """Return their exact number, regardless of weights.

        With engine auto, clingo enumerates first, with limited work. If there are more answer sets, counters and the
        compiler of a diagram race: any of them may be faster by orders of magnitude.

        Raises:
            EngineError: the engine ganak or d4 is not installed, or fails.
        """
        if self.engine == "auto" and "_diagram" not in self.__dict__ and not self._reason_to_enumerate:
            number = self._count_by_enumeration()
            if number is not None:
                return number
        if self._way(counts=True) == "clingo":
            return self._enumeration.count()
        if self.engine in COUNTERS:
            counter = COUNTERS[self.engine]
            stage(f"counting models with {counter.name}")
            return count_models(self._counting_formula.cnf, counter=counter, request=f"engine {self.engine}")
        if self.engine == "auto" and "_diagram" not in self.__dict__:
            found = count_or_compile(self._turns, lambda: self._counting_formula.cnf, self._compile, self._note_counter)
            if isinstance(found, int):
                return found
            self.__dict__["_diagram"] = found  # fills the cached_property
        return WeightedDiagram(self._diagram.diagram, {}).total

    @property
    def _turns(self) -> list[Turn]:
        """The turns of the installed counters in a race with the compiler."""
        tight = not self._formula.completion.loops
        turns = turns_of_counters(self._prepared.order.width, tight=tight, whole=self._formula.whole)
        return [turn for turn in turns if has_counter(turn.counter)]

    def _note_counter(self, counter: Counter) -> None:
        self.note(f"{counter.name} counts as well, because compiling takes long; the first answers")

    def _count_by_enumeration(self) -> int | None:
        """Return their number if clingo is likely to be the fastest engine, and enumerates all within limits."""
        enumeration = BoundedEnumeration(self.ground, project=self.project)
        number = enumeration.count(first_effort(self.ground))
        if number is None and is_worth_enumerating(enumeration.depth(), self._prepared.order.width):
            number = enumeration.count(SECOND)
        return number

    def estimate(self, epsilon: float = 0.8, delta: float = 0.2, seed: int = 0) -> Estimate:
        """Return an estimate of their number, regardless of weights.

        With a probability of at least 1 - `delta`, it is within a factor of 1 + `epsilon` of the exact number.

        Raises:
            QueryError: a number is out of range, or the program cannot be translated to clauses.
            EngineError: ApproxMC is not installed, or fails.
        """
        tolerance = Tolerance(epsilon, delta)
        if self._no_clauses:
            raise QueryError(f"--approximate: {self._no_clauses}; leave it out, and clingo enumerates")
        stage("estimating the number of models")
        return estimate_models(self._counting_formula.cnf, tolerance, seed)

    def total(self) -> Fraction:
        """Return the exact sum of their weights; without weights, their number."""
        if not self.stated:
            return Fraction(self.count())
        if self._way() == "clingo":
            return self._enumeration.total()
        return self._diagram.total * self._weights.scale

    def sample(self, count: int, seed: int = 0) -> Iterator[AnswerSet]:
        """Yield `count` answer sets, each with a probability exactly proportional to its weight, reproducibly by seed.

        Raises:
            NotFound: there is none, or all have the weight 0.
        """
        if self._way() == "clingo":
            total = self._enumeration.total()
            self._require(total)
            yield from self._enumeration.sample(seed, count, total)
            return
        self._require(self._diagram.total)
        yield from map(self._print, islice(self._diagram.sample(seed), count))

    def marginals(self) -> dict[clingo.Symbol, Fraction]:
        """Return for each symbol that may be shown the exact probability, by weight, that an answer set has it.

        Raises:
            NotFound: there is none, or all have the weight 0.
        """
        if self._way() == "clingo":
            total = self._enumeration.total()
            self._require(total)
            sums = self._enumeration.marginals()
            return {symbol: sums.get(symbol, Fraction(0)) / total for symbol in self._symbols}
        whole = self._diagram.total
        self._require(whole)
        weights = self._diagram.marginals() | {TRUE: whole}
        return {symbol: Fraction(weights.get(literal, 0), whole) for symbol, literal in self._formula.printed}

    def facets(self) -> dict[clingo.Symbol, Facet]:
        """Return for each symbol that may be shown its share, whether it is a facet, and how much it narrows them.

        Raises:
            NotFound: there is no answer set.
            QueryError: they are weighted.
        """
        if self.stated:
            raise QueryError("facets are counted, not weighed; leave out --weighted, or ask for marginals")
        if self._way() == "clingo":
            found = facets_of_lists(self._symbols, self)
            self._require(any(facet.share for facet in found.values()) or self.count())
            return found
        diagram = WeightedDiagram(self._diagram.diagram, {})
        self._require(diagram.total)
        return facets_of_diagram(diagram.diagram, self._formula.printed, diagram.marginals(), diagram.total)

    def explain(self) -> Conflict | None:
        """Return lines of the program that together exclude every answer set, or None if there is one."""
        return find_conflict(self.given, self.ground)

    def __iter__(self) -> Iterator[AnswerSet]:
        if self._way() == "clingo":
            yield from self._enumeration
            return
        stage("searching answer sets")
        formula = self._formula
        order = [literal for _, literal in formula.printed]
        if not formula.whole:
            order += formula.cnf.shown
        else:
            order += [formula.completion.value(atom) for _, atom in self.ground.names]
            order += map(formula.completion.value, formula.completion.values)
        yield from map(self._print, list_models(formula, order))

    def _print(self, literals: Sequence[Literal]) -> AnswerSet:
        """Return the shown symbols of a model with some true literals."""
        places, always = self._places
        shown = [*always]
        for literal in literals:
            shown += places.get(literal, ())
        return tuple([self._symbols[place] for place in sorted(shown)])

    def _way(self, *, counts: bool = False) -> str:
        """Return whether clingo or the diagram answers, and note a fallback.

        Raises:
            QueryError: the chosen engine cannot answer.
        """
        if self.engine == "clingo":
            return "clingo"
        if self._reason_to_enumerate:
            if self.engine != "auto":
                raise QueryError(f"engine {self.engine}: {self._reason_to_enumerate}; choose the engine clingo")
            return "clingo"
        if self.engine in COUNTERS and not counts:
            raise QueryError(f"engine {self.engine}: it only counts; choose the engine diagram")
        if self.engine == "d4" and not self._formula.whole:
            raise QueryError("engine d4: it does not project; choose the engine ganak or diagram")
        return "diagram"

    @cached_property
    def _reason_to_enumerate(self) -> str:
        """The reason why there is no formula, or ""; with engine auto it is noted."""
        reason = self._no_clauses
        if reason and self.engine == "auto":
            self.note(f"{reason}: clingo enumerates, which takes time for each answer set")
        return reason

    @cached_property
    def _no_clauses(self) -> str:
        """The reason why there is no formula, or ""."""
        reason = ""
        if self.ground.acyclic:
            reason = "#edge wants a graph without cycles"
        elif any(rule.is_disjunctive for rule in self.ground.rules) and not is_head_cycle_free(self.ground.rules):
            reason = "atoms of one disjunction depend on each other"
        elif self.ground.contested:
            contested = sorted(symbol for symbol, atom in self.ground.names if atom in self.ground.contested)
            first = contested[0] if contested else "an atom without a name"
            reason = f"a rule derives {first}, which is #external and not false"
        return reason

    @cached_property
    def _formula(self) -> ModelFormula:
        return self._formula_of(copied=True)

    @property
    def _counting_formula(self) -> ModelFormula:
        """The formula for a counter, without copies of atoms."""
        return self._formula if not self._formula.completion.copies else self._formula_of(copied=False)

    def _formula_of(self, *, copied: bool) -> ModelFormula:
        return model_formula(self.ground, project=self.project, copied=copied)

    @cached_property
    def _weights(self) -> LiteralWeights:
        if not self.stated:
            return PLAIN
        return literal_weights(self._formula, self.stated, self.ground, self.given.program)

    @cached_property
    def _diagram(self) -> WeightedDiagram:
        return self._compile()

    def _compile(self, look: Callable[[], None] = lambda: None) -> WeightedDiagram:
        if self._prepared.clauses:
            self.note(f"compiling {self._prepared.cost}")
        stage("compiling")
        diagram = compile_formula(self._formula, self._prepared, self.progress, look)
        return WeightedDiagram(diagram, self._weights.weights)

    @cached_property
    def _prepared(self) -> PreparedFormula:
        printed = {abs(literal) for _, literal in self._formula.printed}
        stage("ordering variables")
        return prepare(self._formula, printed | {abs(literal) for literal in self._weights.weights})

    @cached_property
    def _symbols(self) -> tuple[clingo.Symbol, ...]:
        if self._reason_to_enumerate or self.engine == "clingo":
            by_statement = self.project and self.ground.projected is not None
            named = (symbol for symbol, atom in self.ground.names if atom in (self.ground.projected or ()))
            return tuple(named) if by_statement else tuple(symbol for symbol, _ in self.ground.shown)
        return tuple(symbol for symbol, _ in self._formula.printed)

    @cached_property
    def _places(self) -> tuple[dict[Literal, list[int]], list[int]]:
        """The indices of the symbols of each literal, and those of the symbols that all answer sets have."""
        places: dict[Literal, list[int]] = {}
        for place, (_, literal) in enumerate(self._formula.printed):
            places.setdefault(literal, []).append(place)
        return places, places.pop(TRUE, [])

    @cached_property
    def _enumeration(self) -> Enumeration:
        if self.project and self.stated:
            projection = self.ground.projection_variables
            left = sorted(
                symbol for symbol, atom in self.ground.names if symbol in self.stated and atom not in projection
            )
            if left:
                raise projected_away(left[0], self.ground, self.given.program)
        return Enumeration(self.given, self.ground, self.project, self.stated, self.optimum, self.progress)

    def note(self, line: str) -> None:
        """Pass a line to `tell`, if there is one."""
        if self.tell is not None:
            self.tell(line)

    def _require(self, total: Fraction | int) -> None:
        """Check that there is something to sample."""
        if not total:
            raise NotFound(
                "no answer set has a weight above 0; raise the weight of an atom"
                if self.stated and self.count()
                else "there is no answer set; drop a constraint"
            )

"""The answer sets of any logic program: exact counts, lists, samples and marginals."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property
from itertools import islice
from pathlib import Path

import clingo

from prag_asp.errors import NotFound, QueryError
from prag_asp.logic.formula.approximate import Estimate, Tolerance, estimate_models
from prag_asp.logic.formula.clause_builder import TRUE, Literal
from prag_asp.logic.formula.counter import D4, GANAK, count_models
from prag_asp.models import ENGINES
from prag_asp.models.atom_weights import stated_weights, unknown_weights
from prag_asp.models.compiled_program import CompiledProgram
from prag_asp.models.compiler import Progress
from prag_asp.models.counting_race import count_by_race
from prag_asp.models.diagram import WeightedDiagram
from prag_asp.models.foundedness import list_models
from prag_asp.models.ground_program import GroundModels, ground_models
from prag_asp.models.program_reader import GivenProgram, places_of_costs, read_program
from prag_asp.models.questions.choices import AtomChoice, conditions_of_symbols, only_chosen, parse_choice
from prag_asp.models.questions.conflict import Conflict, find_conflict
from prag_asp.models.questions.facets import Facet, facets_of_diagram, facets_of_lists
from prag_asp.models.questions.optimum import Optimum, find_optimum, only_optimal
from prag_asp.processes.progress_events import stage
from prag_asp.program.constants import Constant
from prag_asp.program.sources import Source, text_source

AnswerSet = tuple[clingo.Symbol, ...]
"""The shown symbols of an answer set, sorted."""

Tell = Callable[[str], None]

LONG_COUNT = 10**60
"""The smallest number that is too long for a table in a notebook."""

COUNTERS = {"ganak": GANAK, "d4": D4}
"""The engines that can only count, using the clauses."""


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
    without such a statement, all shown symbols. With `weighted`, the weight of an answer set is the product of the
    weights of its atoms, given by facts ``weight(Atom, W)``. With `optimal`, only answer sets count that are optimal
    under the program's weak constraints, ``#minimize`` and ``#maximize``. `tell` receives notes, for example that
    another engine counts in parallel, and `progress` receives the progress of long computations.

    Raises:
        DomainError: a file cannot be read or ground, or has unsupported statements; the message contains one line for
            each.
        QueryError: the engine does not exist, or the program has no weights or nothing to optimise.
    """
    if engine not in ENGINES:
        raise QueryError(f"no engine {engine!r}; choose {', '.join(ENGINES)}")
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

    Iteration is lazy and in a fixed order: of two answer sets, the one that contains the first symbol in which they
    differ, in clingo's order, comes first. If clingo enumerates, clingo's own order is used. With an `optimum`, only
    the optimal answer sets are included, and with `choices`, only those that agree with the choices; `whole` is then
    the object without choices.
    """

    given: GivenProgram
    ground: GroundModels
    project: bool
    stated: Mapping[clingo.Symbol, Fraction]
    engine: str
    optimum: Optimum | None = None
    tell: Tell | None = None
    progress: Progress | None = None
    choices: tuple[AtomChoice, ...] = ()
    whole: AnswerSets | None = field(default=None, repr=False, compare=False)

    def where(self, *literals: str) -> AnswerSets:
        """Return the answer sets that show some symbols and lack others, such as ``p(1)`` and ``not p(2)``.

        Of optimal answer sets, only those that agree with the literals are kept. Once a diagram has been compiled, it
        answers queries for any choices in time linear in its size.

        Raises:
            QueryError: a text is not a literal, or no answer set can show its symbol.
        """
        known = conditions_of_symbols(self.ground, project=self.project)
        choices = (*self.choices, *(parse_choice(text, known) for text in literals))
        whole = self.whole or self
        return replace(whole, choices=tuple(dict.fromkeys(choices)), whole=whole) if choices else self

    def compile(self, look: Callable[[], None] = lambda: None) -> bool:
        """Compile the diagram if necessary; return False if there is none because clingo has to enumerate.

        `look` is called periodically; an exception that it raises ends the compilation.
        """
        if self._way() == "clingo":
            return False
        if not self._base._compiled.has_diagram:
            self._compiled.compile(look)
        return True

    def _repr_html_(self) -> str:
        """Return what is known about the answer sets, for a notebook; nothing is counted or solved."""
        from prag_asp.html import element, fragment, scroll_table  # noqa: PLC0415 - not needed for counting

        rows = [("engine", self.engine), ("counts", "shown symbols once" if self.project else "every answer set")]
        rows += [("optimum", str(self.optimum))] if self.optimum is not None else []
        rows += [("weights", f"{len(self.stated)} atoms")] if self.stated else []
        rows += [("choices", ", ".join(map(str, self.choices)))] if self.choices else []
        base = self._base.__dict__.get("_compiled")
        if base is not None and base.has_diagram:
            total = self._diagram.unweighted().total
            rows += [("answer sets", f"{total:,}")] if total < LONG_COUNT else []
        return fragment(
            element("p", element("strong", "The answer sets of a logic program")),
            scroll_table(("property", "value"), rows, label="Answer sets"),
        )

    @cached_property
    def _compiled(self) -> CompiledProgram:
        ground = self.ground
        if self.choices:
            ground = ground_models(self.given)  # the constraints for choices change its control
            ground = ground if self.optimum is None else only_optimal(ground, self.optimum)
            ground = only_chosen(ground, self.choices, project=self.project)
        return CompiledProgram(
            self.given, ground, self.project, self.stated, self.optimum, self.progress, self.note, self.choices
        )

    @cached_property
    def _base(self) -> AnswerSets:
        """The answer sets whose diagram is used: those without choices, if they have been compiled."""
        compiled = None if self.whole is None else self.whole.__dict__.get("_compiled")
        return self if self.whole is None or compiled is None or not compiled.has_diagram else self.whole

    @cached_property
    def _diagram(self) -> WeightedDiagram:
        base = self._base
        diagram = base._compiled.diagram
        if base is self:
            return diagram
        literals = dict(base._compiled.formula.printed)
        chosen = [-literals[each.symbol] if each.excluded else literals[each.symbol] for each in self.choices]
        return WeightedDiagram(diagram.diagram.given(chosen), diagram.weights)

    def count(self) -> int:
        """Return the exact number of answer sets, regardless of weights.

        With the engine auto, clingo enumerates first, with limited work. If it does not finish, clingo, counters and
        the diagram compiler race: any of them may be faster by orders of magnitude.

        Raises:
            EngineError: the engine ganak or d4 is not installed, or fails.
        """
        if self._way(counts=True) == "clingo":
            return self._compiled.enumeration.count()
        if self.engine in COUNTERS:
            counter = COUNTERS[self.engine]
            stage(f"counting models with {counter.name}")
            return count_models(self._compiled.counting_formula.cnf, counter=counter, request=f"engine {self.engine}")
        if self.engine == "auto" and not self._base._compiled.has_diagram:
            number = count_by_race(self._compiled)
            if number is not None:
                return number
        return self._diagram.unweighted().total

    def estimate(self, epsilon: float = 0.8, delta: float = 0.2, seed: int = 0) -> Estimate:
        """Estimate the number of answer sets, regardless of weights.

        With a probability of at least 1 - `delta`, the estimate is within a factor of 1 + `epsilon` of the exact
        number.

        Raises:
            QueryError: a number is out of range, or the program cannot be translated to clauses.
            EngineError: ApproxMC is not installed, or fails.
        """
        tolerance = Tolerance(epsilon, delta)
        if self._compiled.no_clauses:
            raise QueryError(f"--approximate: {self._compiled.no_clauses}; leave it out, and clingo enumerates")
        stage("estimating the number of models")
        return estimate_models(self._compiled.counting_formula.cnf, tolerance, seed)

    def total(self) -> Fraction:
        """Return the exact sum of the weights of the answer sets, which is their number if there are no weights."""
        if not self.stated:
            return Fraction(self.count())
        if self._way() == "clingo":
            return self._compiled.enumeration.total()
        return self._diagram.total * self._base._compiled.weights.scale

    def sample(self, count: int, seed: int = 0) -> Iterator[AnswerSet]:
        """Yield `count` answer sets, sampled exactly in proportion to their weights; a seed fixes the result.

        Raises:
            NotFound: there is no answer set, or all have weight 0.
        """
        if self._way() == "clingo":
            total = self._compiled.enumeration.total()
            self._require(total)
            yield from self._compiled.enumeration.sample(seed, count, total)
            return
        diagram = self._compiled.diagram  # not that of the whole, so that a seed gives the same result in every case
        self._require(diagram.total)
        yield from map(self._printer(self._compiled), islice(diagram.sample(seed), count))

    def marginals(self) -> dict[clingo.Symbol, Fraction]:
        """Return the exact probability that an answer set, sampled by weight, contains each symbol that may be shown.

        Raises:
            NotFound: there is no answer set, or all have weight 0.
        """
        if self._way() == "clingo":
            total = self._compiled.enumeration.total()
            self._require(total)
            sums = self._compiled.enumeration.marginals()
            return {symbol: sums.get(symbol, Fraction(0)) / total for symbol in self._symbols}
        whole, printed = self._diagram.total, self._base._compiled.formula.printed
        self._require(whole)
        weights = self._diagram.marginals() | {TRUE: whole}
        return {symbol: Fraction(weights.get(literal, 0), whole) for symbol, literal in printed}

    def facets(self) -> dict[clingo.Symbol, Facet]:
        """Return the share of each symbol that may be shown and, if it is a facet, how much it narrows the answer sets.

        Raises:
            NotFound: there is no answer set.
            QueryError: the answer sets are weighted.
        """
        if self.stated:
            raise QueryError("facets are counted, not weighed; leave out --weighted, or ask for marginals")
        if self._way() == "clingo":
            found = facets_of_lists(self._symbols, (printed for printed, _ in self._compiled.enumeration.reported()))
            self._require(any(facet.share for facet in found.values()) or self.count())
            return found
        diagram, printed = self._diagram.unweighted(), self._base._compiled.formula.printed
        self._require(diagram.total)
        return facets_of_diagram(diagram.diagram, printed, diagram.marginals(), diagram.total)

    def explain(self) -> Conflict | None:
        """Return lines of the program that together exclude every answer set, or None if the program has one.

        Choices count as lines, with their numbers from 1. Optimisation is ignored.
        """
        return find_conflict(self.given, self.ground, self.choices, project=self.project)

    def __iter__(self) -> Iterator[AnswerSet]:
        if self._way() == "clingo":
            yield from self._compiled.enumeration
            return
        stage("searching for answer sets")
        formula = self._compiled.formula
        order = [literal for _, literal in formula.printed]
        if not formula.whole:
            order += formula.cnf.shown
        else:
            order += [formula.completion.value(atom) for _, atom in self._compiled.ground.names]
            order += map(formula.completion.value, formula.completion.values)
        yield from map(self._printer(self._compiled), list_models(formula, order))

    def _printer(self, compiled: CompiledProgram) -> Callable[[Sequence[Literal]], AnswerSet]:
        """Return a function from the true literals of a model of the formula to the model's shown symbols."""
        symbols = [symbol for symbol, _ in compiled.formula.printed]
        places: dict[Literal, list[int]] = {}
        for place, (_, literal) in enumerate(compiled.formula.printed):
            places.setdefault(literal, []).append(place)
        always = places.pop(TRUE, [])

        def printed(literals: Sequence[Literal]) -> AnswerSet:
            shown = [*always]
            for literal in literals:
                shown += places.get(literal, ())
            return tuple([symbols[place] for place in sorted(shown)])

        return printed

    def _way(self, *, counts: bool = False) -> str:
        """Return the engine to use, clingo or the diagram, and note a fallback.

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
        if self.engine == "d4" and not self._compiled.formula.whole:
            raise QueryError("engine d4: it does not project; choose the engine ganak or diagram")
        return "diagram"

    @cached_property
    def _reason_to_enumerate(self) -> str:
        """The reason why there is no formula, or ""; with engine auto, the reason is noted."""
        if self.whole is not None:
            return self.whole._reason_to_enumerate
        reason = self._compiled.no_clauses
        if reason and self.engine == "auto":
            self.note(f"{reason}: clingo enumerates, which takes time for each answer set")
        return reason

    @cached_property
    def _symbols(self) -> tuple[clingo.Symbol, ...]:
        return tuple(conditions_of_symbols(self.ground, project=self.project))

    def note(self, line: str) -> None:
        """Pass a line to `tell`, if there is one."""
        if self.tell is not None:
            self.tell(line)

    def _require(self, total: Fraction | int) -> None:
        """Check that there is an answer set to sample."""
        if not total:
            raise NotFound(
                "no answer set has a weight above 0; raise the weight of an atom"
                if self.stated and self.count()
                else "there is no answer set; drop a constraint"
            )

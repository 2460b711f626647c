"""The representations used for counting and listing answer sets, each created on first use."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

import clingo

from prag_asp.models.answer_set_formula import ModelFormula, model_formula
from prag_asp.models.atom_weights import PLAIN, LiteralWeights, literal_weights, projected_away
from prag_asp.models.compiler import Progress, compile_formula
from prag_asp.models.diagram import WeightedDiagram
from prag_asp.models.enumeration.enumeration import Enumeration
from prag_asp.models.ground_program import GroundModels
from prag_asp.models.prepared_formula import PreparedFormula, prepare_formula
from prag_asp.models.program_reader import GivenProgram
from prag_asp.models.questions.choices import AtomChoice
from prag_asp.models.questions.optimum import Optimum
from prag_asp.models.shifting import is_head_cycle_free
from prag_asp.models.sums.sum_formula import SumFormula, sum_formula
from prag_asp.processes.progress_events import stage


@dataclass(frozen=True)
class CompiledProgram:
    """A ground program as a formula, as a diagram of the formula, and as an enumeration by clingo.

    `stated` are the weights of atoms. `ground` contains constraints for the `choices`, whereas `given` does not. `note`
    receives a line before a long compilation.
    """

    given: GivenProgram
    ground: GroundModels
    project: bool
    stated: Mapping[clingo.Symbol, Fraction]
    optimum: Optimum | None
    progress: Progress | None
    note: Callable[[str], None]
    choices: tuple[AtomChoice, ...] = ()

    @cached_property
    def no_clauses(self) -> str:
        """The reason why there is no formula, or ""."""
        ground = self.ground
        if ground.acyclic:
            return "#edge requires a graph without cycles"
        if any(rule.is_disjunctive for rule in ground.rules) and not is_head_cycle_free(ground.rules):
            return "atoms of one disjunction depend on each other"
        if ground.contested:
            contested = sorted(symbol for symbol, atom in ground.names if atom in ground.contested)
            first = contested[0] if contested else "an atom without a name"
            return f"a rule derives {first}, which is #external and not false"
        return ""

    @cached_property
    def formula(self) -> ModelFormula:
        """The formula with copies of atoms; its models without open copies are the answer sets."""
        return model_formula(self.ground, project=self.project, copied=True)

    @property
    def counting_formula(self) -> ModelFormula:
        """The formula for a counter, without copies of atoms."""
        if not self.formula.completion.copies:
            return self.formula
        return model_formula(self.ground, project=self.project, copied=False)

    @cached_property
    def sums(self) -> SumFormula | None:
        """The formula with sums apart, or None if the program has no sum, or positive loops."""
        if not any(rule.weights for rule in self.ground.rules):
            return None
        formula = model_formula(self.ground, project=self.project, copied=False, sums_apart=True)
        return None if formula.completion.loops else sum_formula(formula)

    @cached_property
    def weights(self) -> LiteralWeights:
        """The weights of the literals of the formula."""
        if not self.stated:
            return PLAIN
        return literal_weights(self.formula, self.stated, self.ground, self.given.program)

    @cached_property
    def prepared(self) -> PreparedFormula:
        """The formula, prepared for compilation."""
        printed = {abs(literal) for _, literal in self.formula.printed}
        stage("ordering variables")
        return prepare_formula(self.formula, printed | {abs(literal) for literal in self.weights.weights})

    @cached_property
    def diagram(self) -> WeightedDiagram:
        """The diagram of the formula."""
        return self._compile()

    @property
    def has_diagram(self) -> bool:
        """Whether the diagram has been compiled."""
        return "diagram" in self.__dict__

    def compile(self, look: Callable[[], None]) -> None:
        """Compile the diagram, calling `look` after every 64 node visits; an exception from `look` ends it."""
        self.__dict__["diagram"] = self._compile(look)  # fills the cached_property

    def _compile(self, look: Callable[[], None] = lambda: None) -> WeightedDiagram:
        if self.prepared.clauses:
            self.note(f"compiling {self.prepared.cost}")
        stage("compiling")
        return WeightedDiagram(compile_formula(self.formula, self.prepared, self.progress, look), self.weights.weights)

    @cached_property
    def enumeration(self) -> Enumeration:
        """The enumeration by clingo.

        Raises:
            QueryError: an atom has a weight but is not a projection variable.
        """
        if self.project and self.stated:
            projection = self.ground.projection_variables
            left = sorted(
                symbol for symbol, atom in self.ground.names if symbol in self.stated and atom not in projection
            )
            if left:
                raise projected_away(left[0], self.ground, self.given.program)
        return Enumeration(
            self.given, self.ground, self.project, self.stated, self.optimum, self.progress, self.choices
        )

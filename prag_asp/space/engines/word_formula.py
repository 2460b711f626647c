"""The words of a level as models of a formula: prefixes as literals, and models as words."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import clingo

from prag_asp.errors import EngineError
from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.logic.formula.clause_builder import TRUE, Literal
from prag_asp.logic.formula.cnf import Cnf, plan_cnf
from prag_asp.program.predicates import OCCURS, STEP_NAME
from prag_asp.space.engines.engine import Letters, Level, all_letters, name_in_prefix

SHOWN = {"plan": OCCURS, "task": OCCURS, "skeleton": STEP_NAME}
"""The predicate whose atoms distinguish the words of a level."""


@dataclass(frozen=True)
class WordFormula:
    """The words of one level and length as the projected models of `cnf`."""

    cnf: Cnf
    level: Level
    length: int
    letters: Mapping[str, clingo.Symbol]
    _known: dict[tuple[int, str], Literal] = field(default_factory=dict, repr=False, compare=False)

    def beginning(self, prefix: Sequence[str]) -> list[Literal] | None:
        """Return the literals that assert that a word begins with `prefix`, or None if no word does."""
        if len(prefix) > self.length:
            return None
        literals = []
        for step, item in enumerate(prefix, 1):
            if (step, item) not in self._known:
                name = name_in_prefix(item, self.letters)
                term = self.letters[item] if name is None else clingo.Function(name)
                shown = SHOWN[self.level] if name is None else STEP_NAME
                self._known[step, item] = self.cnf.literal(shown(term, clingo.Number(step)))
            literals.append(self._known[step, item])
        return None if -TRUE in literals else literals

    def fits(self, letter: str, prefix_names: Sequence[str]) -> bool:
        """Return whether a letter matches the first item of `prefix_names`; without items, every letter does."""
        if not prefix_names or letter == prefix_names[0]:
            return True
        return letter.partition("(")[0] == name_in_prefix(prefix_names[0], self.letters)

    def word(self, model: Sequence[Literal]) -> Letters:
        """Return the word that a model represents.

        Raises:
            EngineError: a step of the model does not have exactly one action.
        """
        always, meaning = self._shown
        word = list(always)
        for variable in self.cnf.shown:
            if model[variable - 1] > 0:
                step, letter = meaning[variable]
                word[step - 1] += (letter,)
        if any(len(letters) != 1 for letters in word):
            raise EngineError("a step does not have exactly one action; restore that rule of step.lp")
        return tuple(letters[0] for letters in word)

    @cached_property
    def _shown(self) -> tuple[list[tuple[str, ...]], dict[Literal, tuple[int, str]]]:
        """For each step, the letters that are in all models; for each variable, its step and its letter."""
        always: list[tuple[str, ...]] = [()] * self.length
        meaning: dict[Literal, tuple[int, str]] = {}
        may_be = {TRUE, *self.cnf.shown}
        for atom, literal in self.cnf.literals.items():
            if literal in may_be and atom.match(*SHOWN[self.level]):
                what, time = atom.arguments
                if 0 < time.number <= self.length and literal == TRUE:
                    always[time.number - 1] += (str(what),)
                elif time.number > 0:
                    meaning[literal] = (time.number, str(what))
        return always, meaning


def word_formula(model: DomainLogic, level: Level, length: int) -> WordFormula:
    """Return the formula whose models are the words of a given level and length.

    Raises:
        EngineError: the program cannot be translated to clauses.
    """
    program = model.program if level == "plan" else model.task_program(length)
    return WordFormula(plan_cnf(program, length, SHOWN[level]), level, length, all_letters(model, level))

"""The words of a level as models of a formula: literals of prefixes, and words of models."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
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

    def beginning(self, prefix: Sequence[str]) -> list[Literal] | None:
        """Return the literals that assert that a word begins with `prefix`, or None if none does."""
        if len(prefix) > self.length:
            return None
        literals = [self._known.get(place) or self._literal(*place) for place in enumerate(prefix, 1)]
        return None if -TRUE in literals else literals

    def fits(self, letter: str, prefix_names: Sequence[str]) -> bool:
        """Return whether a letter matches the first item of `prefix_names`; without items, every letter does."""
        return (
            not prefix_names
            or letter == prefix_names[0]
            or _name(letter) == name_in_prefix(prefix_names[0], self.letters)
        )

    def word(self, model: Sequence[Literal]) -> Letters:
        """Return the word of a model.

        Raises:
            EngineError: a step of the model does not have exactly one action.
        """
        word = list(self._always)
        for variable in self.cnf.shown:
            if model[variable - 1] > 0:
                step, letter = self._meaning[variable]
                word[step - 1] += (letter,)
        if any(len(letters) != 1 for letters in word):
            raise EngineError("a step does not have exactly one action; restore that rule of step.lp")
        return tuple(letters[0] for letters in word)

    @cached_property
    def _shown(self) -> list[tuple[Literal, int, str]]:
        shown = SHOWN[self.level]
        may_be = {TRUE, *self.cnf.shown}
        atoms = ((literal, atom) for atom, literal in self.cnf.literals.items() if literal in may_be)
        timed = ((literal, atom.arguments) for literal, atom in atoms if atom.match(*shown))
        return [(literal, step.number, str(what)) for literal, (what, step) in timed if step.number > 0]

    @cached_property
    def _meaning(self) -> dict[Literal, tuple[int, str]]:
        return {literal: (step, letter) for literal, step, letter in self._shown}

    @cached_property
    def _always(self) -> list[tuple[str, ...]]:
        """The letters that each step has in all models."""
        facts = [(step, letter) for literal, step, letter in self._shown if literal == TRUE]
        return [tuple(letter for at, letter in facts if at == step) for step in range(1, self.length + 1)]

    @cached_property
    def _known(self) -> dict[tuple[int, str], Literal]:
        """A cache of literals by step and letter."""
        return {}

    def _literal(self, step: int, letter: str) -> Literal:
        name = name_in_prefix(letter, self.letters)
        term = self.letters[letter] if name is None else clingo.Function(name)
        shown = SHOWN[self.level] if name is None else STEP_NAME
        literal = self._known[step, letter] = self.cnf.literal(shown(term, clingo.Number(step)))
        return literal


def word_formula(model: DomainLogic, level: Level, length: int) -> WordFormula:
    """Return the formula of the words of a level and a length.

    Raises:
        EngineError: the program cannot be translated to clauses.
    """
    program = model.program if level == "plan" else model.task_program(length)
    return WordFormula(plan_cnf(program, length, SHOWN[level]), level, length, all_letters(model, level))


def _name(letter: str) -> str:
    return letter.partition("(")[0]

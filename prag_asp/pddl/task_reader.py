"""The import of a PDDL domain and problem as the logic program of a single domain."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from decimal import Decimal
from pathlib import Path

from prag_asp.pddl.costs import cost_of
from prag_asp.pddl.definitions import DomainFile, ProblemFile
from prag_asp.pddl.line_map import sources_of
from prag_asp.pddl.reading.file_reader import read_files
from prag_asp.pddl.reading.scopes import TOTAL
from prag_asp.pddl.size import check_size
from prag_asp.pddl.translate import Translation
from prag_asp.program.problem import Problem
from prag_asp.program.sources import Source, text_source


@dataclass(frozen=True)
class Imported:
    """A PDDL domain and problem as a logic program: its name and its text.

    `sources` are the same program as files with the line numbers of the PDDL files, so that messages refer to those
    files. `actions` and `objects` map names in the program to PDDL names. `warnings` are about ignored or undeclared
    parts of the files.
    """

    name: str
    text: str
    sources: tuple[Source, ...] = field(repr=False, compare=False)
    actions: Mapping[str, str]
    objects: Mapping[str, str]
    warnings: tuple[Problem, ...] = field(repr=False, compare=False)
    _schemas: Mapping[str, str] = field(repr=False, compare=False)
    _files: tuple[DomainFile, ProblemFile] = field(repr=False, compare=False)

    @property
    def has_costs(self) -> bool:
        """Whether any action has a cost."""
        effects = (effect for action in self._files[0].actions for effect in action.numeric)
        return any(effect.function.function == TOTAL for effect in effects)

    def step(self, action: str, terms: Sequence[str]) -> str:
        """Return a ground action of the program as a step of a PDDL plan: ``(pick-up a)``."""
        return f"({' '.join([self.actions[action], *(self.objects[each] for each in terms)])})"

    def cost(self, action: str, terms: Sequence[str]) -> Decimal:
        """Return the cost that a ground action of the program adds to ``total-cost``.

        Raises:
            DomainError: the problem has no value for a function in the cost.
        """
        return cost_of(*self._files, self._schemas[action], [self.objects[each] for each in terms])


def read(domain: str | Path, problem: str | Path, *, untimed: bool = False) -> Imported:
    """Read a PDDL domain and problem; both may be in one file, which is given twice.

    At every length, the logic program has the same plans as the problem: sequences of actions that are applicable one
    after another and lead to the goal. With `untimed`, durative actions become instantaneous: each has the effect of
    running from start to end without overlap.

    Raises:
        DomainError: a file cannot be read, is not PDDL, or uses an unsupported feature; the message gives the line.
    """
    first, second, warnings = read_files(Path(domain), Path(problem), untimed=untimed)
    translation = Translation(first, second)
    check_size(Path(domain), first, second, translation.fluents(), translation.words.static)
    objects = {ours: original for original, ours in translation.words.objects.items()}
    schemas = {ours: name for name, ours in translation.actions.items()}
    given_names = {each.name: each.given_name for each in first.actions}
    actions = {ours: given_names[name] for ours, name in schemas.items()}
    title = f"The problem {second.name} of the domain {first.name}, imported from PDDL."
    lines = translation.lines(title)
    sources = tuple(sources_of(lines, {"domain": Path(domain), "problem": Path(problem)}))
    name, text = re.sub(r"[^\w.+-]", "_", f"{first.name}_{second.name}"), "\n".join(lines) + "\n"
    general = text_source(name, "\n".join([*translation.general, ""]))
    return Imported(name, text, (*sources, general), actions, objects, warnings, schemas, (first, second))

"""Import a PDDL domain and problem as the logic program of one domain."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from decimal import Decimal
from pathlib import Path

from prag_asp.pddl.costs import cost_of
from prag_asp.pddl.definitions import DomainFile, ProblemFile
from prag_asp.pddl.file_reader import read_files
from prag_asp.pddl.line_map import sources_of
from prag_asp.pddl.size import check_size
from prag_asp.pddl.translate import Translation
from prag_asp.program.sources import Source, text_source


@dataclass(frozen=True)
class Imported:
    """A PDDL domain and problem as a logic program: its name and its text.

    `sources` are the same program as files with the line numbers of the PDDL files, so that messages refer to these.
    `actions` and `objects` map the names of the program to those of PDDL.
    """

    name: str
    text: str
    sources: tuple[Source, ...] = field(repr=False, compare=False)
    actions: Mapping[str, str]
    objects: Mapping[str, str]
    _files: tuple[DomainFile, ProblemFile] = field(repr=False, compare=False)

    @property
    def has_costs(self) -> bool:
        """Whether an action has a cost."""
        return any(action.costs for action in self._files[0].actions)

    def step(self, action: str, terms: Sequence[str]) -> str:
        """Return a ground action of the program as a step of a PDDL plan: ``(pick-up a)``."""
        return f"({' '.join([self.actions[action], *(self.objects[each] for each in terms)])})"

    def cost(self, action: str, terms: Sequence[str]) -> Decimal:
        """Return the cost that a ground action of the program adds to ``total-cost``.

        Raises:
            DomainError: the problem has no value for a function in the cost.
        """
        return cost_of(*self._files, self.actions[action], [self.objects[each] for each in terms])


def read(domain: str | Path, problem: str | Path) -> Imported:
    """Read a PDDL domain and problem.

    The logic program has the same plans of every length as the problem: sequences of actions that are applicable one
    after the other, and lead to the goal.

    Raises:
        DomainError: a file cannot be read, is not PDDL, or uses an unsupported feature; the message has the line.
        PddlMissingError: the package pddl is not installed.
    """
    first, second = read_files(Path(domain), Path(problem))
    translation = Translation(first, second)
    check_size(Path(domain), first, second, translation.fluents(), translation.words.static)
    actions, objects = (
        {ours: original for original, ours in each.items()} for each in (translation.actions, translation.words.objects)
    )
    title = f"The problem {second.name} of the domain {first.name}, imported from PDDL."
    lines = translation.lines(title)
    sources = tuple(sources_of(lines, {"domain": Path(domain), "problem": Path(problem)}))
    name, text = f"{first.name}_{second.name}", "\n".join(lines) + "\n"
    general = text_source(name, "\n".join([*translation.general, ""]))
    return Imported(name, text, (*sources, general), actions, objects, (first, second))

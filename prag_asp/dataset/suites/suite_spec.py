"""A suite as a value: its parts, with the conditions that distinguish them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

from prag_asp.dataset.dataset_spec import ApartSpec, DatasetSpec
from prag_asp.errors import QueryError
from prag_asp.grammar.phrasings import Phrasings
from prag_asp.tables.toml_text import key_line

if TYPE_CHECKING:
    from prag_asp.domain.load import Domain
    from prag_asp.physics import Budget, Staging


@dataclass(frozen=True)
class HeldOutCondition:
    """Something that only some parts contain: the condition that a task has it, and the negation of this condition."""

    what: str
    having: str
    without: str


@dataclass(frozen=True)
class SuitePart:
    """A part: the tasks from which it samples, the number of samples, and the language of their texts.

    `where` holds all conditions, including those of the whole suite and those that exclude what is held out. `unseen`
    holds what is held out from the other parts, `of` is the part whose tasks this part repeats, and `shares` holds the
    parts with which it may share tasks. Each task is at least `distance` edits away from all tasks that satisfy the
    conditions of other parts.
    """

    name: str
    tasks: int
    lengths: range
    where: tuple[str, ...]
    unseen: tuple[str, ...] = ()
    of: str | None = None
    shares: tuple[str, ...] = ()
    about: str = ""
    seed: int = 0
    starts: int = 1
    split: Mapping[str, str] | None = None
    skeletons: bool = False
    evenly: bool = False
    language: str = "en"
    phrasings: str = ""
    distance: Mapping[str, int] = field(default_factory=dict)

    def apart(self, other: SuitePart) -> bool:
        """Return whether two parts never have the same sentence for an action."""
        mine, others = Phrasings.parse(self.phrasings), Phrasings.parse(other.phrasings)
        return self.language != other.language or mine.disjoint(others)

    def declares(self, other: SuitePart) -> bool:
        """Return whether one of two parts declares that it may share tasks with the other."""
        return other.name in (*self.shares, self.of) or self.name in (*other.shares, other.of)


@dataclass(frozen=True)
class Suite:
    """A suite of parts over the tasks of one domain, defined by a file with this `path` and `text`."""

    name: str
    domain: Domain
    parts: Mapping[str, SuitePart]
    title: str = ""
    description: str = ""
    uniform: bool = False
    budget: Budget | None = None
    staging: Staging | None = None
    demonstrate: bool = False
    held: tuple[HeldOutCondition, ...] = ()
    path: Path = field(default_factory=Path)
    text: str = field(default="", repr=False)

    def place(self, *keys: str) -> str:
        """Return the file and the line of a key, as the beginning of a message."""
        return f"{self.path}:{key_line(self.text, keys)}"

    def at_most(self, tasks: int) -> Suite:
        """Return the suite with at most `tasks` tasks per part, for a trial; the full suite extends its datasets.

        Raises:
            QueryError: `tasks` is below 1.
        """
        if tasks < 1:
            raise QueryError(f"at most {tasks} tasks a part: give at least 1")
        return replace(
            self, parts={name: replace(part, tasks=min(tasks, part.tasks)) for name, part in self.parts.items()}
        )

    def apart_from(self, part: SuitePart) -> list[ApartSpec]:
        """Return the sets of tasks from which the tasks of a part must keep a distance."""
        others = ((self.parts[name], distance) for name, distance in part.distance.items())
        return [ApartSpec(distance, [*other.lengths], [*other.where]) for other, distance in others]

    def dataset_spec(self, part: SuitePart) -> DatasetSpec:
        """Return the request for the dataset of a part.

        Raises:
            QueryError: values of the part conflict; the message names the part.
        """
        try:
            return DatasetSpec.of(
                self.domain, tasks=part.tasks, seed=part.seed, split=part.split, skeletons=part.skeletons,
                starts=part.starts, demonstrate=self.demonstrate, evenly=part.evenly,
                weights={} if self.uniform or part.evenly else None, physics=self.budget is not None,
                budget=self.budget, language=part.language, phrasings=part.phrasings, staging=self.staging,
                apart=self.apart_from(part),
            )  # fmt: skip
        except QueryError as error:
            raise QueryError(f"{self.name}: parts.{part.name}: {error}") from None

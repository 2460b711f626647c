"""A suite as a value: its parts, each with the conditions that keep it apart from the others."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from prag_asp.errors import QueryError
from prag_asp.grammar.phrasings import Phrasings
from prag_asp.tables.toml_text import key_line

if TYPE_CHECKING:
    from prag_asp.domain.load import Domain
    from prag_asp.physics import Budget, Staging


@dataclass(frozen=True)
class Held:
    """Something that only some parts have: the conditions that a task has it, and that it has nothing of it."""

    what: str
    having: str
    without: str


@dataclass(frozen=True)
class Part:
    """A part: which tasks it draws from, how many, and in which words they are told.

    `where` are all its conditions, those of the suite and of what is held out included. `unseen` are the things that
    its tasks have and those of other parts do not, `of` the part whose tasks it has, and `shares` are the parts with
    which it may have tasks in common.
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

    def apart(self, other: Part) -> bool:
        """Return whether the two parts have no sentence in common."""
        mine, others = Phrasings.parse(self.phrasings), Phrasings.parse(other.phrasings)
        return self.language != other.language or mine.disjoint(others)

    def declares(self, other: Part) -> bool:
        """Return whether one of two parts declares that it may share tasks with the other."""
        return other.name in (*self.shares, self.of) or self.name in (*other.shares, other.of)


@dataclass(frozen=True)
class Suite:
    """Parts over the tasks of one domain; `path` and `text` are the file that says so."""

    name: str
    domain: Domain
    parts: Mapping[str, Part]
    title: str = ""
    description: str = ""
    uniform: bool = False
    budget: Budget | None = None
    staging: Staging | None = None
    demonstrate: bool = False
    held: tuple[Held, ...] = ()
    path: Path = field(default_factory=Path)
    text: str = field(default="", repr=False)

    def place(self, *keys: str) -> str:
        """Return where a key stands, as messages begin."""
        return f"{self.path}:{key_line(self.text, keys)}"

    def at_most(self, tasks: int) -> Suite:
        """Return the suite with so many tasks a part at most, to try it; the whole one goes on from there.

        Raises:
            QueryError: that is none.
        """
        if tasks < 1:
            raise QueryError(f"at most {tasks} tasks a part: give at least 1")
        return replace(
            self, parts={name: replace(part, tasks=min(tasks, part.tasks)) for name, part in self.parts.items()}
        )

    def drawing(self, part: Part) -> dict[str, Any]:
        """Return what `generate` is asked for a part, beside its space and folder."""
        return {
            "tasks": part.tasks, "seed": part.seed, "split": part.split, "skeletons": part.skeletons,
            "starts": part.starts, "demonstrate": self.demonstrate, "evenly": part.evenly,
            "weights": {} if self.uniform or part.evenly else self.domain.settings.weights,
            "physics": self.budget is not None, "budget": self.budget, "language": part.language,
            "phrasings": part.phrasings, "staging": self.staging,
        }  # fmt: skip

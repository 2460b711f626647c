"""What a task is told as, in words: the one place where instructions come into a data set."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, NamedTuple

from prag_asp.dataset.language import instruction, instruction_writer_of, sentence
from prag_asp.errors import QueryError

if TYPE_CHECKING:
    from prag_asp.dataset.language import InstructionWriter
    from prag_asp.domain.load import Domain
    from prag_asp.task import Task

LEVELS, PLAIN = ("vague", "default", "exact"), "plain"


class Told(NamedTuple):
    """A task in words by how much they say, a sentence for each action, and what had to be called by its name."""

    whole: tuple[tuple[str, str], ...]
    subgoals: tuple[str, ...]
    named: tuple[str, ...]


Telling = Callable[["Task", Mapping[str, str]], Told]
"""Tells a task by the colours that some things have in its picture, where they are other than the scene's."""


def telling_of(domain: Domain, language: str, seed: int, phrasings: str = "") -> Telling:
    """Return what tells tasks of a domain in a language; the seed chooses among its `phrasings`.

    A task that cannot be told without a sentence that means something else as well is told plainly, by the names of its
    entities, at one level alone: ``plain``.

    Raises:
        QueryError: the domain does not speak the language, or has no such phrasings.
    """
    return telling_by(instruction_writer_of(domain, language, phrasings=phrasings), domain, seed)


def telling_by(teller: InstructionWriter, domain: Domain, seed: int) -> Telling:
    """Return what tells tasks as `telling_of` does, by a teller that is there."""

    def told(task: Task, colours: Mapping[str, str]) -> Told:
        try:
            found = teller.recoloured(colours).instructions(task, seed)
        except QueryError:
            templates = domain.settings.language
            plain = tuple(sentence(action, templates) for action in task.actions)
            return Told(((PLAIN, instruction(task, templates)),), plain, tuple(task.entities))
        return Told(tuple((level, getattr(found, level)) for level in LEVELS), found.subgoals, found.named)

    return told

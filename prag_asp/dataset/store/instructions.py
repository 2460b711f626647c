"""What a task is told as, in words: the one place where instructions come into a dataset."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, NamedTuple

from prag_asp.dataset.language import instruction, sentence, teller_of
from prag_asp.errors import QueryError

if TYPE_CHECKING:
    from prag_asp.dataset.language import Teller
    from prag_asp.domain.load import Domain
    from prag_asp.task import Task

LEVELS, PLAIN = ("vague", "default", "exact"), "plain"


class TaskTexts(NamedTuple):
    """A task in words by how much they say, a sentence for each action, and what had to be called by its name."""

    whole: tuple[tuple[str, str], ...]
    subgoals: tuple[str, ...]
    named: tuple[str, ...]


Captioner = Callable[["Task", Mapping[str, str]], TaskTexts]
"""Tells a task by the colours that some things have in its picture, where they are other than the scene's."""


def captioner_of(domain: Domain, language: str, seed: int, phrasings: str = "") -> Captioner:
    """Return what tells tasks of a domain in a language; the seed chooses among its `phrasings`.

    A task that cannot be told without a sentence that means something else as well is told plainly, by the names of its
    entities, at one level alone: ``plain``.

    Raises:
        QueryError: the domain does not speak the language, or has no such phrasings.
    """
    return captioner_with(teller_of(domain, language, phrasings=phrasings), domain, seed)


def captioner_with(teller: Teller, domain: Domain, seed: int) -> Captioner:
    """Return what tells tasks as `captioner_of` does, by a teller that is there."""

    def told(task: Task, colours: Mapping[str, str]) -> TaskTexts:
        try:
            found = teller.recoloured(colours).instructions(task, seed)
        except QueryError:
            templates = domain.settings.language
            plain = tuple(sentence(action, templates) for action in task.actions)
            return TaskTexts(((PLAIN, instruction(task, templates)),), plain, tuple(task.entities))
        return TaskTexts(tuple((level, getattr(found, level)) for level in LEVELS), found.subgoals, found.named)

    return told

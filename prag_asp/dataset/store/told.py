"""What a task is told as, in words: the one place where instructions come into a data set."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from prag_asp.dataset.language import instruction, sentence

if TYPE_CHECKING:
    from prag_asp.domain.load import Domain
    from prag_asp.task import Task


class Instructions(NamedTuple):
    """A task in words by how much they say, and each of its actions as a sentence."""

    whole: tuple[tuple[str, str], ...]
    subgoals: tuple[str, ...]


def told(domain: Domain, task: Task, *, seed: int, index: int) -> Instructions:
    """Return a task in words; `seed` and `index` choose among phrasings, where there are some."""
    templates = domain.settings.language
    sentences = tuple(sentence(action, templates) for action in task.actions)
    return Instructions((("exact", instruction(task, templates)),), sentences)

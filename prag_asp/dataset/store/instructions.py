"""The texts of a task in a dataset: instructions, and a sentence for each action."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, NamedTuple

from prag_asp.dataset.language import instruction, instruction_writer_of, sentence
from prag_asp.errors import QueryError

if TYPE_CHECKING:
    from prag_asp.dataset.dataset_spec import DatasetSpec
    from prag_asp.dataset.language import InstructionWriter
    from prag_asp.domain.load import Domain
    from prag_asp.task import Task

LEVELS, PLAIN = ("vague", "default", "exact"), "plain"


class TaskTexts(NamedTuple):
    """The texts of a task: (level, instruction) pairs, a sentence for each action, and entities referred to by name."""

    whole: tuple[tuple[str, str], ...]
    subgoals: tuple[str, ...]
    named: tuple[str, ...]


Captioner = Callable[["Task", Mapping[str, str]], TaskTexts]
"""A function from a task, and the colours that differ from the scene, to the texts of the task."""


def captioner_of(domain: Domain, language: str, seed: int, phrasings: str = "") -> Captioner:
    """Return a captioner for the tasks of a domain in a language; the seed chooses among the `phrasings`.

    A task that has no unambiguous text is described by the names of its entities, at the single level ``plain``.

    Raises:
        QueryError: the domain has no sentences in the language, or has no such phrasings.
    """
    return captioner_with(instruction_writer_of(domain, language, phrasings=phrasings), domain, seed)


def captioner_like(domain: Domain, spec: DatasetSpec) -> Captioner:
    """Return the captioner for a requested dataset, with the language, seed and phrasings of the request.

    Raises:
        QueryError: the domain has no sentences in the language.
    """
    return captioner_of(domain, spec.language, spec.seed, spec.phrasings)


def captioner_with(writer: InstructionWriter, domain: Domain, seed: int) -> Captioner:
    """Return a captioner like that of `captioner_of`, with an existing instruction writer."""

    def texts(task: Task, colours: Mapping[str, str]) -> TaskTexts:
        try:
            result = writer.recoloured(colours).instructions(task, seed)
        except QueryError:
            templates = domain.settings.language
            plain = tuple(sentence(action, templates) for action in task.actions)
            return TaskTexts(((PLAIN, instruction(task, templates)),), plain, tuple(task.entities))
        return TaskTexts(tuple((level, getattr(result, level)) for level in LEVELS), result.subgoals, result.named)

    return texts

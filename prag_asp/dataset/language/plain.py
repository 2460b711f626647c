"""Plain instructions: a sentence from `[language]` for each action, with the names of entities unchanged."""

from __future__ import annotations

from collections.abc import Mapping

from prag_asp.atom import Atom
from prag_asp.grammar.template import BRACKETED
from prag_asp.task import Task


def sentence(atom: Atom, templates: Mapping[str, str]) -> str:
    """Return an action or a fluent in words.

    In a template, ``{0}`` stands for the first argument, and text in brackets is left out. Without a template, the name
    and the arguments are joined by spaces.
    """
    arguments = [_plain(argument) for argument in atom.arguments]
    template = templates.get(atom.name)
    if template is None:
        return " ".join([_plain(atom.name), *arguments])
    return BRACKETED.sub("", template).format(*arguments)


def instruction(task: Task, templates: Mapping[str, str]) -> str:
    """Return the plain instruction for a task in one line: its actions in words."""
    return "; ".join(sentence(action, templates) for action in task.actions)


def _plain(text: str) -> str:
    return text.replace("_", " ")

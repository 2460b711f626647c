"""The checks of domain.toml: unknown keys, wrong types, weights for unknown names, and an invalid scene."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from string import Formatter
from typing import Any

from prag_asp.atom import atom_of
from prag_asp.exact_numbers import MAX_EXPONENT
from prag_asp.program.entity_names import ambiguity, named
from prag_asp.program.facts import Facts
from prag_asp.program.problem import Problem
from prag_asp.program.settings import KEYS, Settings, weight_of
from prag_asp.tables.report import TableEntry, TableProblem, TableReport
from prag_asp.wording import did_you_mean, is_misspelt

TYPES: Mapping[str, tuple[type, str]] = {
    "title": (str, 'a string, such as "Blocks on a table"'),
    "description": (str, 'a string, such as "Blocks on a table"'),
    "weights": (dict, "a table, such as [weights] with grasp = 2 below it"),
    "language": (dict, 'a table, such as [language] with grasp = "grasp {1}" below it'),
    "scene": (dict, "a table that begins with [scene]"),
}
"""The type of each key, and how messages describe it."""


def table_problems(table: Mapping[str, Any], settings: Settings) -> Iterator[Problem]:
    """Yield the unknown keys and the values of wrong types in domain.toml."""
    root = TableEntry(TableReport(), (), table)
    for key, entry in root.entries():
        if key not in KEYS:
            entry.add(f"unknown key; {did_you_mean(key, KEYS)}", "" if is_misspelt(key, KEYS) else "no-effect")
        elif not isinstance(entry.value, TYPES[key][0]):
            entry.needs(TYPES[key][1])
        elif key == "scene" and not entry.value:
            entry.add("is empty; give it [scene.shapes], or leave it out")
    for _, entry in root.at("weights").entries():
        if weight_of(entry.value) is None:
            entry.needs(f"a number from 0 to 1e{MAX_EXPONENT}")
    for _, entry in root.at("language").entries():
        value = entry.value
        several = isinstance(value, list) and bool(value) and all(isinstance(each, str) for each in value)
        if not (several or isinstance(value, str | Mapping)):
            entry.needs("a sentence in quotes, or several in a list")
    yield from _located(root.report.problems, settings)


def name_problems(settings: Settings, facts: Facts) -> Iterator[Problem]:
    """Yield the weights, sentences and scene entries that do not match the declarations in the logic.

    Pruned actions count as declared.
    """
    report = TableReport()
    for key in settings.weights:
        _check_weight(TableEntry(report, ("weights", key)), key, facts)
    _check_sentences(report, settings, facts)
    yield from _located(report.problems, settings)
    if settings.grammar:
        from prag_asp.grammar.problems import grammar_problems  # noqa: PLC0415 - many domains have no language

        yield from _located(grammar_problems(settings, facts), settings)
    if settings.scene:
        from prag_asp.scene.scene_loader import scene_problems  # noqa: PLC0415 - many domains have no scene

        classes, entities, folder = facts.class_names, facts.entity_names, settings.path.parent
        problems = scene_problems(settings.scene, classes, entities, map(atom_of, facts.fluents), folder=folder)
        causes: list[TableProblem] = []
        for problem in problems:  # a problem of a table follows from a problem within it
            if not any(cause.keys[: len(problem.keys)] == problem.keys for cause in causes):
                causes.append(problem)
        yield from _located(causes, settings)


def _located(problems: Iterable[TableProblem], settings: Settings) -> Iterator[Problem]:
    """Yield problems in domain.toml, each with the path and the line of its key."""
    for each in problems:
        yield Problem(settings.path, settings.line_of(*each.keys), str(each), each.warning)


def _check_weight(entry: TableEntry, key: str, facts: Facts) -> None:
    """Report a weight whose key names nothing or is ambiguous."""
    actions, weighable = facts.action_names, set[str]().union(*named(facts).values())
    parts = key.split(">")
    for part in parts:
        if len(parts) > 1 and part not in actions:
            hint = did_you_mean(part, actions, f"actions are {', '.join(sorted(actions))}")
            entry.add(f"there is no action {part or repr(part)}; {hint}")
        elif part not in weighable:
            hint = did_you_mean(part, weighable, "give the name of an action, a class or an entity")
            entry.add(f"no action, class or entity has that name; {hint}")
        elif len(parts) == 1 and (several := ambiguity(part, facts)):
            entry.add(several)
    if len(parts) > 2:
        entry.add("has more than two actions; write pairs such as grasp>move")


def _check_sentences(report: TableReport, settings: Settings, facts: Facts) -> None:
    """Report sentences directly under ``[language]`` for unknown names, or with an index that no argument has."""
    arities: dict[str, int] = {}
    for term in (*facts.fluents, *facts.declared_actions) if settings.language else ():
        arities[term.name] = max(arities.get(term.name, 0), len(term.arguments))
    for name in settings.language:
        entry = TableEntry(report, ("language", name), settings.grammar[name])
        sentences = entry.value if isinstance(entry.value, list) else [str(entry.value)]
        if name not in arities:
            hint = did_you_mean(name, arities, "give the name of an action or a fluent")
            warning = "" if is_misspelt(name, arities) else "no-effect"
            entry.add(f"no action or fluent has that name; {hint}", warning)
        elif not all(_is_template(sentence, arities[name]) for sentence in sentences):
            places = ", ".join(f"{{{index}}}" for index in range(arities[name])) or "no braces"
            entry.add(f"has braces that name no argument; use {places}")


def _is_template(sentence: str, arity: int) -> bool:
    """Return whether each pair of braces contains the index of an argument."""
    try:
        fields = [name for _, name, _, _ in Formatter().parse(sentence) if name is not None]
        decimal = all(name.isdecimal() and int(name) < arity for name in fields)
        return decimal and bool(sentence.format(*[""] * arity) or True)
    except ValueError:
        return False

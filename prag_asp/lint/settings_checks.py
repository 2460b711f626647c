"""domain.toml: unknown keys, wrong types, weights of unknown names, and a scene that physics cannot build."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from string import Formatter
from typing import Any

from prag_asp.atom import atom_of
from prag_asp.program.entity_names import ambiguity, named, shared_names
from prag_asp.program.facts import Facts
from prag_asp.program.problem import Problem
from prag_asp.program.settings import KEYS, MAX_EXPONENT, Settings, key_shown, weight_of
from prag_asp.wording import did_you_mean, is_misspelt

TYPES: Mapping[str, tuple[type, str]] = {
    "title": (str, 'a string, such as "Blocks on a table"'),
    "description": (str, 'a string, such as "Blocks on a table"'),
    "weights": (dict, "a table, such as [weights] with grasp = 2 below it"),
    "language": (dict, 'a table, such as [language] with grasp = "grasp {1}" below it'),
    "scene": (dict, "a table that begins with [scene]"),
}


def table_problems(table: Mapping[str, Any], settings: Settings) -> Iterator[Problem]:
    """Yield the unknown keys and the wrong types of a domain.toml."""
    path = settings.path
    for key, value in table.items():
        if key not in KEYS:
            text = f"unknown key {key_shown(key)}; {did_you_mean(key, KEYS)}"
            yield Problem(path, settings.line_of(key), text, "" if is_misspelt(key, KEYS) else "no-effect")
        elif not isinstance(value, TYPES[key][0]):
            yield Problem(path, settings.line_of(key), f"{key} is {_shown(value)}; make it {TYPES[key][1]}")
        elif key == "scene" and not value:
            yield Problem(path, settings.line_of(key), "[scene] is empty; give it [scene.shapes], or remove it")
    for key, value in _entries(table, "weights"):
        if weight_of(value) is None:
            yield Problem(
                path,
                settings.line_of("weights", key),
                f"the weight of {key_shown(key)} is {_shown(value)}; make it a number from 0 to 1e{MAX_EXPONENT}",
            )
    for key, value in _entries(table, "language"):
        several = isinstance(value, list) and bool(value) and all(isinstance(each, str) for each in value)
        if not (several or isinstance(value, str | Mapping)):
            yield Problem(
                path,
                settings.line_of("language", key),
                f"{key_shown(key)} is {_shown(value)}; make it a sentence in quotes",
            )


def name_problems(settings: Settings, facts: Facts) -> Iterator[Problem]:
    """Yield the weights, the sentences and the parts of the scene that do not fit what the logic declares.

    An action that is left out is declared all the same.
    """
    yield from _weight_problems(settings, facts)
    yield from _language_problems(settings, facts)
    if settings.scene:
        yield from _scene_problems(settings, facts)


def _entries(table: Mapping[str, Any], name: str) -> Iterator[tuple[str, Any]]:
    found = table.get(name, {})
    if isinstance(found, Mapping):
        yield from found.items()


def _weight_problems(settings: Settings, facts: Facts) -> Iterator[Problem]:
    if not settings.weights:
        return
    actions = facts.action_names
    known, shared = set[str]().union(*named(facts).values()), shared_names(facts)
    for key in settings.weights:
        parts = key.split(">")
        for part in parts:
            if len(parts) > 1 and part not in actions:
                hint = did_you_mean(part, actions, f"actions are {', '.join(sorted(actions))}")
                text = f"weight of {key}: there is no action {key_shown(part)}; {hint}"
                yield _problem(settings, "weights", key, text)
            elif part not in known:
                hint = did_you_mean(part, known, "give the name of an action, a class or an entity")
                text = f"weight of {key_shown(part)}: no action, class or entity has that name; {hint}"
                yield _problem(settings, "weights", key, text)
            elif len(parts) == 1 and part in shared:
                yield _problem(settings, "weights", key, f"weight of {part}: {ambiguity(part, facts)}")
        if len(parts) > 2:
            text = f"weight of {key}: more than two actions; write pairs such as grasp>move"
            yield _problem(settings, "weights", key, text)


def _language_problems(settings: Settings, facts: Facts) -> Iterator[Problem]:
    arities: dict[str, int] = {}
    for term in (*facts.fluents, *facts.declared_actions) if settings.language else ():
        arities[term.name] = max(arities.get(term.name, 0), len(term.arguments))
    for name in settings.language:
        if name not in arities:
            hint = did_you_mean(name, arities, "give the name of an action or a fluent")
            text = f"sentence of {key_shown(name)}: no action or fluent has that name; {hint}"
            yield _problem(settings, "language", name, text, "" if is_misspelt(name, arities) else "no-effect")
        elif not all(_is_template(sentence, arities[name]) for sentence in _sentences(settings.grammar[name])):
            places = ", ".join(f"{{{index}}}" for index in range(arities[name])) or "no braces"
            text = f"sentence of {name} has braces without the number of an argument; use {places}"
            yield _problem(settings, "language", name, text)
    if settings.grammar:
        from prag_asp.grammar.problems import grammar_problems  # noqa: PLC0415 - many domains have no language

        for fault in grammar_problems(settings, facts):
            line = settings.line_of("language", *fault.keys)
            yield Problem(settings.path, line, fault.text, fault.warning)


def _sentences(given: object) -> Sequence[str]:
    return given if isinstance(given, list) else [str(given)]


def _problem(settings: Settings, table: str, key: str, text: str, name: str = "") -> Problem:
    return Problem(settings.path, settings.line_of(table, key), text, name)


def _is_template(sentence: str, arity: int) -> bool:
    """Return whether each pair of braces holds the index of an argument."""
    try:
        fields = [name for _, name, _, _ in Formatter().parse(sentence) if name is not None]
        known = all(name.isdecimal() and int(name) < arity for name in fields)
        return known and bool(sentence.format(*[""] * arity) or True)
    except ValueError:
        return False


def _scene_problems(settings: Settings, facts: Facts) -> Iterator[Problem]:
    """Yield the problems of the scene; one of a table follows from one within it."""
    from prag_asp.scene.scene_loader import scene_problems  # noqa: PLC0415 - many domains have no scene

    fluents = list(map(atom_of, facts.fluents))
    classes, entities, folder = facts.class_names, facts.entity_names, settings.path.parent
    found = scene_problems(settings.scene, classes, entities, fluents, folder=folder)
    reported: set[str] = set()
    for key, text in found:
        if not any(f"{each}.".startswith(f"{key}.") for each in reported):
            reported.add(key)
            yield Problem(
                settings.path,
                settings.line_of(*key.split(".")),
                f"{key}: {text}{'' if ';' in text else f'; set {key}'}",
            )


def _shown(value: object) -> str:
    """Return a value of a TOML file as it is spelled there, shortened."""
    text = {True: "true", False: "false"}[value] if isinstance(value, bool) else str(value)
    text = f'"{text}"' if isinstance(value, str) else text
    return text if len(text) <= 40 else f"{text[:40]}..."

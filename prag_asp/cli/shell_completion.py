"""Completion of words in a shell; if anything fails, it completes nothing and prints nothing."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterable, Iterator
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from prag_asp.cli.arguments import domain_and_others, parse_constant_options
from prag_asp.program.paths import PDDL, data_folder, is_file_name, rule_names, shipped_domains, shipped_suites
from prag_asp.safe_reading import STANDARD_INPUT

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem

    from prag_asp.domain.load import Domain

Items = list["CompletionItem[Any]"]
Completer = Callable[[click.Context, click.Parameter, str], Items]

ONE_WORD = re.compile(r"[\w./:=+@%^-]*")
"""The pattern of texts that bash reads as one word."""

ENTITIES, ACTIONS = ("uses", "avoids"), ("begins", "has", "lacks")
"""Keywords of conditions on entities and classes, and of conditions on actions."""


def _completer(candidates: Callable[[click.Context, str], Iterable[str]]) -> Completer:
    """Return a completer that offers the candidates that begin with the typed text."""

    @wraps(candidates)
    def complete(context: click.Context, parameter: click.Parameter, typed: str) -> Items:
        from click.shell_completion import CompletionItem

        try:
            return [CompletionItem(each) for each in candidates(context, typed) if each.startswith(typed)]
        except Exception:  # such as a domain that cannot be read
            return []

    return complete


def files(context: click.Context, parameter: click.Parameter, typed: str) -> Items:
    """Leave the completion of files and folders to the shell."""
    from click.shell_completion import CompletionItem

    return [CompletionItem(typed, type="file")]


def domains(context: click.Context, parameter: click.Parameter, typed: str) -> Items:
    """Complete shipped domains, and folders and files that are domains, or else any files."""
    words = context.params.get(parameter.name or "") or ()

    @_completer
    def offer(context: click.Context, typed: str) -> Iterator[str]:
        if all(map(is_file_name, words)):
            yield from () if words else shipped_domains()
            folder = typed[: typed.rfind("/") + 1]
            for path in sorted(Path(folder or ".").iterdir()):
                if path.suffix in (".lp", PDDL) or (not words and (path / "domain.lp").is_file()):
                    yield f"{folder}{path.name}"

    return offer(context, parameter, typed) or files(context, parameter, typed)


def actions(context: click.Context, parameter: click.Parameter, typed: str) -> Items:
    """Complete a domain first, then actions of that domain."""
    domain, others = domain_and_others(context.params.get(parameter.name or "") or ())
    if not domain or (not others and is_file_name(typed)):
        return domains(context, parameter, typed)
    return plan(context, parameter, typed)


def shares(context: click.Context, parameter: click.Parameter, typed: str) -> Items:
    """Complete a domain; the names of the parts after it are free, and are not completed."""
    domain, _ = domain_and_others(context.params.get(parameter.name or "") or ())
    return [] if domain and not is_file_name(typed) else domains(context, parameter, typed)


@_completer
def rules(context: click.Context, typed: str) -> Iterable[str]:
    """Complete rules of the encodings."""
    encodings = context.params.get("encodings")
    return rule_names(Path(encodings) if encodings else data_folder("encodings"))


@_completer
def suites(context: click.Context, typed: str) -> Iterable[str]:
    """Complete shipped suites, and TOML files."""
    folder = typed[: typed.rfind("/") + 1]
    return [*shipped_suites(), *sorted(f"{folder}{path.name}" for path in Path(folder or ".").glob("*.toml"))]


@_completer
def engines(context: click.Context, typed: str) -> Iterable[str]:
    """Complete the names of engines."""
    from prag_asp.space.engines import AUTO, ENGINES

    return (AUTO, *ENGINES)


@_completer
def metrics(context: click.Context, typed: str) -> Iterable[str]:
    """Complete metrics between tasks."""
    from prag_asp.similarity.metrics import METRICS

    return METRICS


@_completer
def languages(context: click.Context, typed: str) -> Iterable[str]:
    """Complete languages of the domain."""
    from prag_asp.grammar.reader import languages as spoken

    return spoken(_domain(context).settings)


@_completer
def plan(context: click.Context, typed: str) -> Iterable[str]:
    """Complete the next action of a plan."""
    return _after(typed, map(str, _domain(context).facts.actions))


@_completer
def prefix(context: click.Context, typed: str) -> Iterable[str]:
    """Complete the next action, or the name of an action."""
    actions = _domain(context).facts.actions
    return _after(typed, [*_names_of(actions), *map(str, actions)])


@_completer
def names(context: click.Context, typed: str) -> Iterable[str]:
    """Complete names of actions, classes and entities."""
    facts = _domain(context).facts
    return [*_names_of(facts.actions), *sorted(facts.class_names), *map(str, facts.entities)]


@_completer
def cameras(context: click.Context, typed: str) -> Iterable[str]:
    """Complete the next camera of the scene."""
    from prag_asp.domain.load import load_scene

    return _after(typed, load_scene(_domain(context)).cameras)


@_completer
def kinds_that_vary(context: click.Context, typed: str) -> Iterable[str]:
    """Complete the next property that can vary."""
    from prag_asp.scene.variation import KINDS

    return _after(typed, KINDS)


@_completer
def conditions(context: click.Context, typed: str) -> Iterator[str]:
    """Complete the keyword of a condition, and then its argument."""
    from prag_asp.space.conditions.keywords import KEYWORDS

    keywords = [word for word in KEYWORDS if f"{word} ".startswith(typed) or typed.startswith(f"{word} ")]
    if len(keywords) != 1 or keywords[0] not in (*ENTITIES, *ACTIONS):
        yield from keywords
        return
    facts = _domain(context).facts
    arguments = (
        [*map(str, facts.entities), *sorted(facts.class_names)] if keywords[0] in ENTITIES else _names_of(facts.actions)
    )
    yield from (f"{keywords[0]} {each}" for each in arguments)


def _domain(context: click.Context) -> Domain:
    """Load the domain in an incomplete command line, which click has not parsed if an option still lacks its value."""
    from prag_asp.domain.load import load_domain

    sources, _ = domain_and_others(context.params.get("names") or context.params.get("words") or context.args)
    if STANDARD_INPUT in sources:
        raise EOFError
    constants = parse_constant_options(context.params.get("constants") or ())
    return load_domain(*sources, constants=constants, encodings=context.params.get("encodings"))


def _names_of(actions: Iterable[Any]) -> list[str]:
    from prag_asp.program.entity_names import action_name

    return sorted(set(map(action_name, actions)))


def _after(typed: str, candidates: Iterable[str]) -> Iterator[str]:
    """Yield candidates, each appended to the typed text up to the last space or comma outside parentheses."""
    depth, start = 0, 0
    for position, character in enumerate(typed):
        depth += (character == "(") - (character == ")")
        if depth == 0 and character in " ,":
            start = position + 1
    yield from (f"{typed[:start]}{each}" for each in candidates)


def complete(group: click.Group, program: str, variable: str) -> int:
    """Print the completions that a shell requests through an environment variable, and return the exit code."""
    from click.shell_completion import shell_complete

    add_shells()
    return shell_complete(group, {}, program, variable, os.environ[variable])


def add_shells() -> None:
    """Adapt click's completion for bash and fish to texts with parentheses and commas, such as actions."""
    from click.shell_completion import BashComplete, FishComplete, add_completion_class

    class Bash(BashComplete):
        """The completion for bash, which quotes texts that bash would not read as one word."""

        def format_completion(self, item: CompletionItem[Any]) -> str:
            """Return an item in the format of the script, quoted unless the user has opened a quote."""
            words = os.environ["COMP_WORDS"].split("\n")
            number = int(os.environ["COMP_CWORD"])
            quoted = number < len(words) and words[number][:1] in ("'", '"')
            if item.type == "plain" and not quoted and not ONE_WORD.fullmatch(item.value):
                return f"{item.type},'{item.value}'"
            return super().format_completion(item)

    class Fish(FishComplete):
        """The completion for fish, which splits an item only at the first comma, because values may contain commas."""

        source_template = FishComplete.source_template.replace('split ","', 'split --max 1 ","')

    add_completion_class(Bash)
    add_completion_class(Fish)

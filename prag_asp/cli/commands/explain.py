"""``prag-asp explain``: why a sequence of actions is not a plan, or why a space has no tasks."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING

import click

from prag_asp.atom import parse_atom, split_actions
from prag_asp.cli import shell_completion
from prag_asp.cli.arguments import domain_and_others, parse_length
from prag_asp.cli.domain_options import PROGRAM, WHERE, DomainOptions, domain_options
from prag_asp.cli.exits import Exit
from prag_asp.cli.options import whole
from prag_asp.cli.terminal import say
from prag_asp.errors import EngineError, LimitReached, QueryError
from prag_asp.wording import plural

if TYPE_CHECKING:
    from prag_asp.space.task_space import TaskSpace


GOAL = re.compile(r"\bgoal\(")


@click.command()
@click.argument(
    "words", metavar="DOMAIN... ACTION...", nargs=-1, required=True, shell_complete=shell_completion.actions
)
@domain_options(*PROGRAM, WHERE)
@click.option(
    "-n", "--length", "number", type=parse_length, metavar="N",
    help="Explain why there is no task of N actions.",
)  # fmt: skip
@click.option(
    "--why-not",
    "action",
    metavar="ACTION",
    help="With --length: explain why no task of N actions has this action, or an action of this name.",
)
@click.option("--step", type=whole(1), metavar="K", help="With --why-not: only as action number K of the task, from 1.")
@click.option("--smallest", is_flag=True, help="With --length: name as few lines as possible, which takes longer.")
@click.option(
    "--fewest-changes", "changes", is_flag=True,
    help="With --length: name each line whose removal alone leaves a task, or else a smallest set of lines to remove.",
)  # fmt: skip
def explain(
    *, request: DomainOptions, words: tuple[str, ...], number: int | None, action: str | None, step: int | None,
    smallest: bool, changes: bool,
) -> None:  # fmt: skip
    """Explain why a sequence of actions is not a plan.

    With --length, explain why there is no task of that length.

    Actions are separate arguments, or one argument in which spaces or commas separate them. For a sequence that is not
    a plan, prints the first step that cannot occur, the reason, and which steps conflict. For a length without tasks,
    prints a set of lines of the domain that together exclude every task, while no proper subset does. The exit code is
    1 if the sequence is not a plan or there is no task, otherwise 0.
    """
    if number is None:
        given = {"--where": request.where, "--why-not": action, "--step": step, "--smallest": smallest}
        for option in [name for name, value in {**given, "--fewest-changes": changes}.items() if value]:
            raise QueryError(f"{option} is about all tasks of a length; add --length")
        _explain_plan(request, words)
        return
    names, texts = domain_and_others(words)
    if texts:
        raise QueryError(f"{texts[0]!r}: --length is about all tasks, not a sequence of actions; leave one of them out")
    if smallest and changes:
        raise QueryError("--smallest and --fewest-changes name different sets of lines; leave one of them out")
    space = replace(request, names=names, length=number).space()
    lines = list(_changes(space, action, step) if changes else _reasons(space, action, step, smallest=smallest))
    if lines and action is None:
        lines.extend(_other_lengths(space))
    if not lines:
        say(f"{space.domain.label} has tasks of {_describe_request(space, action, step, satisfy='satisfy')}")
        return
    for line in lines:
        say(line)
    raise click.exceptions.Exit(Exit.NOT_FOUND)


def _explain_plan(request: DomainOptions, words: tuple[str, ...]) -> None:
    """Print why a sequence of actions is not a plan.

    Raises:
        QueryError: a word is not an action.
    """
    from prag_asp.space.explanation import explain as explain_actions

    names, texts = domain_and_others(words)
    actions = [str(parse_atom(text)) for text in split_actions(*texts)]
    if texts and not actions:
        raise QueryError(f"{texts[0]!r} is not an action; write actions, such as grasp(panda,apple_1), or none")
    domain = replace(request, names=names).domain()
    explanation = explain_actions(domain, actions)
    if explanation is None:
        say(f"a plan of {domain.label}")
        return
    if not explanation.step:
        say("no initial state is possible:")
    elif explanation.step > len(actions):
        say("every step can occur, but the final state is not allowed:")
    else:
        impossible = "follow" if explanation.step > 1 else "come first"
        say(f"step {explanation.step}, {actions[explanation.step - 1]}, cannot {impossible}:")
    for reason in explanation.reasons:
        say(f"  {reason}")
    if not explanation.conflict:
        say("there is no plan of this length")
    else:
        say("no plan of this length has all of these steps:")
        for step in explanation.conflict:
            say(f"  step {step}, {actions[step - 1]}")
    raise click.exceptions.Exit(Exit.NOT_FOUND)


def _reasons(space: TaskSpace, action: str | None, step: int | None, *, smallest: bool) -> Iterator[str]:
    """Yield lines that explain why a space is empty, or nothing if the space has a task."""
    from prag_asp.space.emptiness import why_empty

    found = why_empty(space, action=action, step=step, smallest=smallest)
    if found is None:
        return
    yield f"{space.domain.label} has no task of {_describe_request(space, action, step)}"
    goal = space.domain.facts.goal
    if goal and any(GOAL.search(line.text) for line in found.lines):
        yield f"the goal is {', '.join(f'{fluent}' if value == 'true' else f'not {fluent}' for fluent, value in goal)}"
    if found.conditions:
        yield "these conditions exclude every task:"
        yield from (f"  {clause}" for clause in found.conditions)
    if found.lines:
        yield "these lines together exclude every task:"
        yield from (f"  {line}" for line in found.lines)
    elif found.conditions:
        yield "they do so without any line that restricts plans"
    else:
        yield "no line excludes it: the declarations of the domain alone allow none"


def _other_lengths(space: TaskSpace) -> Iterator[str]:
    """Yield a line about the shortest length that has a task, or its absence, unless the search takes too long."""
    from prag_asp.space.emptiness import shortest_length

    where = " that satisfies the conditions" if space.condition else ""
    with suppress(EngineError, LimitReached):
        shortest = shortest_length(space)
        if shortest is None:
            yield f"there is no task of any length{where}"
        else:
            yield f"the shortest task{where} has {plural(shortest, 'action')}"


def _changes(space: TaskSpace, action: str | None, step: int | None) -> Iterator[str]:
    """Yield lines whose removal leaves a task in an empty space, or nothing if the space has a task."""
    from prag_asp.space.emptiness import fewest_changes

    found = fewest_changes(space, action=action, step=step)
    if found == ((),):
        return
    yield f"{space.domain.label} has no task of {_describe_request(space, action, step)}"
    if not found:
        yield "there is none even without all lines that restrict plans"
    elif len(found[0]) == 1:
        yield "removing any one of these lines leaves a task:"
        yield from (f"  {line}" for (line,) in found)
    else:
        yield "removing all of these lines leaves a task, and removing fewer does not:"
        yield from (f"  {line}" for line in found[0])


def _describe_request(space: TaskSpace, action: str | None, step: int | None, satisfy: str = "satisfies") -> str:
    """Return the length, the action and the conditions in words; `satisfy` is the verb for the tasks."""
    from prag_asp.space.lengths import spelled_lengths

    having = "" if action is None else f" with {action}{'' if step is None else f' as step {step}'}"
    clauses = " and ".join(f"'{clause}'" for clause in space.condition.clauses)
    return f"length {spelled_lengths(space.lengths)}{having}{f' that {satisfy} {clauses}' if clauses else ''}"

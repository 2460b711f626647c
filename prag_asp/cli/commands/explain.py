"""The command that says why a sequence of actions is no plan, and why there is none."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import click

from prag_asp.atom import parse_atom, split_actions
from prag_asp.cli import options, shell_completion
from prag_asp.cli.arguments import domain_and_others, one_length
from prag_asp.cli.domain_options import Asked
from prag_asp.cli.exits import Exit
from prag_asp.cli.options import asks
from prag_asp.cli.terminal import say
from prag_asp.errors import QueryError

if TYPE_CHECKING:
    from prag_asp.logic.formula.explanation import Explanation
    from prag_asp.space.task_space import TaskSpace


@click.command()
@click.argument(
    "words", metavar="DOMAIN... ACTION...", nargs=-1, required=True, shell_complete=shell_completion.actions
)
@asks((*options.PROGRAM, options.WHERE))
@click.option(
    "-n", "--length", "number", type=one_length, metavar="N",
    help="Say why there is no task of N actions, in place of why some actions are no plan.",
)  # fmt: skip
@click.option("--why-not", "action", metavar="ACTION", help="Say why no task of N actions has it, or one of its name.")
@click.option("--step", type=options.whole(1), metavar="K", help="With --why-not: as its action K, from 1.")
@click.option("--smallest", is_flag=True, help="Name as few lines as can be, which takes longer.")
@click.option(
    "--fewest-changes", "changes", is_flag=True,
    help="Name lines each of which, removed, leaves a task; or else a smallest set of lines that does.",
)  # fmt: skip
def explain(
    *, asked: Asked, words: tuple[str, ...], number: int | None, action: str | None, step: int | None,
    smallest: bool, changes: bool,
) -> None:  # fmt: skip
    """Say why a sequence of actions is no plan, or with --length why there is no task at all.

    Actions are arguments of their own, or several in one, separated by blanks or commas. Of a plan that is none, the
    first step that cannot occur is told, why, and which steps conflict. Of a length without a task, the lines of the
    domain are told that leave none together, though they would without any one of them. Ends with code 1 where there is
    something to explain, with 0 where there is not.
    """
    if number is None:
        given = {"--where": asked.where, "--why-not": action, "--step": step, "--smallest": smallest}
        for option in [name for name, value in {**given, "--fewest-changes": changes}.items() if value]:
            raise QueryError(f"{option} asks about all tasks of a length; give --length")
        _explain_plan(asked, words)
        return
    names, texts = domain_and_others(words)
    if texts:
        raise QueryError(f"{texts[0]!r}: --length asks about all tasks, so no actions are given; drop one or the other")
    if smallest and changes:
        raise QueryError("--smallest and --fewest-changes ask for different sets of lines; give one of them")
    space = replace(asked, names=names, length=number).space()
    lines = list(_changes(space, action, step) if changes else _reasons(space, action, step, smallest=smallest))
    if not lines:
        say(f"there are tasks of {_asked_for(space, action, step)}")
        return
    for line in lines:
        say(line)
    raise click.exceptions.Exit(Exit.NOT_FOUND)


def _explain_plan(asked: Asked, words: tuple[str, ...]) -> None:
    """Say why a sequence of actions is no plan."""
    from prag_asp.space.explanation import explain as explained

    names, texts = domain_and_others(words)
    actions = [str(parse_atom(text)) for text in split_actions(*texts)]
    if texts and not actions:
        raise QueryError(f"{texts[0]!r} is no action; write actions, such as grasp(panda,apple_1), or none")
    domain = replace(asked, names=names).domain()
    found = explained(domain, actions)
    if found is None:
        say(f"a plan of {domain.label}")
        return
    for line in _told(found, actions):
        say(line)
    raise click.exceptions.Exit(Exit.NOT_FOUND)


def _reasons(space: TaskSpace, action: str | None, step: int | None, *, smallest: bool) -> Iterator[str]:
    """Yield why a space is empty, nothing where it is not."""
    from prag_asp.space.emptiness import why_empty

    found = why_empty(space, action=action, step=step, smallest=smallest)
    if found is None:
        return
    yield f"there is no task of {_asked_for(space, action, step)}"
    if found.conditions:
        yield "these conditions are too much:"
        yield from (f"  {clause}" for clause in found.conditions)
    if found.lines:
        yield "these lines leave none together:"
        yield from (f"  {line}" for line in found.lines)
    else:
        yield "no line forbids it: what the domain declares leaves none, whatever its lines say of it"


def _changes(space: TaskSpace, action: str | None, step: int | None) -> Iterator[str]:
    """Yield which lines, removed, leave a task in an empty space; nothing where it is not."""
    from prag_asp.space.emptiness import fewest_changes

    found = fewest_changes(space, action=action, step=step)
    if found == ((),):
        return
    yield f"there is no task of {_asked_for(space, action, step)}"
    if not found:
        yield "there is none even without all the lines that restrict plans"
    elif len(found[0]) == 1:
        yield "there is one without any one of these lines:"
        yield from (f"  {line}" for (line,) in found)
    else:
        yield "there is one without all of these lines, and no fewer will do:"
        yield from (f"  {line}" for line in found[0])


def _asked_for(space: TaskSpace, action: str | None, step: int | None) -> str:
    """Return in words which tasks are meant."""
    having = "" if action is None else f" with {action}{'' if step is None else f' as step {step}'}"
    return f"{space.title}{having}"


def _told(found: Explanation, plan: Sequence[str]) -> Iterator[str]:
    if not found.step:
        yield "not even the start is possible:"
    elif found.step > len(plan):
        yield "every step can occur, but the plan cannot end there:"
    else:
        yield f"step {found.step}, {plan[found.step - 1]}, cannot {'follow' if found.step > 1 else 'come first'}:"
    yield from (f"  {reason}" for reason in found.reasons)
    if not found.conflict:
        yield "there is no plan of this length at all"
        return
    yield "no plan of this length has these steps, whatever its others are:"
    yield from (f"  step {step}, {plan[step - 1]}" for step in found.conflict)

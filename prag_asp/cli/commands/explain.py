"""The command that says why a sequence of actions is no plan."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import click

from prag_asp.atom import parse_atom, split_actions
from prag_asp.cli import complete, options
from prag_asp.cli.asked import Asked
from prag_asp.cli.ending import FAILED
from prag_asp.cli.options import asks
from prag_asp.cli.words import domain_and_others
from prag_asp.errors import QueryError

if TYPE_CHECKING:
    from prag_asp.logic.formula.explain import Explanation


@click.command()
@click.argument("words", metavar="DOMAIN... ACTION...", nargs=-1, required=True, shell_complete=complete.actions)
@asks(options.PROGRAM)
def explain(*, asked: Asked, words: tuple[str, ...]) -> None:
    """Say why a sequence of actions is no plan: the first step that cannot occur, why, and which steps conflict.

    Actions are arguments of their own, or several in one, separated by blanks or commas. Ends with code 1 where it is
    no plan, with 0 where it is one.
    """
    from prag_asp.space.explain import explain as explained

    names, texts = domain_and_others(words)
    actions = [str(parse_atom(text)) for text in split_actions(*texts)]
    if texts and not actions:
        raise QueryError(f"{texts[0]!r} is no action; write actions, such as grasp(panda,apple_1), or none")
    domain = replace(asked, names=names).domain()
    found = explained(domain, actions)
    if found is None:
        click.echo(f"a plan of {domain.label}")
        return
    for line in _told(found, actions):
        click.echo(line)
    raise click.exceptions.Exit(FAILED)


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

"""The command that says why a sequence of actions is no plan."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import click

from prag_asp.cli import options
from prag_asp.cli.commands import cli
from prag_asp.cli.options import Asked, asks
from prag_asp.cli.terminal import FAILED
from prag_asp.errors import QueryError

if TYPE_CHECKING:
    from prag_asp.logic.formula.explain import Explanation


@cli.command()
@asks(options.DOMAIN)
@click.argument("actions", metavar="ACTION...", nargs=-1)
def explain(*, asked: Asked, actions: tuple[str, ...]) -> None:
    """Say why a sequence of actions is no plan: the first step that cannot occur, why, and which steps conflict.

    Ends with code 1 where it is no plan, with 0 where it is one.
    """
    from prag_asp.logic.formula.explain import explain as reasons_against
    from prag_asp.logic.model import Model
    from prag_asp.space.engines.prefix import parse_prefix

    domain = asked.domain()
    plan = parse_prefix(actions, "plan", domain.facts)
    known = {str(action): action for action in domain.facts.actions}
    for action in plan:
        if action not in known:
            example = min(each for each in known if each.startswith(f"{action}("))
            raise QueryError(f"{action} is the name of several actions; give one in full, such as {example}")
    found = reasons_against(Model(domain), [known[action] for action in plan])
    if found is None:
        click.echo(f"a plan of {domain.name}")
        return
    for line in _told(found, plan):
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

"""``prag-asp sample``: tasks drawn with exact probabilities, and kept where physics finds them feasible."""

from __future__ import annotations

from contextlib import closing
from itertools import islice
from typing import Any

import click

from prag_asp.cli import options
from prag_asp.cli.asked import Asked
from prag_asp.cli.options import Checking, Weighing, asks
from prag_asp.cli.terminal import progress, require_unrecorded, require_writable, writer
from prag_asp.errors import OutputError
from prag_asp.wording import plural

DRAWS_FOR_EACH = 1000
"""Draws after which `sample` gives up, for each task wanted."""


@click.command()
@asks((*options.SPACES, options.TRUST))
@click.option("--count", "wanted", type=click.IntRange(min=0), default=10, show_default=True, help="How many tasks.")
@options.seed
@options.weighs
@click.option(
    "--over",
    type=click.Choice(["skeletons", "goals"]),
    help="Draw a skeleton (or a goal) uniformly first, then a task that has it.",
)
@click.option("--by", type=click.Choice(["plan", "task"]), default="task", show_default=True, help="What is drawn.")
@click.option("--physics/--no-physics", default=None, help="Keep feasible tasks only.  [default: if there is a scene]")
@options.checks
@click.option("--max-draws", type=click.IntRange(min=1), metavar="K", help="Give up after K draws.  [1000 a task]")
@options.form
@options.output
def sample(
    *,
    asked: Asked,
    wanted: int,
    seed: int,
    weighing: Weighing,
    over: Any,
    by: Any,
    physics: bool | None,
    checking: Checking,
    max_draws: int | None,
    form: str,
    output: str | None,
) -> None:
    """Draw tasks of length N, each with a probability proportional to its weight, exactly.

    Of several lengths, all tasks together are drawn from.
    """
    from prag_asp.dataset.jsonl import Record

    require_writable(output)
    require_unrecorded(checking.demonstrate)
    checking.tries()
    with progress() as tell:
        space = asked.spaces(tell)
        if physics is None:
            physics = bool(space.domain.settings.scene)
        if physics and space.domain.settings.scene:
            from prag_asp.physics import require_physics

            require_physics(f"the scene of {space.domain.name} needs physics (--no-physics draws without)")
        line = options.line_form(form, space.domain)
        drawing = {"by": by, "over": over, **weighing.arguments(space.domain)}
        if not physics:
            checking.refuse_without_physics({"--max-draws": max_draws is not None})
            drawn = space.draw(seed=seed, **drawing) if wanted else iter(())
            with writer(output) as write:
                for task in islice(drawn, wanted):
                    write(line(Record(task)))
            return
        from prag_asp.cli.tally import show_tally, tally_line
        from prag_asp.dataset import Tally, feasible

        limit, tally = max_draws or DRAWS_FOR_EACH * wanted, Tally()
        records = feasible(space, seed=seed, draws=limit, tally=tally, **checking.arguments(), **drawing)

        def told() -> str:
            return tally_line(tally, ("drawn", "drawn"), f"budget {checking.limits()}")

        try:
            with writer(output) as write, closing(records):
                for record in islice(records, wanted):
                    write(line(record))
                    tell(told(), tally.passed, wanted)
        finally:
            show_tally(tally, told())
        if tally.passed < wanted:
            found = f"only {tally.passed} of {plural(wanted, 'task')} found in {plural(tally.seen, 'draw')}"
            raise OutputError(f"{found}; raise --max-draws" if tally.seen == limit else found)

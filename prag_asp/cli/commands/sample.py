"""``prag-asp sample``: tasks drawn with exact probabilities, and kept where physics finds them feasible."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import closing
from dataclasses import dataclass
from itertools import islice
from typing import TYPE_CHECKING, Any

import click

from prag_asp.cli import options
from prag_asp.cli.bundles.camera_options import Filming, films
from prag_asp.cli.bundles.task_format import Telling, tells
from prag_asp.cli.domain_options import Asked
from prag_asp.cli.line_output import require_writable, writer
from prag_asp.cli.options import Checking, Weighing, asks
from prag_asp.cli.run_fingerprint import run_of
from prag_asp.cli.terminal import Tell, progress
from prag_asp.errors import NotFound, QueryError
from prag_asp.wording import plural

if TYPE_CHECKING:
    from prag_asp.dataset.jsonl import Record
    from prag_asp.space.task_space import TaskSpace

DRAWS_FOR_EACH = 1000
"""Draws after which `sample` gives up, for each task wanted."""


@click.command()
@asks((*options.SPACES, options.TRUST))
@click.option("--count", "wanted", type=options.whole(0), default=10, show_default=True, help="How many tasks.")
@options.seed
@options.weighs
@click.option(
    "--over",
    type=click.Choice(["skeletons", "goals"]),
    help="Draw a skeleton (or a goal) uniformly first, then a task that has it.",
)
@click.option("--by", type=click.Choice(["plan", "task"]), default="task", show_default=True, help="What is drawn.")
@click.option("--distinct", is_flag=True, help="No task twice: each is drawn among those that are left.")
@click.option("--physics/--no-physics", default=None, help="Keep feasible tasks only.  [default: if there is a scene]")
@options.checks
@films
@click.option("--max-draws", type=options.whole(1), metavar="K", help="Give up after K draws.  [1000 a task]")
@tells
@options.output
def sample(
    *,
    asked: Asked,
    wanted: int,
    seed: int,
    weighing: Weighing,
    over: Any,
    by: Any,
    distinct: bool,
    physics: bool | None,
    checking: Checking,
    filming: Filming,
    max_draws: int | None,
    telling: Telling,
    output: str | None,
) -> None:
    """Draw tasks of length N, each with a probability proportional to its weight, exactly.

    Of several lengths, all tasks together are drawn from. FILE is replaced as a whole at the end; a run that was broken
    off goes on where it was when it is started again.
    """
    from prag_asp.dataset.jsonl import Record

    telling.check()
    require_writable(output)
    checking.limits()
    filming.refuse_at_odds(checking.demonstrate)
    with progress() as tell:
        space = asked.spaces(tell)
        if physics is None:
            physics = bool(space.domain.settings.scene)
        if physics and space.domain.settings.scene:
            from prag_asp.physics import require_physics

            require_physics(f"the scene of {space.domain.name} needs physics (--no-physics draws without)")
        line = telling.line(space.domain, seed)
        drawing = _distinct(over, by) if distinct else {"by": by, "over": over}
        drawing.update(weighing.arguments(space.domain))
        run = run_of(space.domain, told=[physics]) if output or checking.demonstrate else None
        if not physics:
            checking.refuse_without_physics({"--max-draws": max_draws is not None})
            drawn = space.stream(seed=seed, **drawing) if wanted else iter(())
            with writer(output, run, lambda lines, _: lines <= wanted) as out:
                found = out.lines
                for task in islice(drawn, out.lines, wanted):
                    out.write(line(Record(task)))
                    found += 1
            if found < wanted:
                raise NotFound(f"only {found} of {plural(wanted, 'task')}: no others are left to draw")
            return
        from prag_asp.dataset.scenes import scene_of

        staging, limit = filming.staging(scene_of(space.domain)), max_draws or DRAWS_FOR_EACH * wanted
        _feasible(_Drawing(space, wanted, limit, seed, {**drawing, "staging": staging}), checking, output, run, line,
                  tell)  # fmt: skip


def _distinct(over: str | None, by: str) -> dict[str, Any]:
    """Return the arguments of a draw of different tasks.

    Raises:
        QueryError: something else is to be drawn, or first.
    """
    if over is not None or by != "task":
        given = f"--over {over}" if over is not None else f"--by {by}"
        raise QueryError(f"--distinct draws tasks among those that are left; leave {given} out")
    return {"distinct": True}


@dataclass(frozen=True)
class _Drawing:
    """What is drawn, how many feasible tasks are wanted, and in how many draws."""

    space: TaskSpace
    wanted: int
    limit: int
    seed: int
    how: Mapping[str, Any]


def _feasible(
    drawing: _Drawing, checking: Checking, output: str | None, run: str | None, line: Callable[[Record], str],
    tell: Tell,
) -> None:  # fmt: skip
    """Write the feasible ones of the tasks that are drawn.

    Raises:
        NotFound: they are fewer than wanted.
    """
    from prag_asp.cli.summary import tallied, tally_line
    from prag_asp.dataset.episode_files import claim, remove_after
    from prag_asp.dataset.pass_rates import Tally
    from prag_asp.dataset.physics_filter import draws_looked_at

    tally, wanted, limit = Tally(), drawing.wanted, drawing.limit
    folder = checking.demonstrate

    def told() -> str:
        return tally_line(tally, ("drawn", "drawn"), f"budget {checking.limits()}")

    if folder is not None:
        claim(folder, run)
    with tallied(tally, told), writer(output, run, lambda _, state: _fits(state, drawing, folder)) as out:
        tally.go_on(out.state)
        looked_at = draws_looked_at(
            drawing.space, seed=drawing.seed, draws=limit, tally=tally, **checking.arguments(), **drawing.how
        )
        with closing(looked_at):
            for record in looked_at if tally.passed < wanted else ():
                out.write(line(record) if record is not None else None, tally.state())
                tell(told(), tally.passed, wanted)
                if tally.passed == wanted:
                    break
        if folder is not None:
            remove_after(folder, tally.passed)
    if tally.passed < wanted:
        found = f"only {tally.passed} of {plural(wanted, 'task')} found in {plural(tally.seen, 'draw')}"
        raise NotFound(f"{found}; raise --max-draws" if tally.seen == limit else found)


def _fits(state: Any, drawing: _Drawing, folder: str | None) -> bool:
    """Tell whether a broken run has come no further than this one is to, and has left its recordings."""
    from prag_asp.dataset.episode_files import recorded
    from prag_asp.dataset.pass_rates import Tally

    tally = Tally()
    tally.go_on(state)
    if tally.passed > drawing.wanted or tally.seen > drawing.limit:
        return False
    return folder is None or recorded(folder, tally.passed) == tally.passed

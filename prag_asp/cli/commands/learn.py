"""``prag-asp learn``: invariants that physics proves, and their effect on the task space."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import closing
from dataclasses import replace
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, get_args

import click

from prag_asp.cli import options
from prag_asp.cli.domain_options import SPACE, DomainOptions, domain_options
from prag_asp.cli.line_output import require_writable
from prag_asp.cli.options import whole
from prag_asp.cli.physics_options import PhysicsOptions, physics_options
from prag_asp.cli.terminal import aligned, progress, say, tell_line
from prag_asp.errors import QueryError
from prag_asp.output import file_in, replace_file

if TYPE_CHECKING:
    from prag_asp.dataset.pass_rates import Tally
    from prag_asp.scene.scene import Scene
    from prag_asp.space.task_space import TaskSpace

Row = tuple[str, ...]
"""A name, and the figures before and after learning."""


@click.command()
@domain_options(*SPACE, options.trust)
@click.option(
    "--count",
    "number",
    type=whole(0),
    default=200,
    show_default=True,
    help="Number of tasks to sample for the comparison.",
)
@options.seed
@physics_options
@click.option(
    "--write", is_flag=True,
    help="Write learned.lp into the domain's folder, and print the figures only.",
)  # fmt: skip
def learn(*, request: DomainOptions, number: int, seed: int, validation: PhysicsOptions, write: bool) -> None:
    """Propose rules that exclude what physics proves impossible.

    Prints rules for the file learned.lp and their effect: the numbers of plans, tasks and skeletons of length N, and
    how many of K uniformly sampled tasks pass the physics checks, with and without the rules. An existing learned.lp is
    ignored.
    """
    from prag_asp.dataset import learn as learn_rules
    from prag_asp.dataset.scenes import scene_of
    from prag_asp.domain.load import LEARNED
    from prag_asp.physics import require_physics

    validation.parse_budget()
    require_physics()
    with progress() as tell:
        before = replace(request, learned=False).space(tell)
        path = Path(LEARNED)
        if write:
            if before.domain.folder is None:
                what = f"--write writes {LEARNED} into a domain's folder"
                raise QueryError(f"{what}, but {before.domain.name} has none; give a folder")
            for option, given in (("--const", request.constants), ("--settings", request.settings)):
                if given:
                    raise QueryError(f"--write writes rules for the unchanged folder; leave {option} out")
            path = file_in(before.domain.folder, LEARNED)
            require_writable(str(path))
        rules = learn_rules(before.domain, path=path, progress=tell)
        after = request.space(tell, rules.domain) if rules.rules else before
        figures = _figures(before, after, scene_of(before.domain), number, seed, validation, tell)
        lines = [str(rules), *aligned(figures)]
    if write:
        replace_file(path, f"{rules.text.rstrip()}\n".encode(), follow=False)
        tell_line(f"wrote {path}")
    else:
        say(rules.text)
    for line in lines:
        say(line if write else f"% {line}".rstrip())


def _figures(
    before: TaskSpace, after: TaskSpace, scene: Scene, number: int, seed: int, validation: PhysicsOptions,
    tell: Callable[[str], None],
) -> Iterator[Row]:  # fmt: skip
    """Yield the rows of a table, before and after learning: sizes of the space, and the number of tasks that pass."""
    from prag_asp.space.engines import Level

    yield f"length {before.length}", "before", "after"
    for level in get_args(Level):
        yield f"{level}s", str(before.count(level)), str(after.count(level))
    tallies = [_tally(space, scene, number, seed, validation, tell) for space in (before, after)]
    yield "sampled", *(str(tally.seen) for tally in tallies)
    yield "passed", *(f"{tally.passed} ({100 * tally.passed / max(tally.seen, 1):.1f} %)" for tally in tallies)
    yield "proved infeasible", *(str(tally.proved) for tally in tallies)
    budget = str(validation.parse_budget())
    yield "budget", budget, budget


def _tally(
    space: TaskSpace, scene: Scene, number: int, seed: int, validation: PhysicsOptions, tell: Callable[[str], None]
) -> Tally:
    """Return the tally of physics for some uniformly sampled tasks."""
    from prag_asp.cli.summary import tally_line
    from prag_asp.dataset.pass_rates import Tally
    from prag_asp.physics import validate_tasks

    tally = Tally()

    def summary() -> str:
        return tally_line(tally, ("sampled", "sampled"), f"budget {validation.parse_budget()}")

    if number == 0 or space.count() == 0:
        return tally
    tasks = islice(space.stream(seed=seed, weights={}), number)
    with closing(
        validate_tasks(tasks, scene, seed=seed, workers=validation.workers, budget=validation.parse_budget())
    ) as verdicts:
        for verdict in verdicts:
            tally.add(verdict)
            tell(summary())
    tell_line(summary())
    return tally

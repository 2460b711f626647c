"""``prag-asp learn``: what physics proves impossible, as invariants of a domain, and what they change."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import closing
from dataclasses import replace
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, get_args

import click

from prag_asp.cli import options
from prag_asp.cli.domain_options import Asked
from prag_asp.cli.line_output import require_writable
from prag_asp.cli.options import Checking, asks
from prag_asp.cli.table import aligned
from prag_asp.cli.terminal import progress, say, tell_line
from prag_asp.errors import QueryError
from prag_asp.output import file_in, replace_file

if TYPE_CHECKING:
    from prag_asp.dataset.pass_rates import Tally
    from prag_asp.domain.load import Domain
    from prag_asp.scene.scene import Scene
    from prag_asp.space.task_space import TaskSpace

Row = tuple[str, ...]
"""A name, and the figures before and after."""


@click.command()
@asks((*options.SPACE, options.TRUST))
@click.option("--count", "wanted", type=options.whole(0), default=200, show_default=True, help="Tasks to draw.")
@options.seed
@options.checks
@click.option(
    "--write", is_flag=True,
    help="Write learned.lp into the domain's folder, whole or not at all, and print the figures only.",
)  # fmt: skip
def learn(*, asked: Asked, wanted: int, seed: int, checking: Checking, write: bool) -> None:
    """Find out what physics proves impossible, and propose rules that keep it out of the domain.

    Prints the rules for the file learned.lp, and what they change: the numbers of plans, tasks and skeletons of length
    N, and how many of K uniformly drawn tasks pass physics. A learned.lp that is there already is left out.
    """
    from prag_asp.dataset import learn as learned_from
    from prag_asp.dataset.scenes import scene_of
    from prag_asp.domain.load import LEARNED
    from prag_asp.physics import require_physics

    checking.limits()
    require_physics()
    with progress() as tell:
        before = replace(asked, learned=False).space(tell)
        path = _file(asked, before.domain) if write else Path(LEARNED)
        found = learned_from(before.domain, path=path, progress=tell)
        after = asked.space(tell, found.domain) if found.rules else before
        figures = _figures(before, after, scene_of(before.domain), wanted, seed, checking, tell)
        lines = [str(found), *aligned(figures)]
    if write:
        replace_file(path, f"{found.text.rstrip()}\n".encode(), follow=False)
        tell_line(f"wrote {path}")
    else:
        say(found.text)
    for line in lines:
        say(line if write else f"% {line}".rstrip())


def _file(asked: Asked, domain: Domain) -> Path:
    """Return the file that the rules are written to.

    Raises:
        QueryError: the domain has no folder, or is not what its folder says.
        OutputError: the file cannot be written.
    """
    from prag_asp.domain.load import LEARNED

    if domain.folder is None:
        raise QueryError(f"--write writes {LEARNED} into a domain's folder; {domain.name} has none, so give a folder")
    for option, given in (("--const", asked.constants), ("--settings", asked.settings)):
        if given:
            raise QueryError(f"--write writes what holds of the folder as it is; leave {option} out")
    path = file_in(domain.folder, LEARNED)
    require_writable(str(path))
    return path


def _figures(
    before: TaskSpace, after: TaskSpace, scene: Scene, wanted: int, seed: int, checking: Checking,
    tell: Callable[[str], None],
) -> Iterator[Row]:  # fmt: skip
    """Yield the lines of a table: the size of the space and what passes of it, before and after."""
    from prag_asp.space.engines import Level

    yield f"length {before.length}", "before", "after"
    for level in get_args(Level):
        yield f"{level}s", str(before.count(level)), str(after.count(level))
    tallies = [_tally(space, scene, wanted, seed, checking, tell) for space in (before, after)]
    yield "drawn", *(str(tally.seen) for tally in tallies)
    yield "passed", *(f"{tally.passed} ({100 * tally.passed / max(tally.seen, 1):.1f} %)" for tally in tallies)
    yield "proved infeasible", *(str(tally.proved) for tally in tallies)
    budget = str(checking.limits())
    yield "budget", budget, budget


def _tally(
    space: TaskSpace, scene: Scene, wanted: int, seed: int, checking: Checking, tell: Callable[[str], None]
) -> Tally:
    """Return how many of some uniformly drawn tasks pass physics."""
    from prag_asp.cli.summary import tally_line
    from prag_asp.dataset.pass_rates import Tally
    from prag_asp.physics import validate_tasks

    tally = Tally()

    def told() -> str:
        return tally_line(tally, ("drawn", "drawn"), f"budget {checking.limits()}")

    if wanted == 0 or space.count() == 0:
        return tally
    tasks = islice(space.stream(seed=seed, weights={}), wanted)
    with closing(
        validate_tasks(tasks, scene, seed=seed, workers=checking.workers, budget=checking.limits())
    ) as verdicts:
        for verdict in verdicts:
            tally.add(verdict)
            tell(told())
    tell_line(told())
    return tally

"""``prag-asp learn``: what physics proves impossible, as invariants of a domain, and what they change."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import closing
from dataclasses import replace
from itertools import islice
from typing import TYPE_CHECKING, get_args

import click

from prag_asp.cli import options
from prag_asp.cli.options import Asked, Checking, asks
from prag_asp.cli.terminal import progress, require_writable, writer
from prag_asp.errors import DomainError
from prag_asp.wording import plural

if TYPE_CHECKING:
    from prag_asp.dataset.tally import Tally
    from prag_asp.domain.load import Domain
    from prag_asp.scene.model import Scene
    from prag_asp.space.task_space import TaskSpace

Row = tuple[str, ...]
"""A name, and the figures before and after."""


@click.command()
@asks((*options.SPACE, options.TRUST))
@click.option("--count", "wanted", type=click.IntRange(min=0), default=200, show_default=True, help="Tasks to draw.")
@options.seed
@options.checks
@click.option("--write", is_flag=True, help="Write learned.lp into the domain's folder, and print the figures only.")
def learn(*, asked: Asked, wanted: int, seed: int, checking: Checking, write: bool) -> None:
    """Find out what physics proves impossible, and propose rules that keep it out of the domain.

    Prints the rules for the file learned.lp, and what they change: the numbers of plans, tasks and skeletons of length
    N, and how many of K uniformly drawn tasks pass physics. A learned.lp that is there already is left out.
    """
    from prag_asp.domain.load import LEARNED, with_learned
    from prag_asp.physics.proofs.learning import proved
    from prag_asp.physics.proofs.schemas import rules, text_of
    from prag_asp.program.sources import Source

    checking.tries()
    with progress() as tell:
        before = replace(asked, learned=False).space(tell)
        domain, scene = before.domain, options.scene_of(before.domain)
        if write:
            require_writable(str(domain.folder / LEARNED))
        found = rules(proved(domain.facts, scene, tell), domain.facts)
        path, text = domain.folder / LEARNED, text_of(found, domain.name)
        after = asked.space(tell, with_learned(domain, (Source(path, text),))) if found else before
        stated = plural(sum(len(rule.proofs) for rule in found), "proof")
        lines = [f"{plural(len(found), 'rule')} {'states' if len(found) == 1 else 'state'} {stated}"]
        lines += _aligned(_figures(before, after, scene, wanted, seed, checking, tell))
    if write:
        with writer(str(path)) as put:
            put(text.rstrip())
        click.echo(f"wrote {path}", err=True)
    else:
        click.echo(text)
    for line in lines:
        click.echo(line if write else f"% {line}".rstrip())


def require_proofs(domain: Domain) -> None:
    """Check that physics still proves what a domain has learned.

    Raises:
        DomainError: it does not, for the scene has changed or the file was written by hand.
    """
    if not domain.learned:
        return
    from prag_asp.domain.load import LEARNED
    from prag_asp.physics.proofs.learning import unproved

    for fluents in islice(unproved(domain, options.scene_of(domain)), 1):
        told = f"{fluents[0]} never holds" if len(fluents) == 1 else f"{fluents[0]} and {fluents[1]} exclude each other"
        raise DomainError(
            f"{domain.folder / LEARNED}:1: the scene does not prove that {told}; "
            f"write the file again with prag-asp learn {domain.folder} --length N --write"
        )


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
    from prag_asp.dataset.tally import Tally
    from prag_asp.physics import validate_tasks

    tally = Tally(("drawn", "drawn"), f"budget {checking.limits()}")
    if wanted == 0 or space.count() == 0:
        return tally
    tasks = islice(space.draw(seed=seed, weights={}), wanted)
    with closing(
        validate_tasks(tasks, scene, seed=seed, workers=checking.workers, budget=checking.limits())
    ) as verdicts:
        for verdict in verdicts:
            tally.add(verdict)
            tell(str(tally))
    click.echo(str(tally), err=True)
    return tally


def _aligned(rows: Iterator[Row]) -> list[str]:
    """Return the rows of a table as lines, the first column to the left and the others to the right."""
    listed = list(rows)
    widths = [max(map(len, column)) for column in zip(*listed, strict=True)]
    return [f"{row[0]:<{widths[0]}}  {row[1]:>{widths[1]}}  {row[2]:>{widths[2]}}" for row in listed]

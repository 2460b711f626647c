"""``prag-asp split``: tasks for training and testing, with nothing in common."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import replace
from typing import TYPE_CHECKING

import click

from prag_asp.cli import options, shell_completion
from prag_asp.cli.arguments import domain_and_others
from prag_asp.cli.bundles.task_format import Telling, tells
from prag_asp.cli.domain_options import Asked
from prag_asp.cli.line_output import writer
from prag_asp.cli.options import asks
from prag_asp.cli.terminal import progress, say, tell_line
from prag_asp.errors import QueryError
from prag_asp.output import file_in, make_folder

if TYPE_CHECKING:
    from prag_asp.space.parts.ranked_tasks import RankedTasks
    from prag_asp.space.task_space import TaskSpace
    from prag_asp.task import Task


@click.command()
@click.argument(
    "words", metavar="DOMAIN... [NAME=SHARE]...", nargs=-1, required=True, shell_complete=shell_completion.shares
)
@asks((*options.PROGRAM, options.LENGTH, *options.ANSWERED))
@click.option(
    "--skeletons",
    is_flag=True,
    help="No two parts have a skeleton in common; shares are within 2 points, or a warning says so.",
)
@click.option(
    "--hold-out", "held", metavar="WHAT", shell_complete=shell_completion.names,
    help="Entity, class, action or pair that only the test part has.",
)  # fmt: skip
@click.option("--count", "wanted", type=options.whole(0), metavar="K", help="Write K different tasks a part.")
@options.seed
@tells
@click.option(
    "-o", "--output", metavar="DIR", shell_complete=shell_completion.files,
    help="Folder for one file a part; needed with --count.",
)  # fmt: skip
def split(
    *, asked: Asked, words: tuple[str, ...], skeletons: bool, held: str | None, wanted: int | None, seed: int,
    telling: Telling, output: str | None,
) -> None:  # fmt: skip
    """Divide the tasks of length N into disjoint parts, such as train=0.8 test=0.2, and print their sizes.

    With --count, uniformly drawn tasks of each part are written to DIR/NAME.txt or .jsonl. These files are replaced
    together at the end.
    """
    from prag_asp.dataset.jsonl import Record

    telling.check()
    names, shares = domain_and_others(words)
    if (held is None) == (not shares):
        raise QueryError("give either shares, such as train=0.8 test=0.2, or --hold-out WHAT")
    if (wanted is None) != (output is None):
        raise QueryError("give --count and --output together")
    with progress() as tell:
        space = replace(asked, names=names).space(tell)
        parts = _parts(space, shares, skeletons, held, seed)
        width = max(map(len, parts))
        for name, part in parts.items():
            say(f"{name:<{width}}  {part.count()}")
        if wanted is None or output is None:
            return
        line, folder = telling.line(space.domain, seed), make_folder(output)
        with ExitStack() as files:
            for name, part in parts.items():
                file = file_in(folder, f"{name}.{'jsonl' if telling.form == 'jsonl' else 'txt'}")
                out = files.enter_context(writer(str(file)))
                for task in _drawn(part, min(wanted, part.count()), seed):
                    out.write(line(Record(task)))


def _parts(
    space: TaskSpace, shares: tuple[str, ...], skeletons: bool, held: str | None, seed: int
) -> dict[str, TaskSpace] | dict[str, RankedTasks]:
    if held is not None:
        train, test = space.hold_out(held)
        return {"train": train, "test": test}
    pairs = [share.partition("=") for share in shares]
    if not all(name.isidentifier() and equals for name, equals, _ in pairs) or len({p[0] for p in pairs}) < len(pairs):
        raise QueryError(f"{' '.join(shares)}: write different names with their shares, such as train=0.8 test=0.2")
    wanted = {name: share for name, _, share in pairs}
    if not skeletons:
        return space.split(wanted, seed=seed)
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        parts = space.split_skeletons(wanted, seed=seed)
    for each in told:
        tell_line(f"warning: {each.message}")
    return parts


def _drawn(part: TaskSpace | RankedTasks, count: int, seed: int) -> Iterator[Task]:
    from prag_asp.space.task_space import TaskSpace

    if isinstance(part, TaskSpace):
        yield from part.sample(count, seed=seed, weights={}, distinct=True)
    else:
        yield from part.sample(count, seed=seed, distinct=True)

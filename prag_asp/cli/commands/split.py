"""``prag-asp split``: disjoint sets of tasks for training and testing."""

from __future__ import annotations

import warnings
from contextlib import ExitStack
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import click

from prag_asp.cli import options, shell_completion
from prag_asp.cli.arguments import domain_and_others
from prag_asp.cli.domain_options import ENGINE, LENGTH, PROGRAM, DomainOptions, domain_options
from prag_asp.cli.line_output import writer
from prag_asp.cli.options import whole
from prag_asp.cli.task_options import LINE_FORMAT, TaskFormat, format_options
from prag_asp.cli.terminal import progress, say, tell_line
from prag_asp.errors import QueryError
from prag_asp.output import file_in, make_folder
from prag_asp.wording import plural

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from prag_asp.audit.distant_split import DistantSplit
    from prag_asp.space.parts.ranked_tasks import RankedTasks
    from prag_asp.space.task_space import TaskSpace
    from prag_asp.task import Task

    Parts = Mapping[str, TaskSpace | RankedTasks]


@click.command()
@click.argument(
    "words", metavar="DOMAIN... [NAME=SHARE]...", nargs=-1, required=True, shell_complete=shell_completion.shares
)
@domain_options(*PROGRAM, LENGTH, *ENGINE)
@click.option(
    "--skeletons",
    is_flag=True,
    help="Parts also share no skeleton; a share that is off by over 2 percentage points causes a warning.",
)
@click.option(
    "--hold-out", "held", metavar="WHAT", shell_complete=shell_completion.names,
    help="Entity, class, action or pair that occurs only in the part test.",
)  # fmt: skip
@click.option(
    "--distance", type=whole(1, 100), metavar="D",
    help="Later parts keep only tasks at least D edits from all tasks of the first part.",
)  # fmt: skip
@click.option(
    "--cover", type=whole(1, 7), metavar="T",
    help="Training covers all combinations of T factors of an action; each test task has a new combination of T+1.",
)  # fmt: skip
@click.option(
    "--combinations", type=whole(1), metavar="K",
    help="With --cover: number of combinations that are held out.  [default: a fifth]",
)  # fmt: skip
@click.option("--count", "requested_count", type=whole(0), metavar="K", help="Write K distinct tasks per part.")
@options.seed
@format_options(LINE_FORMAT)
@click.option(
    "-o", "--output", metavar="DIR", shell_complete=shell_completion.files,
    help="With --count: folder for one file per part.",
)  # fmt: skip
def split(
    *, request: DomainOptions, words: tuple[str, ...], skeletons: bool, held: str | None, distance: int | None,
    cover: int | None, combinations: int | None, requested_count: int | None, seed: int,
    task_format: TaskFormat, output: str | None,
) -> None:  # fmt: skip
    """Split the tasks of length N into disjoint parts.

    Prints the size of each part; parts are given by shares, such as train=0.8 test=0.2. With --count, samples tasks
    from each part uniformly, and writes them to DIR/NAME.txt or .jsonl; these files are replaced together at the end.
    """
    from prag_asp.dataset.jsonl import Record

    task_format.check()
    names, shares = domain_and_others(words)
    if [held is not None, bool(shares), cover is not None].count(True) != 1:
        raise QueryError("give shares, such as train=0.8 test=0.2, or --hold-out WHAT, or --cover T; one of them")
    if combinations is not None and cover is None:
        raise QueryError("--combinations are held out with --cover; give both")
    if (requested_count is None) != (output is None):
        raise QueryError("give --count and --output together")
    if cover is not None and skeletons:
        raise QueryError("--cover holds out combinations; leave --skeletons out")
    proved = distance is not None or cover is not None
    if proved and output is not None and task_format.form not in ("text", "jsonl"):
        raise QueryError(f"the parts are verified from plans; give --format text or jsonl, not {task_format.form}")
    with progress() as tell:
        space = replace(request, names=names).space(tell)
        apart = _proved(space, distance, cover, combinations, shares, skeletons, held, seed) if proved else None
        parts = _with_warnings(
            lambda: _parts(space, shares, skeletons, held, seed) if apart is None else apart.parts(space)
        )
        width = max(map(len, parts))
        for name, part in parts.items():
            say(f"{name:<{width}}  {part.count()}")
            if distance is not None and not part.count():
                tell_line(f"{name}: no task is {distance} edits or more from training; give a smaller --distance")
        if requested_count is None or output is None:
            return
        line, folder = task_format.line(space, seed), make_folder(output)
        paths = {name: folder / f"{name}.{'jsonl' if task_format.form == 'jsonl' else 'txt'}" for name in parts}
        with ExitStack() as files:
            for name, part in parts.items():
                out = files.enter_context(writer(str(file_in(folder, paths[name].name))))
                covers = cover if part is next(iter(parts.values())) else None
                for task in _written(part, requested_count, seed, covers, name):
                    out.write(line(Record(task)))
        if apart is not None:
            from prag_asp.audit.distant_split import record_split

            record_split(folder, space, apart, {name: part.count() for name, part in parts.items()}, paths)


def _parts(space: TaskSpace, shares: tuple[str, ...], skeletons: bool, held: str | None, seed: int) -> Parts:
    if held is not None:
        train, test = space.hold_out(held)
        return {"train": train, "test": test}
    requested = _requested(shares)
    return space.split_skeletons(requested, seed=seed) if skeletons else space.split(requested, seed=seed)


def _requested(shares: tuple[str, ...]) -> dict[str, str]:
    pairs = [share.partition("=") for share in shares]
    if not all(name.isidentifier() and equals for name, equals, _ in pairs) or len({p[0] for p in pairs}) < len(pairs):
        raise QueryError(f"{' '.join(shares)}: write different names with their shares, such as train=0.8 test=0.2")
    return {name: share for name, _, share in pairs}


def _proved(
    space: TaskSpace, distance: int | None, cover: int | None, combinations: int | None, shares: tuple[str, ...],
    skeletons: bool, held: str | None, seed: int,
) -> DistantSplit:  # fmt: skip
    """Return the request for parts that are far apart, or for a first part that covers combinations."""
    from prag_asp.audit.distant_split import DistantSplit

    if cover is not None:
        from prag_asp.analysis.covering.combinations import combination_text
        from prag_asp.analysis.covering.held_out import hold_out_combinations

        found = hold_out_combinations(space, cover, seed, combinations)
        tell_line(
            f"train covers all combinations of {plural(cover, 'factor')}; only test has "
            f"{', '.join(map(combination_text, found.combinations))}"
        )
        return DistantSplit(distance or 1, None, {}, seed, found.combinations)
    if held is None and not skeletons:
        raise QueryError(
            "--distance: random parts have neighbours of nearly every task; add --skeletons, or give --hold-out WHAT"
        )
    return DistantSplit(distance or 1, held, {} if held is not None else _requested(shares), seed)


def _written(part: TaskSpace | RankedTasks, count: int, seed: int, cover: int | None, name: str) -> list[Task]:
    """Return distinct tasks of a part, sampled uniformly; with `cover`, tasks that cover all combinations come first.

    Raises:
        QueryError: more tasks are needed to cover the combinations.
    """
    from prag_asp.space.task_space import TaskSpace

    weights: dict[str, Any] = {"weights": {}} if isinstance(part, TaskSpace) else {}
    count = min(count, part.count())
    sampled = part.sample(count, seed=seed, distinct=True, **weights)
    if cover is None or not isinstance(part, TaskSpace):
        return sampled
    from prag_asp.analysis.covering.covering_set import covering_set

    first = list(covering_set(part, cover).tasks)
    if len(first) > count:
        raise QueryError(f"--count {count}: the file of {name} needs {len(first)} tasks to cover all combinations")
    known = {part.index(task) for task in first}
    return [*first, *(task for task in sampled if part.index(task) not in known)][:count]


def _with_warnings(divide: Callable[[], Parts]) -> Parts:
    """Return the parts, and print warnings about them, each on one line."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        parts = divide()
    for each in caught:
        tell_line(f"warning: {each.message}")
    return parts

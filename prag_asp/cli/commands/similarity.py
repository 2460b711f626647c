"""``prag-asp similarity``: the distance between two tasks, and the distances between all pairs of tasks in a set."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict
from itertools import islice
from typing import TYPE_CHECKING, Any, cast

import click

from prag_asp.cli import shell_completion
from prag_asp.cli.arguments import parse_length
from prag_asp.cli.comparison.compared_tasks import ComparedTasks, read_all, read_pair
from prag_asp.cli.comparison.similarity_files import FILE_OPTIONS, SimilarityFiles
from prag_asp.cli.domain_options import OF_FILE, WHERE, DomainOptions, domain_options
from prag_asp.cli.line_output import require_writable
from prag_asp.cli.options import whole
from prag_asp.cli.terminal import aligned, progress, say, tell_line
from prag_asp.errors import QueryError

if TYPE_CHECKING:
    from prag_asp.similarity.background import Background, UpTo
    from prag_asp.similarity.edits import Edit
    from prag_asp.similarity.metrics import Metric
    from prag_asp.similarity.task_comparison import TaskComparison

SHOWN = 5
"""The number of near-duplicates that the summary lists."""


@click.command()
@click.argument("words", metavar="A B | DATASET | TASKS.jsonl", nargs=-1, required=True)
@domain_options(
    *OF_FILE,
    click.option("-n", "--length", type=parse_length, metavar="N", default="0", help="Number of actions, for ranks."),
    WHERE,
)
@click.option(
    "--metric", default="combined", show_default=True, metavar="METRIC", shell_complete=shell_completion.metrics,
    help="Metric: combined, levenshtein, levenshtein-classes, levenshtein-effects, hamming, hamming-classes, "
    "hamming-effects, goal, states, links, damerau, jaro, jaro-winkler, subsequence or substring.",
)  # fmt: skip
@click.option(
    "--costs", metavar="FILE", shell_complete=shell_completion.files,
    help="Use an edit distance with the costs in a TOML file instead of a metric.",
)  # fmt: skip
@click.option(
    "--up-to", type=click.Choice(["domain", "names", "classes"]), default="domain", show_default=True,
    help="Interchangeable entities: those of the domain; none; or all of a class. The last two need no domain.",
)  # fmt: skip
@click.option(
    "--at-most",
    type=float,
    default=0.0,
    show_default=True,
    metavar="D",
    help="Largest distance between near-duplicates.",
)
@click.option(
    "-k", "--neighbours", type=whole(1), default="5", show_default=True, metavar="K",
    help="With --nearest: number of nearest tasks for each task.",
)  # fmt: skip
@click.option(
    "--against", metavar="FILE|DATASET", shell_complete=shell_completion.files,
    help="Print how novel the tasks are: their distances from the nearest of these tasks.",
)  # fmt: skip
@click.option("--diverse", type=whole(1), metavar="K", help="Choose K tasks that are far apart.")
@FILE_OPTIONS
@click.option("--format", "form", type=click.Choice(["text", "json"]), default="text", show_default=True,
              help="Text, or JSON with exact fractions.")  # fmt: skip
def similarity(
    *, request: DomainOptions, words: tuple[str, ...], metric: str, costs: str | None, up_to: str, at_most: float,
    neighbours: int, against: str | None, diverse: int | None, files: SimilarityFiles, form: str,
) -> None:  # fmt: skip
    """Compare two tasks, or all tasks of a set, up to renaming of interchangeable entities.

    A and B are ranks (with --domain and --length), scenario ids, lines of JSON or files with one task each; the edits
    from A to B are printed. For a dataset or a file of JSON lines, all pairs are compared, and matrices, neighbours,
    near-duplicates, dendrograms and maps are written.
    """
    from prag_asp.similarity.metrics import metric_of

    metric_of(metric)
    if costs is not None and metric != "combined":
        raise QueryError(f"--costs {costs} defines a metric of its own; leave --metric {metric} out")
    if len(words) > 2:
        raise QueryError(f"{' '.join(words)}: give two tasks, or one dataset or file")
    if diverse is not None and len(words) == 2:
        raise QueryError("--diverse chooses from a dataset or a file of tasks, not from two tasks")
    if against is not None and (len(words) == 2 or diverse is not None or files.names):
        raise QueryError(f"--against {against} is for one dataset or file, without other files to write and --diverse")
    if (files.chosen is not None) > (diverse is not None):
        raise QueryError(f"--chosen {files.chosen}: say how many tasks to choose with --diverse K")
    files.check(one_set=len(words) == 1)
    for file in files.names:
        require_writable(file)
    with progress():
        if len(words) == 2:
            found = _compared(words, request, metric, costs, up_to)
            lines = _json(found) if form == "json" else _text(found)
        elif against is not None:
            given, known = read_all(words[0], request, up_to), read_all(against, request, up_to)
            lines = _novel(given, known, metric, costs, up_to, form)
        else:
            given = read_all(words[0], request, up_to)
            lines = _summary(
                given, _metric(metric, costs, given, up_to), up_to, at_most, neighbours, diverse, files, form
            )
        for line in lines:
            say(line)


def _compared(
    words: tuple[str, ...], request: DomainOptions, metric: str, costs: str | None, up_to: str
) -> TaskComparison:
    """Return the comparison of two tasks."""
    from prag_asp.similarity.task_comparison import compare

    found = read_pair(words, request, up_to)
    one, other = found.tasks
    return compare(one, other, _metric(metric, costs, found, up_to), _background(found, up_to))


def _background(given: ComparedTasks, up_to: str) -> Background:
    from prag_asp.similarity.background import Background

    return Background.of_tasks(given.tasks, _names(up_to)) if given.space is None else given.space.background


def _metric(metric: str, costs: str | None, given: ComparedTasks, up_to: str) -> Metric:
    """Return the metric with a given name or with the costs in a file; if it is not a metric, print the reason."""
    from prag_asp.similarity.metrics import metric_of

    if costs is None:
        return metric_of(metric)
    from prag_asp.similarity.cost_file import read_costs

    found = read_costs(costs, given.tasks, _background(given, up_to))
    if not found.axioms:
        tell_line(f"note: {costs}: {found.summary}")
    return found


def _names(up_to: str) -> UpTo:
    return cast("UpTo", "names" if up_to == "domain" else up_to)


def _text(found: TaskComparison) -> Iterator[str]:
    """Yield the distance, the renaming, the parts of a mixture, and the edits."""
    yield f"{found.metric.name}: distance {_number(found.distance)}, similarity {found.similarity:.3f}"
    if found.renaming:
        yield f"renamed in B: {', '.join(f'{old} to {new}' for old, new in sorted(found.renaming.items()))}"
    if found.parts:
        from prag_asp.similarity.metrics import COMBINED

        heads = [("part", "weight", "distance", "from 0 to 1")]
        rows = [
            (name, f"{float(COMBINED[name]):g}", _number(part.distance), f"{float(part.normalised):.3f}")
            for name, part in found.parts.items()
        ]
        yield from ("", *aligned([*heads, *rows]), "")
    for edit in found.edits:
        yield f"{_edit_text(edit, found)}: {_number(edit.cost)}{_reason(edit, found)}"


def _edit_text(edit: Edit, found: TaskComparison) -> str:
    from prag_asp.similarity.measures import SetMeasure
    from prag_asp.similarity.symbols import symbol_text

    if isinstance(found.measure, SetMeasure):
        return f"only A: {symbol_text(edit.old)}" if edit.new is None else f"only B: {symbol_text(edit.new)}"
    place = edit.place + 1
    if edit.old is None:
        return f"{place}  insert {symbol_text(edit.new)}"
    if edit.new is None:
        return f"{place}  delete {symbol_text(edit.old)}"
    return f"{place}  replace {symbol_text(edit.old)} by {symbol_text(edit.new)}"


def _reason(edit: Edit, found: TaskComparison) -> str:
    """Return the lowest common classes of the objects in a replacement, if its cost depends on classes."""
    from prag_asp.atom import Atom

    old, new = edit.old, edit.new
    by_classes = next(iter(found.parts), found.metric.name).endswith("-classes")
    if not by_classes or not isinstance(old, Atom) or not isinstance(new, Atom) or old.name != new.name:
        return ""
    tree = found.background.tree
    pairs = [pair for pair in zip(old.arguments, new.arguments, strict=False) if pair[0] != pair[1]]
    classes = [tree.common_class(*pair) or "no common class" for pair in pairs if {*pair} <= {*tree.classes}]
    return f" ({', '.join(classes)})" if classes else ""


def _number(value: Any) -> str:
    """Return a number with at most four decimal places."""
    return f"{float(value):.4f}".rstrip("0").rstrip(".")


def _json(found: TaskComparison) -> Iterator[str]:
    import json

    from prag_asp.similarity.symbols import symbol_text

    values = {
        "metric": found.metric.name,
        "distance": str(found.distance),
        "normalised": str(found.normalised),
        "similarity": found.similarity,
        "renaming": dict(found.renaming),
        "parts": {
            name: {"distance": str(part.distance), "normalised": str(part.normalised)}
            for name, part in found.parts.items()
        },
        "edits": [
            {
                "place": edit.place,
                "old": None if edit.old is None else symbol_text(edit.old),
                "new": None if edit.new is None else symbol_text(edit.new),
                "cost": str(edit.cost),
            }
            for edit in found.edits
        ],
    }
    yield json.dumps(values, indent=2)


def _novel(
    given: ComparedTasks, known: ComparedTasks, metric: str, costs: str | None, up_to: str, form: str
) -> Iterator[str]:
    """Yield lines with the distances of the given tasks from the nearest known ones, smallest first."""
    import json

    from prag_asp.analysis.farthest_first import novelty

    together = ComparedTasks([*known.tasks, *given.tasks], [*known.groups, *given.groups], known.space)
    if {task.domain for task in known.tasks} != {task.domain for task in given.tasks} and known.space is not None:
        raise QueryError("the tasks belong to different domains; compare them with --up-to names")
    found = novelty(given.tasks, known.tasks, _metric(metric, costs, together, up_to), known.space, _names(up_to))
    if form == "json":
        rows = zip(found.distances.tolist(), found.nearest.tolist(), strict=True)
        yield json.dumps([{"distance": distance, "nearest": nearest} for distance, nearest in rows], indent=2)
        return
    yield from aligned(
        [
            ("tasks", f"{len(given.tasks)}"),
            ("given tasks", f"{len(known.tasks)}"),
            ("mean novelty", f"{found.distances.mean():.4f}"),
            ("smallest novelty", f"{found.distances.min():.4f}"),
            ("tasks with novelty 0", f"{int((found.distances == 0).sum())}"),
        ]
    )
    for place in found.distances.argsort(kind="stable")[:SHOWN].tolist():
        yield f"  {place} is {_number(found.distances[place])} from given task {found.nearest[place]}"


def _summary(
    given: ComparedTasks,
    metric: Metric,
    up_to: str,
    at_most: float,
    neighbours: int,
    diverse: int | None,
    files: SimilarityFiles,
    form: str,
) -> Iterator[str]:
    """Write the requested files, and yield a summary."""
    import json

    from prag_asp.analysis.all_pairs import pair_distances
    from prag_asp.analysis.distance_matrix import fits, matrix_of, near_duplicates, stripes_of, without_duplicates
    from prag_asp.analysis.farthest_first import diverse_choice

    pairs = pair_distances(given.tasks, metric, given.space, _names(up_to))
    compared = matrix_of(pairs) if files.needs_matrix or fits(pairs) else pairs
    count, denominator = pairs.count, float(pairs.table.denominator or 1)
    total = sum(float(values.sum(dtype="float64")) for _, values in stripes_of(compared))
    mean = total / denominator / max(count * (count - 1), 1)
    duplicates = near_duplicates(compared, at_most)
    distinct = len(without_duplicates(compared))
    choice = None if diverse is None else diverse_choice(compared, diverse)
    files.write(compared, given, duplicates, neighbours, choice, f"{metric.name} of {count:,} tasks")
    if form == "json":
        values: dict[str, Any] = {"tasks": count, "distinct": distinct, "metric": metric.name, "mean": mean,
                                  "at_most": at_most, "near_duplicates": list(duplicates)}  # fmt: skip
        if choice is not None:
            values["diverse"] = asdict(choice)
        yield json.dumps(values, indent=2)
        return
    yield from aligned(
        [
            ("tasks", f"{count}"),
            ("distinct", f"{distinct}"),
            (f"mean distance, {metric.name}", f"{mean:.4f}"),
            (f"pairs at distance at most {at_most:g}", f"{len(duplicates)}"),
        ]
    )
    for first, second, distance in islice(duplicates, SHOWN):
        yield f"  {first} and {second}: {_number(distance)}"
    if len(duplicates) > SHOWN:
        yield f"  and {len(duplicates) - SHOWN} more; --duplicates FILE writes all"
    if choice is not None:
        yield f"chosen tasks  {' '.join(map(str, choice.tasks))}"
        yield f"they are at least {_number(choice.separation)} apart; all others are within {_number(choice.radius)}"

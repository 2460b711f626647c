"""``prag-asp diversity``: distances, neighbours, diversity and frequencies of a whole task space, exactly."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from math import isfinite
from typing import TYPE_CHECKING, Any

import click

from prag_asp.atom import split_actions
from prag_asp.cli import options, shell_completion
from prag_asp.cli.comparison.compared_tasks import GivenTask, records_in
from prag_asp.cli.comparison.complexity_table import complexities, complexity_text
from prag_asp.cli.domain_options import SPACE, DomainOptions, domain_options
from prag_asp.cli.line_output import require_writable, writer
from prag_asp.cli.options import whole
from prag_asp.cli.terminal import aligned, progress, tell_line
from prag_asp.errors import QueryError
from prag_asp.wording import plural

if TYPE_CHECKING:
    from prag_asp.analysis.frequencies import FrequencyTest
    from prag_asp.dataset.store.dataset import Dataset
    from prag_asp.space.task_space import TaskSpace
    from prag_asp.task import Task

SHOWN = 20
"""The maximum number of missing combinations that the text lists."""

FEATURES = ("actions", "classes", "names", "pairs")


@click.command()
@domain_options(*SPACE)
@click.option(
    "--tasks", "file", metavar="FILE|DATASET", shell_complete=shell_completion.files,
    help="Compare these tasks (JSON lines or a dataset) with the space.",
)  # fmt: skip
@click.option(
    "--feature", "features", multiple=True, type=click.Choice(FEATURES), default=FEATURES,
    help="What to compare at each position of a plan; may be repeated.  [default: all]",
)  # fmt: skip
@click.option(
    "--distances/--no-distances", "distances", default=True,
    help="Print the Hamming distances between all pairs of tasks.  [default: distances]",
)  # fmt: skip
@click.option(
    "--coverage", "strength", type=whole(1, 8), metavar="T",
    help="With --tasks: only print which reachable combinations of T factors of an action the tasks cover.",
)  # fmt: skip
@click.option(
    "--complexity", "with_complexity", is_flag=True,
    help="With --tasks: only print how complex the tasks are, and how hard they were for physics.",
)  # fmt: skip
@click.option(
    "--near", "plan", metavar="'A B ...'", shell_complete=shell_completion.plan,
    help="Only count the tasks near the task with these actions.",
)  # fmt: skip
@click.option("--radius", type=whole(0, 100), metavar="R", help="With --near: number of edits.  [default: 3]")
@click.option(
    "--format", "form", type=click.Choice(["text", "json"]), default="text", show_default=True,
    help="Tables with decimals, or JSON with exact numbers.",
)  # fmt: skip
@options.output
def diversity(
    *, request: DomainOptions, file: str | None, features: tuple[str, ...], distances: bool,
    strength: int | None, with_complexity: bool, plan: str | None, radius: int | None, form: str, output: str | None,
) -> None:  # fmt: skip
    """Measure how much the tasks of length N differ.

    Prints the exact distribution of the Hamming distance between two random tasks, and Vendi scores (effective numbers
    of different tasks). With --tasks, also prints the scores of the given tasks, and a chi-square test of their
    frequencies against the exact expected frequencies; with --coverage, prints the combinations that they lack. With
    --near, prints how many tasks are 0, 1, ... edits away from a given task, which need not be in the space, and one of
    the nearest tasks. Nothing is sampled or listed.
    """
    require_writable(output)
    with progress() as tell:
        space = request.space(tell)
        if plan is not None:
            if file is not None or strength is not None or with_complexity:
                raise QueryError("give --near or --tasks, with or without --coverage or --complexity")
            found = _near(space, split_actions(plan), 3 if radius is None else radius)
        elif radius is not None:
            raise QueryError("--radius is for --near; give --near 'A B ...'")
        elif (strength is not None or with_complexity) and file is None:
            raise QueryError(f"--{'coverage' if strength else 'complexity'} is for given tasks; give --tasks FILE")
        elif file is not None and with_complexity:
            found = complexities(*_given(file, space), space)
        else:
            tasks = None if file is None else [each.record.task for each in _given(file, space)[0]]
            found = (
                _covered(tasks, space, strength)
                if tasks is not None and strength is not None
                else _measured(space, tasks, features, distances)
            )
    text = complexity_text if with_complexity else _covered_text if strength else _text
    if plan is not None:
        text = _near_text
    with writer(output) as out:
        if form == "json":
            import json

            out.write(json.dumps(found, indent=2, default=_exact))
        else:
            for line in text(found):
                out.write(line)


def _exact(value: Any) -> Any:
    """Return a fraction as a string, and a frequency test as a JSON object."""
    if isinstance(value, Fraction):
        return str(value)
    rows = {each.value: {"observed": each.observed, "expected": str(each.expected)} for each in value.frequencies}
    statistic = value.statistic if isfinite(value.statistic) else None  # JSON has no infinity
    return {"statistic": statistic, "degrees": value.degrees, "p_value": value.p_value, "frequencies": rows}


def _near(space: TaskSpace, plan: list[str], radius: int) -> dict[str, Any]:
    from prag_asp.analysis.neighbours import count_neighbours, nearest_task

    near = nearest_task(space, plan)
    numbers = count_neighbours(space, plan, radius)
    return {"neighbours": numbers, "nearest": {"distance": near.distance, "plan": near.plan}}


def _covered(tasks: list[Task], space: TaskSpace, strength: int) -> dict[str, Any]:
    from prag_asp.analysis.covering.combinations import combination_text, coverage

    found = coverage(tasks, space, strength)
    missing = [combination_text(each) for each in sorted(found.missing)]
    return {"factors": strength, "given": len(tasks), "reachable": len(found.reachable), "missing": missing}


def _covered_text(found: dict[str, Any]) -> Iterator[str]:
    reachable, missing = found["reachable"], found["missing"]
    share = f" ({100 * (reachable - len(missing)) / reachable:.1f} %)" if reachable else ""
    yield (
        f"{plural(found['given'], 'task')} cover {reachable - len(missing)} of {reachable} reachable combinations of "
        f"{plural(found['factors'], 'factor')}{share}"
    )
    yield from (f"  missing  {each}" for each in missing[:SHOWN])
    if len(missing) > SHOWN:
        yield f"  and {len(missing) - SHOWN} more; --format json lists all"


def _given(file: str, space: TaskSpace) -> tuple[list[GivenTask], Dataset | None]:
    """Return the tasks in a file or dataset that have the length of a space, and the dataset.

    Raises:
        QueryError: a task belongs to another domain, or no task has this length.
    """
    from prag_asp.dataset.task_origin import foreign

    given, dataset = records_in(file)
    for each in given:
        if problem := foreign(each.record, space.domain):
            raise QueryError(f"{each.record.place}: {problem}")
    fitting = [each for each in given if len(each.record.task) == space.length]
    if not fitting:
        raise QueryError(f"{file}: no task of length {space.length}; choose a length that it has")
    if len(fitting) < len(given):
        tell_line(f"note: {file}: {plural(len(given) - len(fitting), 'task')} of other lengths left out")
    return fitting, dataset


def _measured(
    space: TaskSpace, tasks: list[Task] | None, features: tuple[str, ...], distances: bool
) -> dict[str, Any]:  # fmt: skip
    from prag_asp.analysis.frequencies import frequency_test
    from prag_asp.analysis.hamming import hamming_distribution
    from prag_asp.analysis.moments import space_moments, task_moments
    from prag_asp.analysis.vendi import score_of

    found: dict[str, Any] = {"length": space.length, "tasks": space.count()}
    if distances:
        pairs = hamming_distribution(space)
        found["distance"] = {"mean": pairs.mean, "mean_of_different": pairs.mean_of_different, "pairs": pairs.pairs}
    usable: list[Any] = [each for each in dict.fromkeys(features) if space.length > (each == "pairs")]
    moments = {feature: {"space": space_moments(space, feature)} for feature in usable}
    if tasks is not None:
        for feature, own in moments.items():
            own["given"] = task_moments(space, tasks, feature)
    found["vendi"] = {
        feature: {name: score_of(each).score for name, each in own.items()} for feature, own in moments.items()
    }
    if tasks is not None:
        found["given"] = len(tasks)
        found["frequencies"] = {feature: frequency_test(own["given"], own["space"]) for feature, own in moments.items()}
    return found


def _near_text(found: dict[str, Any]) -> Iterator[str]:
    yield from aligned([("edits", "tasks"), *((str(k), f"{number}") for k, number in enumerate(found["neighbours"]))])
    yield ""
    yield f"nearest, {plural(found['nearest']['distance'], 'edit')}: {' '.join(found['nearest']['plan'])}"


def _text(found: dict[str, Any]) -> Iterator[str]:
    given = found.get("given")
    yield from aligned(
        [
            (f"tasks of length {found['length']}", f"{found['tasks']}"),
            *([("given tasks", f"{given}")] if given is not None else []),
        ]
    )
    if "distance" in found:
        pairs = found["distance"]["pairs"]
        total = sum(pairs)
        yield ""
        yield f"mean Hamming distance between two tasks: {float(found['distance']['mean']):.6f}"
        yield ""
        rows = [(f"{k}", f"{number}", f"{float(Fraction(number, total)):.3e}") for k, number in enumerate(pairs)]
        yield from aligned([("distance", "ordered pairs of tasks", "share"), *rows])
    if found["vendi"]:
        yield ""
        heads = ("Vendi score", "space", *(["given tasks"] if given is not None else []))
        rows_of = ((name, *(f"{each:.2f}" for each in own.values())) for name, own in found["vendi"].items())
        yield from aligned([heads, *rows_of])
    for test in found.get("frequencies", {}).values():
        yield ""
        yield from _frequency_text(test)


def _frequency_text(test: FrequencyTest) -> Iterator[str]:
    rows = [(each.value, f"{each.observed}", f"{float(each.expected):.2f}") for each in test.frequencies]
    yield from aligned([(test.feature, "given", "expected"), *rows])
    few = f"; {plural(test.few, 'value')} expected fewer than 5 times, so p is rough" if test.few else ""
    yield f"chi-square {test.statistic:.2f} with {test.degrees} degrees of freedom, p = {test.p_value:.3g}{few}"

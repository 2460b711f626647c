"""``prag-asp sample``: tasks sampled with exact probabilities or, with physics, only the feasible ones."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import closing
from functools import partial
from itertools import islice
from typing import TYPE_CHECKING, Any

import click

from prag_asp.cli import options, shell_completion
from prag_asp.cli.comparison.chosen_tasks import CoveringTasks, covering_tasks, far_apart
from prag_asp.cli.domain_options import SPACES, DomainOptions, domain_options
from prag_asp.cli.line_output import recordings_folder, require_writable, writer
from prag_asp.cli.options import StrataOptions, WeightOptions, whole
from prag_asp.cli.physics_options import CameraOptions, PhysicsOptions, camera_options, physics_options
from prag_asp.cli.task_options import LINE_FORMAT, TaskFormat, format_options
from prag_asp.cli.terminal import Tell, progress, tell_line
from prag_asp.errors import NotFound, QueryError
from prag_asp.wording import plural

if TYPE_CHECKING:
    from prag_asp.dataset.jsonl import Record
    from prag_asp.dataset.pass_rates import Tally
    from prag_asp.domain.load import Domain
    from prag_asp.space.strata.allocation import Stratification
    from prag_asp.space.task_space import TaskSpace

DRAWS_PER_TASK = 1000
"""The number of sampled tasks, per requested feasible task, after which `sample` gives up."""


@click.command()
@domain_options(*SPACES, options.trust)
@click.option("--count", "requested_count", type=whole(0), default=10, show_default=True, help="Number of tasks.")
@options.seed
@options.weight_options
@options.over
@click.option(
    "--by", type=click.Choice(["plan", "task"]), default="task", show_default=True, help="Sample plans, or tasks."
)
@options.strata_options
@click.option("--distinct", is_flag=True, help="Sample without replacement: no task occurs twice.")
@click.option(
    "--except", "excluded", metavar="FILE|DIR", shell_complete=shell_completion.files,
    help="With --distinct: leave out the tasks in a file of scenario ids (--format scenario) or in a dataset.",
)  # fmt: skip
@click.option(
    "--cover", type=whole(1, 8), metavar="T",
    help="Instead, choose a small set of tasks that covers every reachable combination of T factors of an action.",
)  # fmt: skip
@click.option("--diverse", type=whole(1), metavar="K", help="Keep only K of the sampled tasks, which are far apart.")
@click.option(
    "--physics/--no-physics", default=None, help="Keep only feasible tasks.  [default: if the domain has a scene]"
)
@physics_options
@camera_options
@click.option(
    "--max-draws", type=whole(1), metavar="K", help="Stop after K samples, feasible or not.  [default: 1000 per task]"
)
@format_options(LINE_FORMAT)
@options.output
def sample(
    *,
    request: DomainOptions,
    requested_count: int,
    seed: int,
    weighting: WeightOptions,
    over: Any,
    by: Any,
    stratifying: StrataOptions,
    distinct: bool,
    excluded: str | None,
    cover: int | None,
    diverse: int | None,
    physics: bool | None,
    validation: PhysicsOptions,
    filming: CameraOptions,
    max_draws: int | None,
    task_format: TaskFormat,
    output: str | None,
) -> None:
    """Sample tasks of length N, with exact probabilities.

    The probability of a task is proportional to its weight; by default, all tasks have the same weight. For several
    lengths, the tasks of all lengths are sampled together.
    """
    from prag_asp.dataset.jsonl import Record
    from prag_asp.dataset.scenarios import exclude
    from prag_asp.dataset.scenes import scene_of
    from prag_asp.dataset.stored_scenarios import read_earlier

    task_format.check(by)
    _check_choice(cover, diverse, requested_count, by, over, distinct, excluded)
    require_writable(output)
    validation.parse_budget()
    filming.check(validation.demonstrate)
    with progress() as tell:
        space = request.spaces(tell)
        physics = _with_physics(space.domain, physics)
        staging = filming.staging(scene_of(space.domain)) if filming.any else None
        line = task_format.line(space, seed, staging)
        stratification = stratifying.stratification(
            {
                "--over": over is not None, "--by": by != "task", "--except": excluded is not None,
                "--cover": cover is not None, "--diverse": diverse is not None,
                "--max-draws": max_draws is not None, "--demonstrate": validation.demonstrate is not None,
                "--weight": bool(weighting.weight), "--temperature": weighting.temperature != "1",
            }
        )  # fmt: skip
        if stratification is not None:
            _write_strata(space, requested_count, stratification, seed, physics, validation, output, line, tell)
            return
        keep = None if excluded is None else exclude(space, read_earlier(excluded))
        drawing: dict[str, Any] = {"distinct": distinct, "by": by, "over": over}
        drawing.update(weighting.arguments(space.domain))
        source: TaskSpace | CoveringTasks = space
        choose: Callable[[Iterator[Record]], Iterator[Record]] = iter
        if cover is not None:
            source = covering = covering_tasks(space, cover)
            requested_count, choose = len(covering.found.tasks), covering.report
        elif diverse is not None:
            choose = partial(far_apart, count=diverse, space=space)
        if physics:
            drawing |= {"seed": seed, "staging": staging, "keep": keep}
            drawing["draws"] = max_draws or DRAWS_PER_TASK * requested_count
            _write_feasible(source, drawing, requested_count, validation, output, line, choose, tell)
        else:
            validation.refuse_without_physics({"--max-draws": max_draws is not None})
            drawn = source.stream(seed=seed, **drawing) if requested_count else iter(())
            records = map(Record, islice(drawn if keep is None else filter(keep, drawn), requested_count))
            found, at_least = _write_all(choose(records), output, line), diverse or requested_count
            if found < at_least:
                others = "others of positive weight" if keep is None and space.count() > found else "others"
                raise NotFound(f"only {found} of {plural(at_least, 'task')}: there are no {others}")
        if not distinct and cover is None:
            _tell_repetition(space, by, requested_count)


def _with_physics(domain: Domain, physics: bool | None) -> bool:
    """Return whether physics checks the tasks; by default, it does if the domain has a scene.

    Raises:
        PhysicsMissingError: physics is required, and is not installed.
    """
    scene = bool(domain.settings.scene)
    with_physics = scene if physics is None else physics
    if with_physics and scene:
        from prag_asp.physics import require_physics

        require_physics(f"the scene of {domain.name} needs physics (--no-physics samples without it)")
    return with_physics


def _tell_repetition(space: TaskSpace, by: Any, requested_count: int) -> None:
    """Print on stderr that the space has fewer tasks than were sampled with replacement."""
    number = space.count(by) if requested_count else 0
    if number < requested_count:
        tell_line(f"the space has only {plural(number, by)}, so some are repeated; --distinct samples each once")


def _write_all(records: Iterator[Record], output: str | None, line: Callable[[Record], str]) -> int:
    """Write records, and return their number."""
    found = 0
    with writer(output) as out:
        for record in records:
            out.write(line(record))
            found += 1
    return found


def _check_choice(
    cover: int | None, diverse: int | None, count: int, by: str, over: Any, distinct: bool, excluded: str | None
) -> None:
    """Check that the options for choosing tasks are consistent.

    Raises:
        QueryError: two options exclude each other.
    """
    given = {"--diverse": diverse is not None, "--by plan": by != "task", "--over": over is not None,
             "--except": excluded is not None}  # fmt: skip
    for option in (option for option, is_given in given.items() if is_given and cover is not None):
        raise QueryError(f"--cover chooses from all tasks of the space; leave {option} out")
    if diverse is not None and diverse > count:
        raise QueryError(f"--diverse {diverse}: chooses from {plural(count, 'sampled task')}; raise --count")
    if distinct and by != "task":
        raise QueryError(f"--distinct samples tasks without replacement; leave --by {by} out")
    if excluded is not None and not distinct:
        raise QueryError(f"--except {excluded} leaves tasks out of a sample without replacement; add --distinct")


def _write_feasible(
    space: TaskSpace | CoveringTasks, drawing: Mapping[str, Any], requested_count: int, validation: PhysicsOptions,
    output: str | None, line: Callable[[Record], str], choose: Callable[[Iterator[Record]], Iterator[Record]],
    tell: Tell,
) -> None:  # fmt: skip
    """Write the feasible tasks among the sampled ones; `drawing` holds arguments of `feasible`.

    Raises:
        NotFound: physics finds fewer feasible tasks than were requested.
    """
    from prag_asp.cli.summary import tallied, tally_line
    from prag_asp.dataset.pass_rates import Tally
    from prag_asp.dataset.physics_filter import feasible

    tally = Tally()

    def summary() -> str:
        return tally_line(tally, ("sampled", "sampled"), f"budget {validation.parse_budget()}")

    with tallied(tally, summary), recordings_folder(validation.demonstrate) as folder, writer(output) as out:
        arguments = {**validation.arguments(), "demonstrate": folder}
        records = feasible(
            space, tally=tally, **arguments, **drawing,
            progress=lambda: tell(summary(), tally.passed, requested_count),
        )  # fmt: skip
        with closing(records):
            for record in choose(islice(records, requested_count)):
                out.write(line(record), flush=True)
    if tally.passed < requested_count:
        found = f"only {tally.passed} of {plural(requested_count, 'task')} found in {plural(tally.seen, 'draw')}"
        raise NotFound(found + (f"; {_remedy(tally)}" if tally.seen == drawing["draws"] else ""))


def _write_strata(
    space: TaskSpace, requested_count: int, stratification: Stratification, seed: int, physics: bool,
    validation: PhysicsOptions, output: str | None, line: Callable[[Record], str], tell: Tell,
) -> None:  # fmt: skip
    """Write a stratified sample, and print the figures of its strata on stderr.

    Raises:
        QueryError: there is no such allocation.
        NotFound: physics finds fewer feasible tasks than were requested.
    """
    from prag_asp.cli.summary import strata_lines, tallied, tally_line
    from prag_asp.dataset.pass_rates import Tally
    from prag_asp.dataset.strata.stratified_sampling import stratified_sample

    tally = Tally()

    def summary() -> str:
        return tally_line(tally, ("sampled", "sampled"), f"budget {validation.parse_budget()}")

    if not physics:
        validation.refuse_without_physics({})
    arguments: dict[str, Any] = {"workers": validation.workers, "budget": validation.parse_budget()} if physics else {}
    with tallied(tally, summary):
        found = stratified_sample(
            space, requested_count, stratification, seed=seed, physics=physics, tally=tally,
            progress=lambda: tell(summary(), tally.passed, requested_count), **arguments,
        )  # fmt: skip
    with writer(output) as out:
        for record in found.records:
            out.write(line(record))
    for each in strata_lines(found.strata):
        tell_line(each)


def _remedy(tally: Tally) -> str:
    """Return the remedy if too few of the sampled tasks are feasible.

    More draws help if some tasks are feasible, and a larger budget may help if no feasible task was found; if tasks are
    proved infeasible, rules that exclude them help.
    """
    if tally.passed and 2 * tally.proved <= tally.seen:
        return "raise --max-draws"
    if tally.passed or 2 * tally.proved > tally.seen > tally.proved:
        return f"{tally.proved} of them proved infeasible; see prag-asp learn, which excludes such tasks"
    if tally.proved == tally.seen:
        (_, reason), _ = tally.reasons.most_common(1)[0]
        every = "it is" if tally.seen == 1 else "all are"
        return f"{every} proved infeasible, because {reason}; change the domain or its scene, or see prag-asp learn"
    from prag_asp.physics.search.attempt import NO_GRASP

    if set(tally.causes) == {NO_GRASP}:
        return (
            f"nearest to working: {tally.nearest}; see prag-asp check, which counts the grasps of each body from a file"
        )
    return f"nearest to working: {tally.nearest}; raise --budget or --max-draws"

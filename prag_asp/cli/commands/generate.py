"""``prag-asp generate``: a dataset of feasible tasks, as a folder of Parquet tables."""

from __future__ import annotations

import warnings
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from prag_asp.cli import options, shell_completion
from prag_asp.cli.domain_options import SPACES, DomainOptions, domain_options
from prag_asp.cli.options import StrataOptions, WeightOptions, whole
from prag_asp.cli.physics_options import (
    CameraOptions,
    PhysicsOptions,
    camera_options,
    max_draws,
    physics_options_without_folder,
    ray,
)
from prag_asp.cli.terminal import progress, say, tell_line
from prag_asp.errors import NotFound, QueryError
from prag_asp.wording import plural

if TYPE_CHECKING:
    from prag_asp.dataset.store.dataset import Dataset
    from prag_asp.dataset.store.manifest import Manifest

SHOWN = 5
"""The maximum number of missing combinations in a line."""


@click.command()
@domain_options(*SPACES, options.trust)
@click.option(
    "--tasks", type=whole(1), metavar="K",
    help="Number of tasks; with physics, of feasible tasks. A larger number extends an existing dataset.",
)  # fmt: skip
@click.option(
    "--cover", type=whole(1, 8), metavar="T",
    help="Begin with tasks that cover every reachable combination of T factors of an action; --tasks can be left out.",
)  # fmt: skip
@click.option(
    "--diverse", type=whole(1), metavar="K",
    help="Instead of --tasks: choose K of the sampled tasks that are far apart.",
)  # fmt: skip
@click.option(
    "--candidates", type=whole(1), metavar="N",
    help="With --diverse: number of sampled tasks to choose from.  [default: 20 times K]",
)  # fmt: skip
@options.seed
@options.weight_options
@options.over
@click.option(
    "--evenly", is_flag=True, help="Sample all lengths equally often, not in proportion to their numbers of tasks."
)
@click.option(
    "--trivial/--no-trivial", default=False, show_default=True,
    help="Keep tasks whose final state is the initial state.",
)  # fmt: skip
@click.option(
    "--split", metavar="NAME=SHARE,...",
    help="Disjoint parts, such as train=0.8,test=0.2.  [default: one part, train]",
)  # fmt: skip
@click.option(
    "--except", "excluded", metavar="FILE|DIR", multiple=True, shell_complete=shell_completion.files,
    help="Leave out the tasks in a file of scenario ids or in another dataset; may be repeated.",
)  # fmt: skip
@options.strata_options
@click.option("--skeletons", is_flag=True, help="With --split: parts also share no skeleton.")
@click.option(
    "--hold-out", "held", metavar="WHAT", shell_complete=shell_completion.names,
    help="Entity, class, action or pair that occurs only in the part test, which gets a fifth of the tasks, or its "
    "share in --split.",
)  # fmt: skip
@click.option(
    "--starts", type=whole(1), default=1, show_default=True, metavar="K",
    help="Initial states to find for each task, each with a witness.",
)  # fmt: skip
@click.option(
    "--physics/--no-physics", default=None, help="Keep only feasible tasks.  [default: if the domain has a scene]"
)
@physics_options_without_folder
@click.option(
    "--demonstrate",
    "with_demonstrations",
    is_flag=True,
    help="Let the robot execute each task in simulation, and store the episodes.",
)
@camera_options
@click.option(
    "--language", default="en", show_default=True, metavar="LANGUAGE", shell_complete=shell_completion.languages,
    help="Language of instructions: en, or another language for which the domain has words, such as de.",
)  # fmt: skip
@click.option(
    "--phrasings", default="", metavar="'K of N'",
    help="Use only every N-th phrasing, starting with the K-th; '1 of 2' and '2 of 2' share no phrasing.",
)  # fmt: skip
@click.option("--shard", type=whole(1), metavar="K", help="Maximum number of tasks in a file.  [default: 1000]")
@max_draws
@click.option(
    "--part", metavar="K/N",
    help="Run job K of N, which validates every N-th sampled task; prag-asp merge combines the results of all jobs.",
)  # fmt: skip
@ray
@click.option(
    "-o",
    "--output",
    metavar="DIR",
    required=True,
    shell_complete=shell_completion.files,
    help="Folder of the dataset.",
)
def generate(
    *,
    request: DomainOptions,
    tasks: int | None,
    cover: int | None,
    diverse: int | None,
    candidates: int | None,
    seed: int,
    weighting: WeightOptions,
    over: Any,
    evenly: bool,
    trivial: bool,
    split: str | None,
    excluded: tuple[str, ...],
    stratifying: StrataOptions,
    skeletons: bool,
    held: str | None,
    starts: int,
    physics: bool | None,
    validation: PhysicsOptions,
    with_demonstrations: bool,
    filming: CameraOptions,
    language: str,
    phrasings: str,
    shard: int | None,
    max_draws: int | None,
    part: str | None,
    on: str | None,
    output: str,
) -> None:
    """Write a dataset of distinct feasible tasks of length N.

    Tasks are sampled without replacement. DIR holds Parquet tables of tasks, witnesses and rejected tasks, a
    dataset.json with exact numbers, the domain, and a dataset card. If the command is interrupted, run it again: it
    continues, and the result is the same, byte for byte.
    """
    from prag_asp.dataset.dataset_spec import SHARD
    from prag_asp.dataset.generation import generate as make
    from prag_asp.dataset.scenes import scene_of
    from prag_asp.dataset.stored_scenarios import read_earlier
    from prag_asp.missing import require_pyarrow

    require_pyarrow()
    if tasks is None and cover is None and diverse is None:
        raise QueryError("the number of tasks is missing; give --tasks K, --cover T or --diverse K")
    validation.parse_budget()
    filming.check(output if with_demonstrations else None)
    shares = None if split is None else parse_shares_option(split)
    stratification = stratifying.stratification(
        {
            "--split": split is not None, "--skeletons": skeletons, "--hold-out": held is not None,
            "--except": bool(excluded), "--evenly": evenly, "--over": over is not None,
            "--weight": bool(weighting.weight), "--temperature": weighting.temperature != "1",
            "--cover": cover is not None, "--diverse": diverse is not None,
        }
    )  # fmt: skip
    with progress() as tell, warnings_as_lines():
        space = request.spaces(tell)
        with_physics = physics if physics is not None else bool(space.domain.settings.scene)
        if not with_physics:
            validation.refuse_without_physics({"--demonstrate": with_demonstrations, "--starts": starts > 1})
        uniform = cover is not None and not weighting.weight and weighting.temperature == "1"
        staging = filming.staging(*([scene_of(space.domain)] if filming.any else []))
        print_existing(output)
        try:
            dataset = make(
                space, output, tasks=tasks, seed=seed, split=shares, skeletons=skeletons, hold_out=held, starts=starts,
                demonstrate=with_demonstrations, over=over, evenly=evenly, trivial=trivial,
                stratification=stratification, cover=cover, diverse=diverse, candidates=candidates,
                **({} if stratification or uniform else weighting.arguments(space.domain)),
                physics=with_physics, budget=validation.parse_budget() if with_physics else None,
                workers=validation.workers,
                shard=shard or SHARD, language=language, phrasings=phrasings, staging=staging, max_draws=max_draws,
                part=part, on=on, excluded=chain.from_iterable(map(read_earlier, excluded)), progress=tell,
            )  # fmt: skip
        except NotFound:
            tell_line(f"{output}: holds the tasks that were found")
            raise
    print_parts(dataset)


def parse_shares_option(text: str) -> dict[str, str]:
    """Return the parts in a text such as ``train=0.8,test=0.2``, with their shares as strings.

    Raises:
        QueryError: the text does not have this form.
    """
    shares: dict[str, str] = {}
    for each in text.split(","):
        name, equals, share = (part.strip() for part in each.partition("="))
        if not equals or not name or not share or name in shares:
            raise QueryError(f"--split {text}: write different names with their shares, such as train=0.8,test=0.2")
        shares[name] = share
    return shares


@contextmanager
def warnings_as_lines() -> Iterator[None]:
    """Print each warning at once, on one line."""
    with warnings.catch_warnings():
        warnings.simplefilter("always")
        warnings.showwarning = lambda message, *_, **__: tell_line(f"warning: {message}")
        yield


def print_existing(output: str) -> None:
    """Print the number of tasks of an existing dataset, and whether it is complete."""
    from prag_asp.dataset.store.manifest import DATASET

    manifest = DATASET.read(Path(output))
    if manifest is not None and not manifest.complete:
        tell_line(f"{output}: continues an interrupted run, which has left {_count_tasks(manifest)}")
    elif manifest is not None:
        tell_line(f"{output}: already has {_count_tasks(manifest)}")


def _count_tasks(manifest: Manifest) -> str:
    """Return the number of tasks in the shards of a dataset."""
    return plural(manifest.rows("tasks"), "task")


def print_parts(dataset: Dataset) -> None:
    """Print the parts of a dataset with their sizes and, on stderr, why tasks were rejected."""
    from prag_asp.dataset.store.draw_results import TRIVIAL

    manifest = dataset.manifest
    width = max(len(part.name) for part in manifest.parts)
    rejected: Counter[str] = Counter()
    for part in manifest.parts:
        weight = f", each of weight {part.weight.numerator}/{part.weight.denominator}" if part.weight else ""
        say(f"{part.name:<{width}}  {part.tasks} of {part.size}{weight}")
        for tally in part.lengths:
            rejected.update({each.reason: each.count for each in tally.reasons if each.status != "trivial"})
    for line in chosen_lines(manifest):
        tell_line(line)
    wanted, found = manifest.spec.starts * manifest.rows("tasks"), manifest.rows("witnesses")
    if manifest.spec.starts > 1 and found < wanted:
        tell_line(f"only {found} of {plural(wanted, 'initial state')} have a witness; see the column starts")
    left_out = sum(tally.trivial for part in manifest.parts for tally in part.lengths)
    if left_out:
        tell_line(f"{plural(left_out, 'trivial task')} left out: {TRIVIAL}; keep them with --trivial")
    for reason, count in rejected.most_common():
        tell_line(f"{plural(count, 'task')} rejected: {reason}")


def chosen_lines(manifest: Manifest) -> Iterator[str]:
    """Yield lines about the coverage and the diversity of a dataset whose tasks were chosen for these."""
    if manifest.cover:
        cover = manifest.cover
        names = f"; missing: {', '.join(cover.missing[:SHOWN])}" if cover.missing else ""
        others = f" and {len(cover.missing) - SHOWN} more, see dataset.json" if len(cover.missing) > SHOWN else ""
        yield (
            f"the tasks cover {cover.covered} of {plural(cover.reachable, 'reachable combination')} of "
            f"{plural(cover.strength, 'factor')}{names}{others}"
        )
    for name, figures in (manifest.diverse or {}).items():
        yield (
            f"{name}: tasks at least {figures.separation:.4g} apart ({figures.metric}), and at most "
            f"{figures.radius:.4g} from any of {plural(figures.candidates, 'candidate')}"
        )

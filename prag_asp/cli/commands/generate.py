"""``prag-asp generate``: a data set of feasible tasks, as a folder of tables that loaders read."""

from __future__ import annotations

import warnings
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import click

from prag_asp.cli import options, shell_completion
from prag_asp.cli.bundles.camera_options import Filming, films
from prag_asp.cli.domain_options import Asked
from prag_asp.cli.options import Checking, Weighing, asks
from prag_asp.cli.terminal import progress, say, tell_line
from prag_asp.errors import NotFound, QueryError
from prag_asp.wording import plural

if TYPE_CHECKING:
    from prag_asp.dataset.store.dataset import Dataset
    from prag_asp.dataset.store.manifest import Manifest


@click.command()
@asks((*options.SPACES, options.TRUST))
@click.option(
    "--tasks", type=options.whole(1), required=True, metavar="K",
    help="How many tasks; of physics, feasible ones. A larger number adds to what is there.",
)  # fmt: skip
@options.seed
@options.weighs
@click.option("--evenly", is_flag=True, help="Draw all lengths alike, not by how many tasks they have.")
@click.option(
    "--split", metavar="NAME=SHARE,...",
    help="Parts with no task in common, such as train=0.8,test=0.2.  [default: one part, train]",
)  # fmt: skip
@click.option("--skeletons", is_flag=True, help="No two parts of --split have a skeleton in common.")
@click.option(
    "--hold-out", "held", metavar="WHAT", shell_complete=shell_completion.names,
    help="Entity, class, action or pair that only the part test has; it gets a fifth, or what --split says.",
)  # fmt: skip
@click.option(
    "--starts", type=options.whole(1), default=1, show_default=True, metavar="K",
    help="First states, each with a witness, that are looked for for each task.",
)  # fmt: skip
@click.option("--physics/--no-physics", default=None, help="Keep feasible tasks only.  [default: if there is a scene]")
@options.looks
@click.option(
    "--demonstrate", "performed", is_flag=True, help="Let the robot perform each task, and keep recordings (.npz)."
)
@films
@click.option(
    "--language", default="en", show_default=True, metavar="LANGUAGE", shell_complete=shell_completion.languages,
    help="Language of instructions: en, or one that the domain has words for, such as de.",
)  # fmt: skip
@click.option(
    "--phrasings", default="", metavar="'K of N'",
    help="Of the ways to say the same, every N-th from the K-th on; '1 of 2' and '2 of 2' have none in common.",
)  # fmt: skip
@click.option("--shard", type=options.whole(1), metavar="K", help="Tasks of a file, at most.  [1000]")
@options.MAX_DRAWS
@click.option(
    "--part", metavar="K/N",
    help="Look at every N-th draw alone, from the K-th on: one of N jobs, of which prag-asp merge makes the whole.",
)  # fmt: skip
@options.ON
@click.option(
    "-o",
    "--output",
    metavar="DIR",
    required=True,
    shell_complete=shell_completion.files,
    help="Folder of the data set.",
)
def generate(
    *,
    asked: Asked,
    tasks: int,
    seed: int,
    weighing: Weighing,
    evenly: bool,
    split: str | None,
    skeletons: bool,
    held: str | None,
    starts: int,
    physics: bool | None,
    checking: Checking,
    performed: bool,
    filming: Filming,
    language: str,
    phrasings: str,
    shard: int | None,
    max_draws: int | None,
    part: str | None,
    on: str | None,
    output: str,
) -> None:
    """Write a data set: different tasks of length N, their witnesses, and what was refused, with the exact figures.

    Tasks are drawn without replacement. DIR holds tables in Parquet, dataset.json, the domain, and a card for hubs.
    Each file is written whole; a run that was broken off goes on where it was when it is started again, to the same
    bytes.
    """
    from prag_asp.dataset.dataset_spec import SHARD
    from prag_asp.dataset.generation import generate as make
    from prag_asp.dataset.scenes import scene_of
    from prag_asp.missing import require_pyarrow

    require_pyarrow()
    checking.limits()
    filming.refuse_at_odds(output if performed else None)
    shares = None if split is None else parse_shares_option(split)
    with progress() as tell, warnings_as_lines():
        space = asked.spaces(tell)
        looks = physics if physics is not None else bool(space.domain.settings.scene)
        if not looks:
            checking.refuse_without_physics({"--demonstrate": performed, "--starts": starts > 1})
        staging = filming.staging(*([scene_of(space.domain)] if filming.asked else []))
        tell_what_is_there(output)
        try:
            made = make(
                space, output, tasks=tasks, seed=seed, split=shares, skeletons=skeletons, hold_out=held, starts=starts,
                demonstrate=performed, evenly=evenly, **weighing.arguments(space.domain), physics=looks,
                budget=checking.limits() if looks else None, workers=checking.workers, shard=shard or SHARD,
                language=language, phrasings=phrasings, staging=staging, max_draws=max_draws, part=part, on=on,
                progress=tell,
            )  # fmt: skip
        except NotFound:
            tell_line(f"{output}: holds what was found")
            raise
    show(made)


def parse_shares_option(text: str) -> dict[str, str]:
    """Return the parts that ``train=0.8,test=0.2`` names, with their shares as they are written.

    Raises:
        QueryError: it is written in another way.
    """
    found: dict[str, str] = {}
    for each in text.split(","):
        name, equals, share = (part.strip() for part in each.partition("="))
        if not equals or not name or not share or name in found:
            raise QueryError(f"--split {text}: write different names with their shares, such as train=0.8,test=0.2")
        found[name] = share
    return found


@contextmanager
def warnings_as_lines() -> Iterator[None]:
    """Tell each warning at once, in one line."""
    with warnings.catch_warnings():
        warnings.simplefilter("always")
        warnings.showwarning = lambda message, *_, **__: tell_line(f"warning: {message}")
        yield


def tell_what_is_there(output: str) -> None:
    """Say that a run goes on with what another one has left."""
    from prag_asp.dataset.store.manifest import read_manifest

    manifest = read_manifest(Path(output))
    if manifest is not None and not manifest.complete:
        tell_line(f"{output}: goes on after a run that was broken off, which has left {_tasks(manifest)}")
    elif manifest is not None:
        tell_line(f"{output}: has {_tasks(manifest)} already")


def _tasks(manifest: Manifest) -> str:
    """Return how many tasks stand in shards that a data set has."""
    return plural(manifest.rows("tasks"), "task")


def show(made: Dataset) -> None:
    """Print the parts with their sizes, and on stderr why tasks were refused."""
    manifest = made.manifest
    width = max(len(part.name) for part in manifest.parts)
    refused: Counter[str] = Counter()
    for part in manifest.parts:
        say(f"{part.name:<{width}}  {part.tasks} of {part.size}")
        for tally in part.lengths:
            refused.update({reason.reason: reason.count for reason in tally.reasons})
    wanted, found = manifest.asked.starts * manifest.rows("tasks"), manifest.rows("witnesses")
    if manifest.asked.starts > 1 and found < wanted:
        tell_line(
            f"only {found} of {plural(wanted, 'first state')} have a witness; the column starts says of which tasks"
        )
    for reason, count in refused.most_common():
        tell_line(f"{plural(count, 'task')} refused: {reason}")

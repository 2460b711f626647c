"""Make a data set: draw without replacement, look at each task by physics, write it down."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from prag_asp.dataset.dataset_spec import SHARD, Wanted
from prag_asp.dataset.making.executors import place_of
from prag_asp.dataset.making.run import Progress, Run
from prag_asp.dataset.store.domain_snapshot import kept
from prag_asp.errors import QueryError
from prag_asp.missing import require_pyarrow
from prag_asp.physics import Budget, Tier, require_physics
from prag_asp.space.sampling.sharding import ALL, Deal
from prag_asp.space.without_replacement import Division

if TYPE_CHECKING:
    from prag_asp.dataset.store.dataset import Dataset
    from prag_asp.domain.load import Domain
    from prag_asp.physics import Staging
    from prag_asp.space.task_space import TaskSpace
    from prag_asp.space.weights.temperature import Temperature
    from prag_asp.space.weights.weights import Number


def generate(
    space: TaskSpace,
    folder: str | Path,
    *,
    tasks: int,
    seed: int = 0,
    split: Mapping[str, Number | float] | None = None,
    skeletons: bool = False,
    hold_out: str | None = None,
    starts: int = 1,
    demonstrate: bool = False,
    evenly: bool = False,
    weights: Mapping[str, Number] | None = None,
    temperature: Temperature = 1,
    physics: bool | None = None,
    budget: Budget | None = None,
    workers: int = 1,
    shard: int = SHARD,
    language: str = "en",
    phrasings: str = "",
    staging: Staging | None = None,
    max_draws: int | None = None,
    part: str | None = None,
    on: str | None = None,
    progress: Progress = lambda words, done, total: None,
) -> Dataset:
    """Write a data set of so many different feasible tasks into a folder, and open it.

    Tasks are drawn without replacement, by the weights of the domain unless others are given; lengths have their exact
    share or come `evenly`. With `split`, each part gets its share of the tasks, and no two parts have a task (with
    `skeletons`: a skeleton) in common; with `hold_out`, only ``test`` has something. `starts` are the first states
    that a witness is looked for from, for each task. With `demonstrate`, the robot performs each, with what `staging`
    asks for: cameras that film, and what varies. Without `physics`, which is asked where the domain has a scene, all
    tasks are taken as they are drawn. Instructions are in a `language` of the domain, and in some of its `phrasings`,
    such as ``1 of 2``.

    What was begun goes on; a larger number of `tasks` adds to what is there. All depends on the seed alone, not on the
    number of `workers`, nor on where these are: with ``on="ray"``, on the nodes of a Ray cluster. A `shard` holds so
    many tasks at most. With ``part="3/64"``, only every 64th draw is looked at, from the third on, for as many of the
    tasks: `merge` makes the data set from all 64 of them.

    Raises:
        QueryError: there is nothing to draw, or the draw is asked for in a wrong way.
        SceneError: the domain has no scene, or a task speaks of something for which the scene has no shape.
        OutputError: the folder holds something else, or a file cannot be written.
        NotFound: fewer tasks are found in `max_draws` draws a part, or there are no more; those found are written.
        WorkerError: workers died again and again.
        DatasetsMissingError: pyarrow is not installed.
        RayMissingError: Ray is to be used, but not installed.
    """
    require_pyarrow()
    place = place_of(workers, on)
    chosen = _budget(space.domain, physics, budget, demonstrate, starts)
    if staging is not None:
        require_staging(staging, space.domain, demonstrate, starts)
    division = Division.parse(split, skeletons=skeletons, hold_out=hold_out)
    wanted = Wanted(
        tasks, seed, division, chosen, starts, demonstrate, evenly, weights, temperature, shard, language, staging,
        max_draws, ALL if part is None else Deal.parse(part), phrasings,
    )  # fmt: skip
    return Run(space, Path(folder), wanted, kept(space.domain), place, progress).done()


def _budget(
    domain: Domain, physics: bool | None, given: Budget | None, demonstrate: bool, starts: int
) -> Budget | None:
    """Return the budget of physics, with the tier of demonstrations where these are recorded; None without physics.

    Raises:
        QueryError: something is asked for that only physics gives, and physics is not asked.
        PhysicsMissingError: PyBullet is not installed.
    """
    if not (domain.settings.scene if physics is None else physics):
        if demonstrate or starts > 1 or given is not None:
            raise QueryError("demonstrations, first states and a budget need physics; leave them out")
        return None
    require_physics()
    budget = given or Budget()
    return Budget(budget.restarts, budget.samples, Tier.DEMONSTRATION) if demonstrate else budget


def require_staging(staging: Staging, domain: Domain, demonstrate: bool, starts: int) -> None:
    """Check that what is staged can be, before anything is written.

    Raises:
        QueryError: nothing is demonstrated, the scene has no such camera, or colours vary from one first state of a
            task to the next, while its instructions speak of the colours of one.
        SceneError: the domain has no scene.
    """
    from prag_asp.dataset.physics_filter import require_demonstrated
    from prag_asp.dataset.scenes import scene_of

    require_demonstrated(staging, "" if demonstrate else None)
    if "colour" in staging.vary and starts > 1:
        raise QueryError(
            f"a task is told by the colours of one recording, and {starts} starts have as many; "
            "ask for 1 start, or leave colour out of what varies"
        )
    staging.cameras_of(scene_of(domain))

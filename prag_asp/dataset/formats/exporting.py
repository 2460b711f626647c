"""Export a dataset to the format of another program."""

from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module
from pathlib import Path

from prag_asp.dataset.formats.episode_source import EpisodeSource
from prag_asp.dataset.formats.export_format import FORMS, ExportFormat, Progress
from prag_asp.dataset.store.dataset import Dataset
from prag_asp.errors import OutputError, QueryError
from prag_asp.missing import require_packages
from prag_asp.processes.progress_events import report_progress
from prag_asp.safe_reading import is_inside
from prag_asp.wording import unknown

UNCHANGED = {"state": ("joint_position",), "objects": None, "depth": False}
"""The options that exist only for LeRobot, with their defaults."""


def export(
    data: Dataset | str | Path,
    form: str,
    target: str | Path,
    *,
    level: str = "default",
    action: str = "joint_position",
    state: Sequence[str] = ("joint_position",),
    objects: bool | None = None,
    depth: bool = False,
    progress: Progress = report_progress,
) -> Path:
    """Export a dataset, or a part or subset of one, and return the path of the export.

    `form` is one of ``lerobot``, ``minari``, ``robomimic``, ``bddl`` and ``rerun``; `target` is a new folder or, for
    ``robomimic``, a new file. The export is written atomically, with the same bytes for the same dataset, except for
    ``rerun``, which numbers rows at random. `level` is the level of detail of the instructions: ``vague``, ``default``
    or ``exact``. `action` is the convention of actions, one of `prag_asp.physics.control.control.CONTROLS`. The other
    options apply only to ``lerobot``, because the other formats have all observations. `state` holds the conventions of
    the state: ``joint_position``, ``ee_position`` or both; `objects` adds the poses of objects, by default only if
    there are no cameras; `depth` adds the depth images.

    Raises:
        QueryError: there is no such format or convention, or the dataset has no recordings or no task.
        DomainError: the domain of the dataset differs from the record in dataset.json.
        OutputError: the export cannot be written, or the target exists.
        DatasetsMissingError: a package that the format needs is not installed.
    """
    if form not in FORMS:
        raise QueryError(unknown(form, FORMS, "form"))
    info = FORMS[form]
    require_packages(form, info.packages, info.extra)
    source = EpisodeSource(data if isinstance(data, Dataset) else Dataset.open(data), level, action)
    if info.recorded:
        source.require_recordings()
    path = Path(target)
    if is_inside(path, source.data.folder):
        raise OutputError(f"{path}: lies in the dataset {source.data.folder}; choose another place")
    maker = getattr(import_module(f"prag_asp.dataset.formats.{form}"), info.title)
    options = {"state": tuple(state), "objects": objects, "depth": depth}
    if form == "lerobot":
        writer: ExportFormat = maker(**options)
    elif options == UNCHANGED:
        writer = maker()
    else:
        raise QueryError(f"state, objects and depth are for lerobot: {form} has all observations")
    writer.write(source, path, progress)
    return path

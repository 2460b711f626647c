"""Write a dataset in the form of another program."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path

from prag_asp.dataset.formats.episode_source import EpisodeSource
from prag_asp.dataset.formats.export_format import FORMS, ExportFormat, Progress
from prag_asp.dataset.store.dataset import Dataset
from prag_asp.errors import OutputError, QueryError
from prag_asp.missing import require_packages
from prag_asp.safe_reading import is_inside
from prag_asp.wording import unknown


def export(
    data: Dataset | str | Path,
    form: str,
    target: str | Path,
    *,
    level: str = "default",
    progress: Progress = lambda words, done, total: None,
) -> Path:
    """Write a dataset, or some parts or tasks of it, in another form, and return where that is.

    `form` is one of ``lerobot``, ``minari``, ``robomimic`` and ``bddl``; `target` a new folder, of ``robomimic`` a
    file. It is there when it is whole, and has the same bytes for the same dataset. `level` is how much the
    instructions say: ``vague``, ``default`` or ``exact``.

    Raises:
        QueryError: there is no such form, or the dataset has no recordings, or no task that is asked for.
        DomainError: the domain of the dataset is not what dataset.json says.
        OutputError: it cannot be written, or is there already.
        DatasetsMissingError: a package that the form needs is not installed.
    """
    if form not in FORMS:
        raise QueryError(unknown(form, FORMS, "form"))
    known = FORMS[form]
    require_packages(form, known.packages)
    source = EpisodeSource(data if isinstance(data, Dataset) else Dataset.open(data), level)
    if known.recorded:
        source.require_recordings()
    path = Path(target)
    if is_inside(path, source.data.folder):
        raise OutputError(f"{path}: lies in the dataset {source.data.folder}; choose another place")
    writer: ExportFormat = getattr(import_module(f"prag_asp.dataset.formats.{form}"), known.title)()
    writer.write(source, path, progress)
    return path

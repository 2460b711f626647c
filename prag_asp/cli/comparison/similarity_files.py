"""Files that ``prag-asp similarity`` writes: matrix, neighbours, near-duplicates, chosen tasks, dendrogram and map."""

from __future__ import annotations

import json
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

import click

from prag_asp.cli import shell_completion
from prag_asp.cli.comparison.compared_tasks import ComparedTasks
from prag_asp.cli.options import grouped
from prag_asp.errors import PicturesMissingError, QueryError

if TYPE_CHECKING:
    from prag_asp.analysis.all_pairs import PairDistances
    from prag_asp.analysis.distance_matrix import NearDuplicates, SimilarityMatrix
    from prag_asp.analysis.farthest_first import DiverseChoice

PICTURES = (".png", ".svg", ".pdf")
JSON = ".json"
LABEL = 60
"""The maximum number of characters of a label in a picture."""


@dataclass(frozen=True)
class SimilarityFiles:
    """The names of the files to write, each None if it is not requested."""

    output: str | None = None
    nearest: str | None = None
    duplicates: str | None = None
    chosen: str | None = None
    dendrogram: str | None = None
    map: str | None = None

    @property
    def names(self) -> list[str]:
        """The files to write."""
        given = (self.output, self.nearest, self.duplicates, self.chosen, self.dendrogram, self.map)
        return [file for file in given if file is not None]

    @property
    def needs_matrix(self) -> bool:
        """Whether one of the files needs the whole distance matrix."""
        return (self.output, self.dendrogram, self.map) != (None, None, None)

    def check(self, *, one_set: bool) -> None:
        """Check the names of the files before anything is computed.

        Raises:
            QueryError: a file is requested for two tasks, or has a wrong extension.
            PicturesMissingError: matplotlib is not installed.
        """
        from prag_asp.analysis.distance_matrix import check_suffix

        if self.names and not one_set:
            raise QueryError(f"{self.names[0]}: files are written for a dataset or a file of tasks, not for two tasks")
        for file in (self.output, self.nearest, self.duplicates):
            if file is not None:
                check_suffix(file)
        for file in (self.dendrogram, self.map):
            if file is None or Path(file).suffix == JSON:
                continue
            if Path(file).suffix not in PICTURES:
                raise QueryError(f"{file}: give a file that ends in {', '.join(PICTURES)} or {JSON}")
            if find_spec("matplotlib") is None:
                raise PicturesMissingError("a picture needs matplotlib: pip install 'prag_asp[pictures]'")

    def write(
        self,
        compared: SimilarityMatrix | PairDistances,
        given: ComparedTasks,
        duplicates: NearDuplicates,
        neighbours: int,
        choice: DiverseChoice | None,
        title: str,
    ) -> None:
        """Write the requested files."""
        from prag_asp.analysis.distance_matrix import SimilarityMatrix, nearest_neighbours
        from prag_asp.dataset.jsonl import Record, write_line
        from prag_asp.output import replace_file

        if self.nearest is not None:
            nearest_neighbours(compared, neighbours).save(self.nearest)
        if self.duplicates is not None:
            duplicates.save(self.duplicates)
        if self.chosen is not None and choice is not None:
            lines = (write_line(Record(given.tasks[number])) for number in choice.tasks)
            replace_file(self.chosen, "".join(f"{line}\n" for line in lines).encode())
        if not isinstance(compared, SimilarityMatrix):
            return
        if self.output is not None:
            compared.save(self.output)
        if self.dendrogram is not None:
            _write_dendrogram(self.dendrogram, compared, given, title)
        if self.map is not None:
            _write_map(self.map, compared, given, title)


def _write_dendrogram(file: str, matrix: SimilarityMatrix, given: ComparedTasks, title: str) -> None:
    from prag_asp.analysis.plots.dendrogram import dendrogram_figure, dendrogram_of
    from prag_asp.analysis.plots.picture import saved
    from prag_asp.output import replace_file

    found = dendrogram_of(matrix.distances)
    if Path(file).suffix == JSON:
        replace_file(file, (json.dumps({"count": found.count, "merges": found.merges}) + "\n").encode())
        return
    labels = [f"{number}  {task!s}"[:LABEL] for number, task in enumerate(given.tasks)]
    replace_file(file, saved(dendrogram_figure(found, labels, title), Path(file).suffix))


def _write_map(file: str, matrix: SimilarityMatrix, given: ComparedTasks, title: str) -> None:
    from prag_asp.analysis.plots.picture import saved
    from prag_asp.analysis.plots.task_scaling import map_figure, task_map
    from prag_asp.output import replace_file

    placed = task_map(matrix.distances)
    if Path(file).suffix == JSON:
        values = {"points": placed.points.tolist(), "groups": given.groups, "share": placed.share}
        replace_file(file, (json.dumps(values) + "\n").encode())
        return
    replace_file(file, saved(map_figure(placed, given.groups, title), Path(file).suffix))


FILE_OPTIONS = grouped(
    "files", SimilarityFiles,
    (
        click.option(
            "-o", "--output", metavar="FILE", shell_complete=shell_completion.files,
            help="Write the matrix of distances to FILE, a .npz or .parquet.",
        ),
        click.option(
            "--nearest", metavar="FILE", shell_complete=shell_completion.files,
            help="Write the nearest tasks of each task to FILE, a .npz or .parquet.",
        ),
        click.option(
            "--duplicates", metavar="FILE", shell_complete=shell_completion.files,
            help="Write the pairs of near-duplicates to FILE, a .npz or .parquet.",
        ),
        click.option(
            "--chosen", metavar="FILE", shell_complete=shell_completion.files,
            help="With --diverse: write the chosen tasks to FILE as JSON lines.",
        ),
        click.option(
            "--dendrogram", metavar="FILE", shell_complete=shell_completion.files,
            help="Write clusters by mean distance to FILE, a .png, .svg, .pdf or .json.",
        ),
        click.option(
            "--map", metavar="FILE", shell_complete=shell_completion.files,
            help="Write a map in two dimensions to FILE, a .png, .svg, .pdf or .json.",
        ),
    ),
)  # fmt: skip
"""The decorator that gives a command the options for the files to write, as a single value `files`."""

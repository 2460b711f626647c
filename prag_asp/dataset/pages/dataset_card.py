"""The card of a dataset: README.md, which dataset hubs display, with film strips."""

from __future__ import annotations

import json
from collections.abc import Iterator
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING

from prag_asp.dataset.language import sentence
from prag_asp.dataset.store.dataset import Dataset
from prag_asp.dataset.store.domain_snapshot import FileRecord
from prag_asp.dataset.store.manifest import FOLDERS, Manifest, summed
from prag_asp.errors import PicturesMissingError
from prag_asp.integers import grouped, number_of
from prag_asp.output import file_in, make_folder, replace_file
from prag_asp.processes.progress_events import stage
from prag_asp.safe_reading import read_bytes
from prag_asp.wording import plural

if TYPE_CHECKING:
    from prag_asp.domain.load import Domain

NAME = "README.md"
ABOUT = {
    "tasks": "tasks: plan, initial state, subgoals, goal, instructions, verdict",
    "witnesses": "a witness from each initial state of each task, as JSON; `task` and `start` are their numbers",
    "rejected": "sampled tasks that were not found feasible or were proved infeasible, with the causes",
    "recordings": "recordings of the robot executing the tasks, each in an `.npz` file",
}
SIZES = (
    (1_000, "n<1K"), (10_000, "1K<n<10K"), (100_000, "10K<n<100K"), (1_000_000, "100K<n<1M"), (10_000_000, "1M<n<10M"),
)  # fmt: skip
LARGEST_SIZE = "n>10M"

EXAMPLE = """```python
from datasets import load_dataset
load_dataset("NAME OR FOLDER OF THIS DATASET", "tasks")["{part}"][0]["instruction"]

from prag_asp import Dataset
dataset = Dataset.open("FOLDER")
dataset.task(0), dataset.domain.name
```
"""

PICTURES = "pictures"
STRIPS, STATES = 2, 4
"""The numbers of film strips and of states in each; rendering a state takes as long as a few dozen verdicts."""

STRIP_SIZE = (240, 210)
"""The width and height of the picture of a state, in pixels."""


def write_card(folder: Path, manifest: Manifest, domain: Domain) -> None:
    """Write the card of a dataset and its pictures, and record the pictures in the manifest.

    Raises:
        OutputError: a file cannot be written.
    """
    manifest.pictures = write_strips(folder, manifest, domain)
    replace_file(file_in(folder, NAME), card_text(manifest, domain), follow=False)


def write_strips(folder: Path, manifest: Manifest, domain: Domain) -> list[FileRecord]:
    """Write film strips of the first tasks if the dataset has witnesses and Pillow is installed.

    Raises:
        OutputError: a picture cannot be written.
    """
    if not manifest.rows("witnesses"):
        return []
    from prag_asp.dataset.scenes import scene_of
    from prag_asp.physics import film_strip
    from prag_asp.physics.pictures.saving import save_picture

    stage("drawing pictures")
    data = Dataset(folder, manifest, parts=tuple(part.name for part in manifest.parts))
    scene, language, records = scene_of(domain), domain.settings.language, []
    for number in range(min(STRIPS, data.count())):
        task = data.task(number)
        headings = [sentence(action, language) if action.name in language else None for action in task.actions]
        try:
            strip = film_strip(
                task, data.witness(number), scene, frames=STATES, columns=STATES, size=STRIP_SIZE, headings=headings
            )
        except PicturesMissingError:
            return []
        name = f"{PICTURES}/{number:03d}.png"
        save_picture(strip, make_folder(folder / PICTURES) / Path(name).name)
        content = read_bytes(folder / name)
        records.append(FileRecord(name, len(content), sha256(content).hexdigest()))
    return records


def card_text(manifest: Manifest, domain: Domain) -> bytes:
    """Return the content of the card of a dataset."""
    lines = [*_front(manifest, domain), *_text(manifest, domain, [each.path for each in manifest.pictures])]
    return "".join(f"{line}\n" for line in lines).encode()


def _front(manifest: Manifest, domain: Domain) -> Iterator[str]:
    """Yield the front matter for hubs and loaders, with the files of each table by part."""
    tasks = manifest.rows("tasks")
    yield from front_matter(_title(manifest, domain), "robotics", "task-planning", "prag_asp")
    yield "size_categories:"
    yield f"- {next((name for bound, name in SIZES if tasks < bound), LARGEST_SIZE)}"
    yield "configs:"
    for table, below in FOLDERS.items():
        parts = [part.name for part in manifest.parts if part.rows(table)]
        if not parts:
            continue
        yield f"- config_name: {table}"
        if table == "tasks":
            yield "  default: true"
        yield "  data_files:"
        for name in parts:
            yield f"  - split: {name}"
            yield f"    path: {below}/{name}-*.parquet"
    yield "---"


def front_matter(title: str, *tags: str) -> Iterator[str]:
    """Yield the first lines of the front matter of a card."""
    yield "---"
    yield f"pretty_name: {json.dumps(title)}"
    yield "task_categories:"
    yield "- robotics"
    yield "tags:"
    yield from (f"- {tag}" for tag in tags)


def _text(manifest: Manifest, domain: Domain, pictures: list[str]) -> Iterator[str]:
    """Yield the lines of the card after the front matter."""
    spec = manifest.spec
    yield f"# {_title(manifest, domain)}"
    yield ""
    if domain.settings.description:
        yield domain.settings.description
        yield ""
    lengths = ", ".join(map(str, manifest.lengths))
    drawn = "by weight" if spec.weights else "uniformly"
    where = "".join(f", where {clause}" for clause in manifest.where)
    yield f"Tasks of {lengths} actions{where}, sampled {drawn} without replacement with seed {spec.seed}."
    if spec.strata:
        yield f"Each part is a stratum, the tasks of one {spec.strata}; `dataset.json` has the weight of its tasks."
    if manifest.cover:
        cover, factors = manifest.cover, plural(manifest.cover.strength, "factor")
        yield f"The tasks cover {cover.covered} of {cover.reachable} reachable combinations of {factors}."
    for name, figures in (manifest.diverse or {}).items():
        yield (
            f"The tasks of {name} were chosen from {figures.candidates} candidates, and are at least "
            f"{figures.separation:.4g} apart ({figures.metric})."
        )
    if spec.part is not None:
        yield f"This is part {spec.part} of a dataset; `prag-asp merge` combines all parts."
    if spec.budget:
        effort = f"{spec.budget.restarts} x {spec.budget.samples}, {spec.budget.tier}"
        yield f"Each task was found feasible by physics (budget {effort})."
    assert manifest.covered is not None
    yield f"The space has {grouped(manifest.size)} tasks; this dataset has {_percent(manifest.covered.value)} of them."
    yield ""
    for path in pictures:
        yield f"![The states of a task]({path})"
        yield ""
    yield "| part | tasks | draws | of all tasks of the part |"
    yield "|---|---|---|---|"
    for part in manifest.parts:
        assert part.covered is not None
        share = f"{_percent(part.covered.value)} of {grouped(number_of(part.size))}"
        yield f"| {part.name} | {part.tasks:,} | {part.draws:,} | {share} |"
    yield ""
    yield from _by_length(manifest)
    yield "| table | rows | what |"
    yield "|---|---|---|"
    for table, below in FOLDERS.items():
        if manifest.rows(table):
            yield f"| `{below}/` | {manifest.rows(table):,} | {ABOUT[table]} |"
    yield ""
    yield EXAMPLE.format(part=manifest.parts[0].name)
    yield f"Written by {manifest.versions}. `dataset.json` has the exact figures and the hashes of all files;"
    yield "`domain/` and `encodings/` contain the logic program of the domain."


def _by_length(manifest: Manifest) -> Iterator[str]:
    """Yield a table of the outcomes of draws for each length."""
    columns = ("length", "tasks in the space", "drawn", "trivial", "feasible", "not found", "proved infeasible")
    yield f"| {' | '.join(columns)} | most common causes |"
    yield "|---|---|---|---|---|---|---|---|"
    drawn = {each.length: each for each in summed(tally for part in manifest.parts for tally in part.lengths)}
    for space in manifest.spaces:
        each = drawn.get(space.length)
        if each is None:
            yield f"| {space.length} | {grouped(number_of(space.tasks))} | 0 | | | | | |"
            continue
        causes = sorted(each.causes, key=lambda cause: (-cause.count, cause.cause))[:3]
        reasons = ", ".join(f"{cause.cause} ({cause.count:,})" for cause in causes)
        feasible = f"{each.feasible:,} ({_percent(each.pass_rate)})"
        numbers = f"{each.drawn:,} | {each.trivial:,} | {feasible} | {each.not_found:,} | {each.infeasible:,}"
        yield f"| {space.length} | {grouped(number_of(space.tasks))} | {numbers} | {reasons} |"
    yield ""


def _title(manifest: Manifest, domain: Domain) -> str:
    return f"{domain.settings.title or domain.label}: {plural(manifest.rows('tasks'), 'task')}"


def _percent(share: float) -> str:
    return f"{100 * share:.3g} %"

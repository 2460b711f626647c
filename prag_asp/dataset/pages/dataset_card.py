"""The card of a dataset: README.md, which hubs display, with film strips."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from prag_asp.dataset.pages.strips import write_strips
from prag_asp.dataset.store.manifest import Manifest, PartManifest, summed
from prag_asp.integers import grouped, number_of
from prag_asp.output import file_in, replace_file
from prag_asp.wording import plural

if TYPE_CHECKING:
    from prag_asp.domain.load import Domain

NAME = "README.md"
TABLES = {"tasks": "data", "witnesses": "witnesses", "refused": "refused", "recordings": "recordings"}
"""The folder of each table, in the order in which a hub offers them."""

ABOUT = {
    "tasks": "tasks: plan, initial state, subgoals, goal, instructions, verdict",
    "witnesses": "how a robot does each of them, from each initial state, as JSON: `task` and `start` number them",
    "refused": "tasks that were drawn and not found feasible, or proved infeasible, with the causes",
    "recordings": "the files of recordings of the robot performing them, each an `.npz`",
}
SIZES = (
    (1_000, "n<1K"), (10_000, "1K<n<10K"), (100_000, "10K<n<100K"), (1_000_000, "100K<n<1M"), (10_000_000, "1M<n<10M"),
)  # fmt: skip
LARGEST_SIZE = "n>10M"


def write_card(folder: Path, manifest: Manifest, domain: Domain) -> None:
    """Write the card of a dataset and its pictures, and record the pictures in the manifest.

    Raises:
        OutputError: a file cannot be written.
    """
    manifest.pictures = write_strips(folder, manifest, domain)
    replace_file(file_in(folder, NAME), card_text(manifest, domain), follow=False)


def card_text(manifest: Manifest, domain: Domain) -> bytes:
    """Return the content of the card of a dataset."""
    lines = [*_front(manifest, domain), *_text(manifest, domain, [each.path for each in manifest.pictures])]
    return "".join(f"{line}\n" for line in lines).encode()


def _front(manifest: Manifest, domain: Domain) -> Iterator[str]:
    """Yield the front matter for hubs and loaders, with the files of each table by part."""
    tasks = manifest.rows("tasks")
    yield "---"
    yield f"pretty_name: {json.dumps(_title(manifest, domain))}"
    yield "task_categories:"
    yield "- robotics"
    yield "tags:"
    for tag in ("robotics", "task-planning", "prag_asp"):
        yield f"- {tag}"
    yield "size_categories:"
    yield f"- {next((name for bound, name in SIZES if tasks < bound), LARGEST_SIZE)}"
    yield "configs:"
    for table, below in TABLES.items():
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


def _text(manifest: Manifest, domain: Domain, pictures: list[str]) -> Iterator[str]:
    """Yield the lines for readers."""
    spec = manifest.spec
    yield f"# {_title(manifest, domain)}"
    yield ""
    if domain.settings.description:
        yield domain.settings.description
        yield ""
    lengths = ", ".join(map(str, manifest.lengths))
    drawn = "by weight" if spec.weights else "uniformly"
    where = "".join(f", where {clause}" for clause in manifest.where)
    yield f"Tasks of {lengths} actions{where}, drawn {drawn} and without replacement by seed {spec.seed}."
    if spec.part is not None:
        yield f"This is part {spec.part} of a dataset: `prag-asp merge` makes it from all of them."
    if spec.budget:
        effort = f"{spec.budget.restarts} x {spec.budget.samples}, {spec.budget.tier}"
        yield f"Each was found feasible by physics (budget {effort})."
    assert manifest.covered is not None
    yield f"The space has {grouped(manifest.size)} tasks; these are {_percent(manifest.covered.value)} of them."
    yield ""
    for path in pictures:
        yield f"![The states of a task]({path})"
        yield ""
    yield "| part | tasks | draws | of all tasks of the part |"
    yield "|---|---|---|---|"
    for part in manifest.parts:
        yield f"| {part.name} | {part.tasks:,} | {part.draws:,} | {_share(part)} of {grouped(number_of(part.size))} |"
    yield ""
    yield from _by_length(manifest)
    yield "| table | rows | what |"
    yield "|---|---|---|"
    for table, below in TABLES.items():
        if manifest.rows(table):
            yield f"| `{below}/` | {manifest.rows(table):,} | {ABOUT[table]} |"
    yield ""
    yield from _reading(manifest)
    yield f"Made by {manifest.versions}. `dataset.json` has all figures, exactly, and the hashes of all files;"
    yield "`domain/` and `encodings/` are the logic program that the tasks are of."


def _by_length(manifest: Manifest) -> Iterator[str]:
    """Yield the table of the outcomes of the draws by length."""
    yield "| length | tasks in the space | drawn | feasible | not found | proved infeasible | most common causes |"
    yield "|---|---|---|---|---|---|---|"
    drawn = {each.length: each for each in summed(tally for part in manifest.parts for tally in part.lengths)}
    for space in manifest.spaces:
        each = drawn.get(space.length)
        if each is None:
            yield f"| {space.length} | {grouped(number_of(space.tasks))} | 0 | | | | |"
            continue
        causes = sorted(each.causes, key=lambda cause: (-cause.count, cause.cause))[:3]
        reasons = ", ".join(f"{cause.cause} ({cause.count:,})" for cause in causes)
        feasible = f"{each.feasible:,} ({_percent(each.pass_rate)})"
        numbers = f"{each.drawn:,} | {feasible} | {each.not_found:,} | {each.infeasible:,}"
        yield f"| {space.length} | {grouped(number_of(space.tasks))} | {numbers} | {reasons} |"
    yield ""


def _reading(manifest: Manifest) -> Iterator[str]:
    """Yield code examples that load the dataset."""
    yield "```python"
    yield "from datasets import load_dataset"
    yield f'load_dataset("NAME OR FOLDER OF THIS DATASET", "tasks")["{manifest.parts[0].name}"][0]["instruction"]'
    yield ""
    yield "from prag_asp import Dataset"
    yield 'dataset = Dataset.open("FOLDER")'
    yield "dataset.task(0), dataset.domain.name"
    yield "```"
    yield ""


def _title(manifest: Manifest, domain: Domain) -> str:
    return f"{domain.settings.title or domain.label}: {plural(manifest.rows('tasks'), 'task')}"


def _share(part: PartManifest) -> str:
    assert part.covered is not None
    return _percent(part.covered.value)


def _percent(share: float) -> str:
    return f"{100 * share:.3g} %"

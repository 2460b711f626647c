"""The card of a suite: README.md, with its exact figures."""

from __future__ import annotations

from collections.abc import Iterator

from prag_asp.dataset.pages.dataset_card import front_matter
from prag_asp.dataset.store.manifest import FOLDERS, rate_of
from prag_asp.dataset.suites.suite_manifest import SuiteManifest
from prag_asp.integers import grouped, number_of
from prag_asp.wording import plural

NAME = "README.md"


def card_text(note: SuiteManifest) -> bytes:
    """Return the card of a suite, which depends only on suite.json."""
    return "".join(f"{line}\n" for line in (*_front(note), *_text(note))).encode()


def _front(note: SuiteManifest) -> Iterator[str]:
    """Yield the front matter for hubs and loaders, with each part as a configuration."""
    yield from front_matter(note.title or note.name, "robotics", "task-planning", "benchmark", "prag_asp")
    yield "configs:"
    for part in note.parts:
        if part.tasks:
            yield f"- config_name: {part.name}"
            yield f"  data_files: {part.name}/{FOLDERS['tasks']}/*.parquet"
    yield "---"


def _text(note: SuiteManifest) -> Iterator[str]:
    """Yield the lines of the card after the front matter."""
    yield f"# {note.title or note.name}"
    yield ""
    if note.description:
        yield note.description
        yield ""
    yield "| part | what | lengths | tasks | of all tasks of the part | phrasings |"
    yield "|---|---|---|---|---|---|"
    for part in note.parts:
        share = f"{rate_of(100 * part.tasks, number_of(part.size)):.3g} % of {grouped(number_of(part.size))}"
        words = f"{part.language} {part.phrasings}".strip()
        lengths = " to ".join(dict.fromkeys([str(part.spaces[0].length), str(part.spaces[-1].length)]))
        link = f"[{part.name}]({part.name}/README.md)"
        yield f"| {link} | {part.about} | {lengths} | {part.tasks:,} | {share} | {words} |"
    yield ""
    yield "## Conditions"
    yield ""
    yield f"All tasks are of the domain `{note.domain}`. A task is a plan with its initial state."
    yield ""
    for part in note.parts:
        if part.of is not None:
            yield f"- **{part.name}** has the first tasks of {part.of}, with other phrasings."
        else:
            yield f"- **{part.name}**: {', '.join(f'`{clause}`' for clause in part.where) or 'no condition'}."
    yield ""
    yield "## Separation"
    yield ""
    yield from _apart(note)
    yield f"Written by {note.versions}. `suite.json` has the exact figures, and `suite.toml` defines the suite;"
    yield "`prag-asp verify` counts all tasks again."


def _apart(note: SuiteManifest) -> Iterator[str]:
    """Yield the numbers of shared tasks, and the table of held-out tasks."""
    none = sum(not each.tasks for each in note.shared)
    yield f"Exact counts: {none} of {plural(len(note.shared), 'pair')} of parts have no task in common."
    for each in note.shared:
        tasks = each.tasks
        if tasks:
            number = "1 task" if tasks == 1 else f"{grouped(tasks)} tasks"
            declared = "as declared" if each.declared else "which is not declared"
            yield f"{each.one} and {each.other} have {number} in common, {declared}."
    for part in note.parts:
        for other, distance in (part.distance or {}).items():
            yield f"Each task of {part.name} is at least {plural(distance, 'edit')} from all tasks of {other}."
    yield ""
    if note.unseen:
        yield "| held out | part | tasks of the part that contain it |"
        yield "|---|---|---|"
        for every in note.unseen:
            yield f"| `{every.what}` | {every.part} | {grouped(every.tasks)} |"
        yield ""

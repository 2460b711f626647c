"""``prag-asp verify``: errors in a dataset."""

from __future__ import annotations

from pathlib import Path

import click

from prag_asp.cli import options, shell_completion
from prag_asp.cli.commands.generate import warnings_as_lines
from prag_asp.cli.exits import Exit
from prag_asp.cli.options import whole
from prag_asp.cli.terminal import progress, say
from prag_asp.wording import plural


@click.command()
@click.argument("folder", metavar="DIR", shell_complete=shell_completion.files)
@options.trust
@click.option("--physics/--no-physics", default=True, help="Also check witnesses and episodes.  [default: physics]")
@click.option(
    "--workers", type=whole(1), default=1, show_default=True, help="Number of processes that check witnesses."
)
def verify(*, folder: str, trust: bool, physics: bool, workers: int) -> None:
    """Verify the contents of a dataset, a suite, or a split with --distance or --cover.

    Checks files, counts, plans, instructions and witnesses: tasks are sampled again with the seed, plans are checked by
    clingo, and witnesses are checked in a new simulation. Prints a line for each error, with its file and row (from 0);
    the exit code is 1 if there is an error.
    """
    from prag_asp.dataset.suites.suite_manifest import count_tasks
    from prag_asp.dataset.suites.verifying import verify as wrong
    from prag_asp.missing import require_pyarrow

    if (Path(folder) / "split.json").is_file():
        _verify_split(Path(folder), trust)
        return
    require_pyarrow()
    found = 0
    with progress() as tell, warnings_as_lines():
        for finding in wrong(folder, trust=trust, physics=physics, workers=workers, progress=tell):
            say(str(finding))
            found += 1
        tasks = count_tasks(folder)
    if found:
        raise click.exceptions.Exit(Exit.NOT_FOUND)
    say(f"{folder}: ok; {plural(tasks, 'task')}")


def _verify_split(folder: Path, trust: bool) -> None:
    from prag_asp.audit.distant_split import SPLIT, wrong_split

    findings = list(wrong_split(folder, trust=trust))
    for finding in findings:
        say(str(finding))
    if findings:
        raise click.exceptions.Exit(Exit.NOT_FOUND)
    note = SPLIT.read(folder)
    assert note is not None
    tasks, first = plural(sum(part.tasks for part in note.parts), "task"), note.parts[0].name
    edits = plural(note.distance, "edit")
    proofs = [f"every task outside {first} is at least {edits} from every task of {first}"] * (note.distance > 1)
    if note.combinations:
        held = plural(len(note.combinations), "larger combination")
        proofs.append(f"{first} covers all {note.reachable} combinations")
        proofs.append(f"{first} lacks {held}, and every other task contains at least one of them")
    say("; ".join([f"{folder}: ok", tasks, *proofs]))

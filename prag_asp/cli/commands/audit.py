"""``prag-asp audit``: the contents, overlaps and mistakes of suites of problems."""

from __future__ import annotations

import json
from pathlib import Path

import click

from prag_asp.cli import shell_completion
from prag_asp.cli.exits import Exit
from prag_asp.cli.terminal import progress, say, tell_line


@click.command()
@click.argument("folders", metavar="FOLDER...", nargs=-1, required=True, shell_complete=shell_completion.files)
@click.option(
    "--train", metavar="SUITE", multiple=True,
    help="Suite in which to search for nearest problems; may be repeated.  [default: all other suites]",
)  # fmt: skip
@click.option(
    "--reach/--no-reach", default=True,
    help="Load the domain of each task to find goals that no plan reaches.  [default: reach]",
)  # fmt: skip
@click.option("--full", is_flag=True, help="List all problems with the same goal, nearest problems and missing pairs.")
@click.option(
    "--format", "form", type=click.Choice(["text", "json"]), default="text", show_default=True, help="Tables, or JSON."
)
@click.option(
    "-o",
    "--output",
    metavar="FILE.html",
    shell_complete=shell_completion.files,
    help="Also write a page with all lists.",
)
def audit(
    *, folders: tuple[str, ...], train: tuple[str, ...], reach: bool, full: bool, form: str, output: str | None
) -> None:
    """Audit benchmarks: distinct tasks, overlaps, combinations, and mistakes.

    Each FOLDER is a suite of BDDL problems, a suite of PDDL problems with their domain, a prag-asp dataset, or a
    LeRobot dataset, whose instructions are looked up in the other suites. Two problems are the same task if renaming
    the objects of each class maps one to the other. The exit code is 1 if there are mistakes.
    """
    from prag_asp.audit import audit as audit_folders
    from prag_asp.audit.audit_report import audit_json, audit_page, audit_text
    from prag_asp.output import replace_file

    with progress() as tell:
        found = audit_folders(*folders, train=train, reach=reach, progress=tell)
    if output is not None:
        replace_file(Path(output), audit_page(found).encode())
        tell_line(f"wrote {output}")
    if form == "json":
        say(json.dumps(audit_json(found)))
    else:
        say("\n".join(audit_text(found, full=full)))
    if found.findings:
        raise click.exceptions.Exit(Exit.NOT_FOUND)

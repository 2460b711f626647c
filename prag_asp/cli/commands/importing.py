"""``prag-asp import``: a domain from PDDL files, or from BDDL problems."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

import click

from prag_asp.cli import shell_completion
from prag_asp.cli.terminal import say, tell_line
from prag_asp.errors import DomainError, OutputError, QueryError
from prag_asp.wording import plural

if TYPE_CHECKING:
    from prag_asp.pddl import Imported


@click.command("import")
@click.argument(
    "files", metavar="DOMAIN.pddl [PROBLEM.pddl] | FILE.bddl | FOLDER", nargs=-1, required=True,
    shell_complete=shell_completion.files,
)  # fmt: skip
@click.option(
    "--cost-factor",
    metavar="W",
    help="Turn action costs into weights: each unit of cost multiplies the weight of an action by W, such as 1/2.",
)
@click.option(
    "-o", "--output", metavar="DIR", required=True, shell_complete=shell_completion.files,
    help="New folder of the domain.",
)  # fmt: skip
@click.option("--untimed", is_flag=True, help="Read durative actions of PDDL as instantaneous ones.")
def import_(files: tuple[str, ...], cost_factor: str | None, output: str, untimed: bool) -> None:
    """Convert a PDDL domain and problem, or BDDL problems, into a domain in a new folder.

    Its tasks are the plans of the problem, of every length. One file of PDDL may contain both the domain and the
    problem. The other commands also accept PDDL directly.

    A FOLDER of BDDL problems becomes one domain; `-c problem=NAME` selects a problem by the name of its file.
    """
    from prag_asp.output import new_folder, replace_file

    folder = Path(output)
    if folder.exists():
        raise OutputError(f"{folder}: exists already; choose another name, or remove it first")
    if len(files) == 1 and (files[0].endswith(".bddl") or Path(files[0]).is_dir()):
        if cost_factor is not None or untimed:
            raise QueryError("--cost-factor and --untimed are about PDDL; leave them out")
        texts = _bddl_texts(files[0])
    else:
        texts = _pddl_texts(files, cost_factor, untimed=untimed)
    with new_folder(folder) as part:
        for file, text in texts.items():
            (part / file).parent.mkdir(exist_ok=True)
            replace_file(part / file, text.encode(), follow=False)
    tell_line(f"wrote {folder}; try: prag-asp check {folder}")


def _bddl_texts(path: str) -> dict[str, str]:
    """Return the contents of the files, by name, of the domain made from BDDL problems."""
    from prag_asp.bddl import read_suite

    suite = read_suite(path)
    for name in suite.names.values() if len(suite.names) > 1 else ():
        say(name)
    title, description = (json.dumps(text, ensure_ascii=False) for text in (Path(path).resolve().stem, suite.title))
    return {**suite.files(), "domain.toml": f"title = {title}\ndescription = {description}\n"}


def _pddl_texts(files: tuple[str, ...], cost_factor: str | None, *, untimed: bool) -> dict[str, str]:
    """Return the contents of the files, by name, of the domain made from PDDL files, and print warnings.

    Raises:
        QueryError: there are not two files, or one that contains both.
    """
    from prag_asp.pddl import read
    from prag_asp.pddl.syntax.sections import holds_both
    from prag_asp.program.problem import first_of_each

    if len(files) == 1 and files[0].endswith(".pddl") and holds_both(Path(files[0])):
        files *= 2
    if len(files) != 2:
        raise QueryError(f"{plural(len(files), 'file')}; give DOMAIN.pddl PROBLEM.pddl, FILE.bddl, or a folder of BDDL")
    imported = read(*files, untimed=untimed)
    for warning in first_of_each(imported.warnings):
        tell_line(str(warning))
    title = f'title = "{imported.name}"\ndescription = "Imported from PDDL."\n'
    table = "" if cost_factor is None else f"\n{_weights(imported, cost_factor)}"
    return {"domain.lp": imported.text, "domain.toml": title + table}


def _weights(imported: Imported, text: str) -> str:
    """Return the costs of all ground actions, converted to weights, as the text of a table.

    Raises:
        DomainError: no action has a cost, or the problem lacks the cost of an action.
        QueryError: the factor is invalid, or a weight has no finite decimal expansion.
    """
    from prag_asp.domain.load import load_domain
    from prag_asp.pddl.costs import factor_of, weight_of_cost, weights_table

    factor = factor_of(text)
    if not imported.has_costs:
        raise DomainError(f"{imported.name}: no action has a cost; leave --cost-factor out")
    weights = {}
    for action in load_domain(text=imported.text).facts.actions:
        cost = imported.cost(action.name, [str(each) for each in action.arguments])
        if cost:
            weights[str(action)] = weight_of_cost(factor, cost)
    tell_line(f"costs of {plural(len(weights), 'action')} became weights")
    return weights_table(weights)

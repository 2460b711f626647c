"""``prag-asp import``: a domain from two PDDL files."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from prag_asp.cli import shell_completion
from prag_asp.cli.terminal import tell_line
from prag_asp.errors import DomainError, OutputError
from prag_asp.wording import plural

if TYPE_CHECKING:
    from prag_asp.pddl import Imported


@click.command("import")
@click.argument("domain", metavar="DOMAIN.pddl", shell_complete=shell_completion.files)
@click.argument("problem", metavar="PROBLEM.pddl", shell_complete=shell_completion.files)
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
def import_(domain: str, problem: str, cost_factor: str | None, output: str, untimed: bool) -> None:
    """Convert a PDDL domain and problem into a domain in a new folder.

    Its tasks are the plans of the problem, of every length. The other commands also accept the two PDDL files directly.
    """
    from prag_asp.output import new_folder, replace_file
    from prag_asp.pddl import read
    from prag_asp.program.problem import first_of_each

    folder = Path(output)
    if folder.exists():
        raise OutputError(f"{folder}: exists already; choose another name, or remove it first")
    imported = read(domain, problem, untimed=untimed)
    for warning in first_of_each(imported.warnings):
        tell_line(str(warning))
    title = f'title = "{imported.name}"\ndescription = "Imported from PDDL."\n'
    table = "" if cost_factor is None else f"\n{_weights(imported, cost_factor)}"
    texts = {"domain.lp": imported.text, "domain.toml": title + table}
    with new_folder(folder) as part:
        for file, text in texts.items():
            replace_file(part / file, text.encode(), follow=False)
    tell_line(f"wrote {folder}; try: prag-asp check {folder}")


def _weights(imported: Imported, text: str) -> str:
    """Return the costs of all ground actions as the text of a table of weights.

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

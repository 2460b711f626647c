"""``prag-asp import``: a domain of its own from two files of PDDL."""

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
    help="Make costs weights: each unit multiplies the weight of an action by W, such as 1/2.",
)
@click.option(
    "-o", "--output", metavar="DIR", required=True, shell_complete=shell_completion.files,
    help="New folder of the domain, written whole or not at all.",
)  # fmt: skip
def import_(domain: str, problem: str, cost_factor: str | None, output: str) -> None:
    """Write a domain and a problem of PDDL as a domain into the new folder DIR.

    It has the plans of the problem, of every length. The other commands take the two files themselves, too.
    """
    from prag_asp.output import new_folder, replace_file
    from prag_asp.pddl import read

    folder = Path(output)
    if folder.exists():
        raise OutputError(f"{folder}: exists already; choose another name, or remove it first")
    found = read(domain, problem)
    title = f'title = "{found.name}"\ndescription = "Imported from PDDL."\n'
    table = "" if cost_factor is None else f"\n{_weights(found, cost_factor)}"
    texts = {"domain.lp": found.text, "domain.toml": title + table}
    with new_folder(folder) as part:
        for file, text in texts.items():
            replace_file(part / file, text.encode(), follow=False)
    tell_line(f"wrote {folder}; try: prag-asp check {folder}")


def _weights(found: Imported, given: str) -> str:
    """Return the costs of all ground actions as a table of weights.

    Raises:
        DomainError: no action has a cost, or one has none in the problem.
        QueryError: the factor is none, or a weight has no end as a decimal.
    """
    from prag_asp.domain.load import load_domain
    from prag_asp.pddl.costs import factor_of, weight_of_cost, weights_table

    factor = factor_of(given)
    if not found.has_costs:
        raise DomainError(f"{found.name}: no action has a cost; leave --cost-factor out")
    weights = {}
    for action in load_domain(text=found.text).facts.actions:
        cost = found.cost(action.name, [str(each) for each in action.arguments])
        if cost:
            weights[str(action)] = weight_of_cost(factor, cost)
    tell_line(f"costs of {plural(len(weights), 'action')} became weights")
    return weights_table(weights)

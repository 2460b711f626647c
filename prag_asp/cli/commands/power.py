"""``prag-asp power``: the number of scenarios that a claim about two policies needs, and the effect that N can show."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

import click

from prag_asp.cli.options import whole
from prag_asp.cli.terminal import aligned, say
from prag_asp.errors import QueryError


@click.command()
@click.option("--effect", metavar="E", help="Difference between the two success rates, such as 0.05.")
@click.option("--scenarios", type=whole(1), metavar="N", help="Number of scenarios in which each policy runs.")
@click.option("--power", metavar="P", default="0.8", show_default=True, help="Probability of finding the effect.")
@click.option("--rate", metavar="P", default="0.5", show_default=True, help="Success rate of the first policy.")
@click.option("--alpha", metavar="A", default="0.05", show_default=True, help="Two-sided significance level.")
@click.option(
    "--paired",
    "correlation",
    metavar="RHO",
    help="Correlation of the results, if both policies run in the same scenarios.",
)
@click.option(
    "--discordant",
    metavar="D",
    help="Share of scenarios in which only one policy succeeds, if both run in the same scenarios.",
)
@click.option("--of", "tasks", type=whole(1), metavar="N", help="Scenarios are distinct tasks from a space of N tasks.")
@click.option(
    "--format", "form", type=click.Choice(["text", "json"]), default="text", show_default=True, help="A table, or JSON."
)
def power(
    *, effect: str | None, scenarios: int | None, power: str, rate: str, alpha: str, correlation: str | None,
    discordant: str | None, tasks: int | None, form: str,
) -> None:  # fmt: skip
    """Compute how many scenarios a claim needs, or which effect they can show.

    The claim is that one policy succeeds more often than another. With --effect, prints the number of scenarios that
    each policy needs; with --scenarios, the smallest effect that they can show, and the half-width of Wilson's
    interval; with both, also the power. The power is computed exactly: that of McNemar's exact test if both policies
    run in the same scenarios (--paired or --discordant), otherwise that of Fisher's exact test.
    """
    from prag_asp.evaluation.power import ComparisonDesign

    if effect is None and scenarios is None:
        raise QueryError("nothing to compute; give --effect E for the scenarios it needs, or --scenarios N")
    design = ComparisonDesign(rate, alpha, correlation, discordant, tasks)
    found: dict[str, Any] = {"test": design.test}
    if effect is not None and scenarios is not None:
        found["power"] = design.power(scenarios, effect)
    elif effect is not None:
        found["scenarios"] = needed = design.scenarios(effect, power)
        found["power"] = design.power(needed, effect)
    if scenarios is not None:
        smallest = design.smallest_effect(scenarios, power)
        found["smallest_effect"] = None if smallest is None else float(smallest)
        found["half_width"] = design.half_width(scenarios)
    if form == "json":
        say(json.dumps(found))
    else:
        say("\n".join(aligned(_rows(found, power))))


def _rows(found: dict[str, Any], power: str) -> Iterator[tuple[str, str]]:
    """Yield the rows of the table of results."""
    names = {
        "test": "test, two-sided",
        "scenarios": "scenarios for each policy",
        "power": "power",
        "smallest_effect": f"smallest effect with power {power}",
        "half_width": "half-width of Wilson's interval",
    }
    for key, value in found.items():
        yield names[key], "none" if value is None else f"{value:.4f}" if isinstance(value, float) else str(value)

"""``prag-asp stats``: exact statistics of random tasks, and the plot of counts by length."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from decimal import MAX_EMAX, MIN_EMIN, Context, Decimal, localcontext
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import click

from prag_asp.cli import options, shell_completion
from prag_asp.cli.domain_options import SPACE, DomainOptions, domain_options
from prag_asp.cli.line_output import require_writable, writer
from prag_asp.cli.options import WeightOptions
from prag_asp.cli.terminal import aligned, progress

if TYPE_CHECKING:
    from prag_asp.space.sampling.statistics import Statistics

DIGITS = 6
"""Decimal places of shares and of expected numbers in text."""

WIDEST = 40
"""The maximum number of characters of a whole number that is printed in full as text."""


@click.command()
@domain_options(*SPACE)
@options.by_level
@options.weight_options
@click.option(
    "--format",
    "form",
    type=click.Choice(["text", "json"]),
    default="text",
    show_default=True,
    help="Tables with decimals, or JSON with exact fractions.",
)
@click.option(
    "--plot", metavar="FILE", shell_complete=shell_completion.files,
    help="Plot the counts of all lengths up to N into FILE (.html, .png, .svg or .pdf).",
)  # fmt: skip
@options.output
def stats(
    *, request: DomainOptions, by: Any, weighting: WeightOptions, form: str, plot: str | None, output: str | None
) -> None:
    """Print exact statistics of a random task of length N.

    These are the entropy, the expected number of occurrences of each action, and the probability that a task contains
    it.
    """
    require_writable(output)
    if plot:
        from prag_asp.analysis.plots.curve import check_file

        check_file(plot)
        require_writable(plot)
    with progress() as tell:
        space = request.space(tell)
        found = space.statistics(by=by, **weighting.arguments(space.domain))
        with writer(output) as out:
            for line in _text(found) if form == "text" else _json(found):
                out.write(line)
        if plot:
            from prag_asp.analysis.plots.curve import counts_by_length, draw_curve

            draw_curve(counts_by_length(space), plot)


def _json(found: Statistics) -> Iterator[str]:
    import json
    from dataclasses import asdict

    values = {
        name: {key if isinstance(key, str) else ">".join(key): str(share) for key, share in value.items()}
        if isinstance(value, dict)
        else value if isinstance(value, (int, str))
        else str(value)
        for name, value in asdict(found).items()
    }  # fmt: skip
    yield json.dumps(values, indent=2)


def _text(found: Statistics) -> Iterator[str]:
    yield from aligned(
        [
            (f"{found.by}s of length {found.length} that can be sampled", _whole(found.words)),
            ("sum of their weights", _whole(found.total_weight)),
            ("entropy, bits", f"{found.entropy:.12f}"),
        ]
    )
    entities, classes = found.contains_entity, found.contains_class
    pairs = {f"{one} > {two}": share for (one, two), share in found.expected_pairs.items()}
    tables: list[tuple[str, Mapping[str, Fraction], Mapping[str, Fraction] | None]] = [
        ("name", found.expected_names, found.contains_name),
        ("pair of names", pairs, None),
        ("action", found.expected_actions, found.contains_action),
    ]
    for title, expected, contains in tables:
        if expected:
            yield ""
            heads = (title, "expected number", "probability") if contains is not None else (title, "expected number")
            columns = [expected] if contains is None else [expected, contains]
            yield from aligned([heads, *((key, *(_decimal(each[key]) for each in columns)) for key in expected)])
    for title, shares in (("entity", entities), ("class", classes)):
        if shares:
            yield ""
            yield from aligned([(title, "probability"), *((key, _decimal(share)) for key, share in shares.items())])


def _decimal(share: Fraction) -> str:
    """Return a fraction as a decimal number whose last digit is rounded half to even."""
    whole = round(share * 10**DIGITS)
    return f"{whole // 10**DIGITS}.{whole % 10**DIGITS:0{DIGITS}d}"


def _whole(number: int | Fraction) -> str:
    """Return a number in full if it is short, or otherwise with seven digits and a power of ten."""
    text = str(number)
    if len(text) <= WIDEST:
        return text
    with localcontext(Context(prec=DIGITS + 1, Emax=MAX_EMAX, Emin=MIN_EMIN)):
        exact = Fraction(number)
        return f"{Decimal(exact.numerator) / Decimal(exact.denominator):.{DIGITS}e}"

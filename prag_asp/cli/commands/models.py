"""``prag-asp models``: the answer sets of any logic program."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from fractions import Fraction
from itertools import islice
from typing import TYPE_CHECKING

import click

from prag_asp.cli import options, shell_completion
from prag_asp.cli.domain_options import given, parse_constant_options
from prag_asp.cli.options import Approximation, Function, bundled
from prag_asp.cli.terminal import progress, say, tell_line
from prag_asp.errors import QueryError
from prag_asp.integers import digits_of
from prag_asp.models import ENGINES

if TYPE_CHECKING:
    from prag_asp.models.answer_sets import AnswerSet, AnswerSets

ASKED = (
    click.argument("files", metavar="FILE...", nargs=-1, required=True, shell_complete=shell_completion.files),
    click.option(
        "-c", "--const", "constants", metavar="NAME=VALUE", multiple=True, help="Value of a constant, such as n=8."
    ),
    click.option(
        "--project", is_flag=True,
        help="Take answer sets for one that agree on the atoms of #project, or else on what is shown.",
    ),
    click.option("--weighted", is_flag=True, help="Weigh answer sets by facts such as weight(in(1),2)."),
    click.option(
        "--engine", type=click.Choice(ENGINES), default="auto", show_default=True,
        help="A counter, which counts alone; a compiled diagram; clingo's enumeration; or what fits.",
    ),
)  # fmt: skip


@dataclass(frozen=True)
class AskedModels:
    """The program that a command line gives, and how its answer sets are taken."""

    files: tuple[str, ...]
    constants: tuple[str, ...]
    project: bool
    weighted: bool
    engine: str

    @contextmanager
    def answer_sets(self) -> Iterator[AnswerSets]:
        """Yield them; notes become lines on stderr, and what lasts is shown."""
        from prag_asp.models.answer_sets import answer_sets

        with progress() as tell:
            yield answer_sets(
                *map(given, self.files),
                constants=parse_constant_options(self.constants),
                project=self.project,
                weighted=self.weighted,
                engine=self.engine,
                tell=lambda line: tell_line(f"note: {line}"),
                progress=tell,
            )


def _asks(function: Function) -> Function:
    return bundled(function, "asked", AskedModels, ASKED)


@click.group(subcommand_metavar="COMMAND ...")
def models() -> None:
    """Count, draw or list the answer sets of any logic program, exactly.

    FILE is a program of clingo, or - for standard input; several are one program. What optimises is refused, and so
    are theories and scripts; an #external is false, as clingo takes it.
    """


@models.command()
@_asks
@options.approximation
def count(*, asked: AskedModels, approximation: Approximation) -> None:
    """Print the exact number of answer sets; with --weighted, the exact sum of their weights.

    With --approximate, prints about how many there are, with bounds that hold with a probability that is told.
    """
    estimate = approximation.asked(asked.engine)
    if estimate is not None and asked.weighted:
        raise QueryError("--approximate: it estimates numbers, not weights; leave out --weighted")
    with asked.answer_sets() as found:
        if estimate is not None:
            say(str(found.estimate(**estimate)))
            return
        say(_spelled(found.total()) if asked.weighted else digits_of(found.count()))


@models.command()
@_asks
@click.option("--count", "wanted", type=options.whole(0), default=10, show_default=True, help="How many answer sets.")
@options.seed
def sample(*, asked: AskedModels, wanted: int, seed: int) -> None:
    """Print answer sets drawn with the same probability each, exactly; with --weighted, in proportion to their weights.

    A line has what is shown of one. The same seed gives the same lines.
    """
    with asked.answer_sets() as found:
        _say_all(islice(found.sample(wanted, seed), wanted))


@models.command(name="list")
@_asks
@click.option("--count", "wanted", type=options.whole(0), metavar="K", help="Stop after K answer sets.")
def list_(*, asked: AskedModels, wanted: int | None) -> None:
    """Print all answer sets, one a line, in an order that is always the same."""
    with asked.answer_sets() as found:
        _say_all(islice(found, wanted))


@models.command()
@_asks
def marginals(*, asked: AskedModels) -> None:
    """Print for each shown atom the exact share of answer sets that have it; with --weighted, by their weights."""
    with asked.answer_sets() as found:
        for symbol, share in found.marginals().items():
            say(f"{_spelled(share)}  {symbol}")


def _say_all(found: Iterator[AnswerSet]) -> None:
    for each in found:
        say(" ".join(map(str, each)))


def _spelled(number: Fraction) -> str:
    """Return a fraction in digits, however many."""
    over = digits_of(number.numerator)
    return over if number.denominator == 1 else f"{over}/{digits_of(number.denominator)}"

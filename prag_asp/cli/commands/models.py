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
from prag_asp.cli.arguments import parse_constant_options
from prag_asp.cli.domain_options import source_of
from prag_asp.cli.options import Approximation, grouped, whole
from prag_asp.cli.terminal import progress, say, tell_line
from prag_asp.errors import QueryError
from prag_asp.integers import digits_of
from prag_asp.models import ENGINES

if TYPE_CHECKING:
    from prag_asp.models.answer_sets import AnswerSet, AnswerSets


@dataclass(frozen=True)
class ProgramOptions:
    """The program that a command line gives, and how its answer sets are counted."""

    files: tuple[str, ...]
    constants: tuple[str, ...]
    project: bool
    weighted: bool
    engine: str

    @contextmanager
    def answer_sets(self) -> Iterator[AnswerSets]:
        """Yield the answer sets; notes and progress go to stderr."""
        from prag_asp.models.answer_sets import answer_sets

        with progress() as tell:
            found = answer_sets(
                *map(source_of, self.files),
                constants=parse_constant_options(self.constants),
                project=self.project,
                weighted=self.weighted,
                engine=self.engine,
                tell=lambda line: tell_line(f"note: {line}"),
                progress=tell,
            )
            for line in found.ground.remarks:
                tell_line(line)
            yield found


program_options = grouped(
    "program", ProgramOptions,
    (
        click.argument("files", metavar="FILE...", nargs=-1, required=True, shell_complete=shell_completion.files),
        click.option(
            "-c", "--const", "constants", metavar="NAME=VALUE", multiple=True, help="Value of a constant, such as n=8."
        ),
        click.option(
            "--project", is_flag=True,
            help="Count answer sets that agree on the atoms of #project once; without #project, on the shown atoms.",
        ),
        click.option("--weighted", is_flag=True, help="Weigh answer sets by facts such as weight(in(1),2)."),
        click.option(
            "--engine", type=click.Choice(ENGINES), default="auto", show_default=True,
            help="ganak, a model counter (count only); diagram, a compiled decision diagram; clingo, enumeration; or "
            "auto, the best of them for the program, by limits of work.",
        ),
    ),
)  # fmt: skip
"""Give a command the options of a program, as one value `program`."""


@click.group(subcommand_metavar="COMMAND ...")
def models() -> None:
    """Count, sample or list the answer sets of any logic program.

    FILE is a clingo program, or - for standard input; several files are one program. Optimization statements, theories
    and scripts are not supported. An #external is false, as in clingo.
    """


@models.command()
@program_options
@options.approximation
def count(*, program: ProgramOptions, approximation: Approximation) -> None:
    """Count the answer sets exactly.

    With --weighted, prints the exact sum of their weights. With --approximate, prints an estimate with its bounds, and
    the probability with which these hold.
    """
    estimate = approximation.arguments(program.engine)
    if estimate is not None and program.weighted:
        raise QueryError("--approximate estimates numbers, not weights; leave out --weighted")
    with program.answer_sets() as found:
        if estimate is not None:
            say(str(found.estimate(**estimate)))
            return
        say(_spelled(found.total()) if program.weighted else digits_of(found.count()))


@models.command()
@program_options
@click.option("--count", "number", type=whole(0), default=10, show_default=True, help="Number of answer sets.")
@options.seed
def sample(*, program: ProgramOptions, number: int, seed: int) -> None:
    """Sample answer sets uniformly.

    With --weighted, samples them in proportion to their weights. Probabilities are exact. Each line has the shown atoms
    of an answer set. The same seed gives the same lines.
    """
    with program.answer_sets() as found:
        _say_all(islice(found.sample(number, seed), number))


@models.command(name="list")
@program_options
@click.option("--count", "number", type=whole(0), metavar="K", help="Stop after K answer sets.")
def list_(*, program: ProgramOptions, number: int | None) -> None:
    """List all answer sets, one per line, always in the same order."""
    with program.answer_sets() as found:
        _say_all(islice(found, number))


@models.command()
@program_options
def marginals(*, program: ProgramOptions) -> None:
    """Print for each shown atom the share of answer sets that contain it.

    Shares are exact. With --weighted, they are shares of the total weight.
    """
    with program.answer_sets() as found:
        for symbol, share in found.marginals().items():
            say(f"{_spelled(share)}  {symbol}")


def _say_all(found: Iterator[AnswerSet]) -> None:
    for each in found:
        say(" ".join(map(str, each)))


def _spelled(number: Fraction) -> str:
    """Return a fraction in digits, of any number."""
    over = digits_of(number.numerator)
    return over if number.denominator == 1 else f"{over}/{digits_of(number.denominator)}"

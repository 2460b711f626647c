"""``prag-asp models``: the answer sets of any logic program."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from fractions import Fraction
from itertools import chain, islice, pairwise
from typing import TYPE_CHECKING

import click

from prag_asp.cli import options, shell_completion
from prag_asp.cli.arguments import parse_constant_options
from prag_asp.cli.domain_options import source_of
from prag_asp.cli.exits import Exit
from prag_asp.cli.options import Approximation, grouped, whole
from prag_asp.cli.registry import WholeSentences
from prag_asp.cli.terminal import aligned, progress, say, tell_line
from prag_asp.errors import QueryError
from prag_asp.integers import digits_of
from prag_asp.models import ENGINES

if TYPE_CHECKING:
    from prag_asp.models.answer_sets import AnswerSet, AnswerSets
    from prag_asp.models.questions.facets import Facet


@dataclass(frozen=True)
class ProgramOptions:
    """The program given on a command line, and the options for counting its answer sets."""

    files: tuple[str, ...]
    constants: tuple[str, ...]
    project: bool
    weighted: bool
    optimal: bool
    engine: str
    where: tuple[str, ...]

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
                optimal=self.optimal,
                engine=self.engine,
                tell=lambda line: tell_line(f"note: {line}"),
                progress=tell,
            )
            for line in found.ground.remarks:
                tell_line(line)
            yield found.where(*self.where)


constant_option = click.option(
    "-c", "--const", "constants", metavar="NAME=VALUE", multiple=True, help="Value of a constant, such as n=8."
)

where_option = click.option(
    "--where", metavar="LITERAL", multiple=True,
    help="Only answer sets that contain a shown atom ('in(1)') or do not contain it ('not in(1)'); may be repeated.",
)  # fmt: skip

program_options = grouped(
    "program", ProgramOptions,
    (
        click.argument("files", metavar="FILE...", nargs=-1, required=True, shell_complete=shell_completion.files),
        constant_option,
        click.option(
            "--project", is_flag=True,
            help="Count answer sets that agree on the atoms of #project once; without #project, those that agree on "
            "the shown atoms.",
        ),
        click.option("--weighted", is_flag=True, help="Weight answer sets by facts such as weight(in(1),2)."),
        click.option(
            "--optimal", is_flag=True,
            help="Use only the answer sets that are optimal for #minimize, #maximize and weak constraints.",
        ),
        click.option(
            "--engine", type=click.Choice(ENGINES), default="auto", show_default=True,
            help="ganak or d4, model counters (count only); diagram, a compiled decision diagram; clingo, enumeration; "
            "or auto, which tries several of them.",
        ),
        where_option,
    ),
)  # fmt: skip
"""The decorator that gives a command the options of a program, as a single value `program`."""

format_option = click.option(
    "--format", "form", type=click.Choice(["text", "json"]), default="text", show_default=True,
    help="Lines of text, or one JSON object; fractions are strings.",
)  # fmt: skip


FACETS_HEADER = ("atom", "share", "answer sets +", "answer sets -", "facets +", "facets -")


@click.group(cls=WholeSentences, subcommand_metavar="COMMAND ...")
def models() -> None:
    """Count, sample or list the answer sets of any logic program.

    FILE is a clingo program, or - for standard input; several files are one program. A single file may be ground, in
    aspif. Optimization statements need --optimal; theories and scripts are not supported. An #external is false, as in
    clingo.
    """


@models.command()
@program_options
@options.approximation
@format_option
def count(*, program: ProgramOptions, approximation: Approximation, form: str) -> None:
    """Count the answer sets exactly.

    With --weighted, prints the exact sum of their weights. With --approximate, prints an estimate with its bounds, and
    the probability with which these hold.
    """
    estimate = approximation.arguments(program.engine)
    if estimate is not None and program.weighted:
        raise QueryError("--approximate estimates numbers, not weights; leave out --weighted")
    with program.answer_sets() as found:
        if estimate is not None:
            about = found.estimate(**estimate)
            fields = {
                "about": digits_of(about.about),
                "epsilon": json.dumps(about.tolerance.epsilon),
                "delta": json.dumps(about.tolerance.delta),
            }
            say(_document(found, fields) if form == "json" else str(about))
            return
        number = _spelled(found.total()) if program.weighted else digits_of(found.count())
        fields = {"total_weight": json.dumps(number)} if program.weighted else {"count": number}
        say(_document(found, fields) if form == "json" else number)


@models.command()
@program_options
@click.option(
    "-n", "--count", "number", type=whole(0), default=10, metavar="K", show_default=True, help="Number of answer sets."
)
@options.seed
@format_option
def sample(*, program: ProgramOptions, number: int, seed: int, form: str) -> None:
    """Sample answer sets uniformly.

    With --weighted, samples them in proportion to their weights. Probabilities are exact. Each line lists the shown
    atoms of an answer set. The same seed gives the same lines.
    """
    with program.answer_sets() as found:
        _say_all(found, islice(found.sample(number, seed), number), form)


@models.command(name="list")
@program_options
@click.option("-n", "--count", "number", type=whole(0), metavar="K", help="Stop after K answer sets.")
@format_option
def list_(*, program: ProgramOptions, number: int | None, form: str) -> None:
    """List all answer sets, one per line, always in the same order."""
    with program.answer_sets() as found:
        _say_all(found, islice(found, number), form)


@models.command()
@program_options
@format_option
def marginals(*, program: ProgramOptions, form: str) -> None:
    """Print what share of the answer sets contains each shown atom.

    Shares are exact. With --weighted, they are shares of the total weight.
    """
    with program.answer_sets() as found:
        shares = {str(symbol): _spelled(share) for symbol, share in found.marginals().items()}
        if form == "json":
            rows = ",\n".join(f"  {json.dumps(symbol)}: {json.dumps(share)}" for symbol, share in shares.items())
            say(_document(found, {"marginals": f"{{\n{rows}\n }}"}))
            return
        for symbol, share in shares.items():
            say(f"{share}  {symbol}")


@models.command()
@program_options
@format_option
def facets(*, program: ProgramOptions, form: str) -> None:
    """Print the facets among the shown atoms, with their significance.

    A facet is an atom that some answer sets contain and others do not. For each shown atom, prints the exact share of
    the answer sets that contain it; for a facet, also the shares by which the numbers of answer sets and of facets
    shrink if it is chosen (+) or excluded (-).
    """
    with program.answer_sets() as found:
        atoms = found.facets().items()
        if form == "json":
            rows = ",\n".join(f"  {json.dumps(str(symbol))}: {_facet_object(facet)}" for symbol, facet in atoms)
            say(_document(found, {"facets": f"{{\n{rows}\n }}"}))
            return
        rows_of_text = ((str(symbol), _spelled(facet.share), *_cells(facet)) for symbol, facet in atoms)
        for line in aligned([FACETS_HEADER, *rows_of_text]):
            say(line)


@models.command()
@click.argument("files", metavar="FILE...", nargs=-1, required=True, shell_complete=shell_completion.files)
@constant_option
@where_option
@format_option
def explain(*, files: tuple[str, ...], constants: tuple[str, ...], where: tuple[str, ...], form: str) -> None:
    """Explain why a program has no answer set.

    Prints a set of lines of the program that together exclude every answer set, while no proper subset does: relaxing
    any one of them (a constraint is dropped; a rule only allows its head) leaves an answer set. The exit code is 1 if
    there is no answer set, otherwise 0. Rules of a ground program are printed in clingo's language.
    """
    from prag_asp.models.questions.conflict import explain_program

    with progress():
        found = explain_program([source_of(file) for file in files], parse_constant_options(constants), where)
    lines = () if found is None else found.lines
    if form == "json":
        minimal = None if found is None else found.minimal
        listed = [{"file": str(each.path), "line": each.line, "text": each.text} for each in lines]
        say(json.dumps({"satisfiable": found is None, "lines": listed, "minimal": minimal}, indent=1))
    elif found is None:
        say("there is an answer set")
    else:
        parts = "" if found.minimal else ", and perhaps fewer do"
        say(f"these lines together exclude every answer set{parts}:")
        for each in lines:
            say(f"  {each}")
    if found is not None:
        raise click.exceptions.Exit(Exit.NOT_FOUND)


def _say_all(found: AnswerSets, listed: Iterator[AnswerSet], form: str) -> None:
    if form == "text":
        for each in listed:
            say(" ".join(map(str, each)))
        return
    first = next(listed, None)  # an error precedes any output
    say(_document(found, {"answer_sets": "["}).removesuffix("\n}"))
    texts = (json.dumps([str(symbol) for symbol in each]) for each in chain([] if first is None else [first], listed))
    for text, following in pairwise(chain(texts, [None])):
        say(f"  {text}{'' if following is None else ','}")
    say(" ]\n}")


def _document(found: AnswerSets, fields: Mapping[str, str]) -> str:
    """Return a JSON object with the optimum and other fields, which are JSON text because numbers may have any size."""
    if found.optimum is not None:
        values = [{"priority": priority, "value": value} for priority, value in found.optimum.values]
        fields = {"optimum": json.dumps(values), **fields}
    lines = [f' "{name}": {value}' for name, value in fields.items()]
    return "{\n" + ",\n".join(lines) + "\n}"


def _facet_object(facet: Facet) -> str:
    """Return as JSON the share of an atom, and what remains after choosing or excluding the atom."""
    objects = [
        f'{{"answer_sets": {digits_of(each.answer_sets)}, "facets": {each.facets}, '
        f'"of_answer_sets": "{_spelled(each.of_answer_sets)}", "of_facets": "{_spelled(each.of_facets)}"}}'
        if each is not None
        else "null"
        for each in (facet.chosen, facet.excluded)
    ]
    flag = json.dumps(facet.is_facet)
    return f'{{"share": "{_spelled(facet.share)}", "facet": {flag}, "chosen": {objects[0]}, "excluded": {objects[1]}}}'


def _cells(facet: Facet) -> list[str]:
    """Return the cells that follow the share in an atom's row in the table of facets."""
    both = (facet.chosen, facet.excluded)
    shrunk = [each and (each.of_answer_sets, each.of_facets) for each in both]
    return [_spelled(each[place]) if each else "-" for place in (0, 1) for each in shrunk]


def _spelled(number: Fraction) -> str:
    """Return a fraction as decimal integers of any size, such as ``1/3``."""
    over = digits_of(number.numerator)
    return over if number.denominator == 1 else f"{over}/{digits_of(number.denominator)}"

"""The reader of the files of a logic program, which refuses unsupported statements, each with its line."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import clingo
from clingo.ast import ASTType

from prag_asp.errors import DomainError
from prag_asp.models.aspif import MINIMIZE, aspif_problems, aspif_text, is_aspif
from prag_asp.models.recursive_heads import recursive_head_problems
from prag_asp.program.constants import Constant, parse_constants, set_constants
from prag_asp.program.grounding import Grounder
from prag_asp.program.parse import parse_sources
from prag_asp.program.problem import Problem, raise_problems
from prag_asp.program.sources import Program, Source, read_sources
from prag_asp.program.syntax import Statement, below
from prag_asp.program.tokens import blanked
from prag_asp.wording import did_you_mean

REFUSED: Mapping[ASTType, tuple[str, str]] = {
    ASTType.Minimize: ("it optimises", "add --optimal to keep only optimal answer sets, or bound the cost with #sum"),
    ASTType.TheoryDefinition: ("clingo alone does not interpret theories", "leave it out"),
    ASTType.Script: ("a script is not run", "state by rules or facts what it computes"),
}
"""The statements that are refused, each with the problem and the remedy."""

NAMES = {ASTType.Minimize: "a weak constraint or #minimize", ASTType.Script: "#script"}


@dataclass(frozen=True)
class GivenProgram:
    """The files of a program, and the constants that none of them declares, as clingo options."""

    program: Program
    arguments: tuple[str, ...]

    def grounder(self, *arguments: str, observer: clingo.Observer | None = None) -> Grounder:
        """Return a grounder for the program, with additional clingo arguments and an observer."""
        source = self.program.sources[0]
        text = aspif_text(source) if is_aspif(source) else None
        return Grounder(self.program, *self.arguments, *arguments, strict=False, text=text, observer=observer)


def read_program(
    files: Sequence[str | Path | Source], constants: Mapping[str, Constant], *, optimal: bool = False
) -> GivenProgram:
    """Read a program from files, with values for constants; an aspif file must be the only file.

    Minimize statements are refused unless `optimal`.

    Raises:
        DomainError: a file cannot be read or parsed, a statement is not supported, or a constant is not used.
    """
    entries = [file if isinstance(file, Source) else Path(file) for file in dict.fromkeys(files)]
    if not entries:
        raise DomainError("no program; give one or more files, such as queens.lp")
    by_path: dict[Path, Source] = {}
    for entry in entries:
        folder = (entry.path if isinstance(entry, Source) else entry).parent
        by_path.update({source.path.resolve(): source for source in read_sources(entry, folder)})
    sources = tuple(by_path.values())
    if any(map(is_aspif, sources)):
        return _ground_program(sources, constants, optimal=optimal)
    statements, problems = parse_sources((source, True) for source in sources)
    suspects = {source.path for source in sources if re.search("[&@]", blanked(source.text))}
    refusals = _refusals(statements, suspects, optimal=optimal)
    raise_problems([*problems, *refusals, *recursive_head_problems(statements)])
    values = parse_constants(constants)
    declared = {statement.node.name for statement in statements if statement.kind == ASTType.Definition}
    paths = " ".join(str(source.path) for source in sources)
    sources = set_constants(sources, {name: text for name, text in values.items() if name in declared}, paths)
    return GivenProgram(Program(sources), tuple(_options(statements, values, declared)))


def _options(statements: Sequence[Statement], values: Mapping[str, str], declared: set[str]) -> Iterator[str]:
    """Yield clingo's options for the constants that no statement declares; each of them must occur as a term."""
    read: set[str] = set()  # constants that occur as terms, without predicates and functions
    if not declared.issuperset(values):
        nodes = (node for statement in statements for node in below(statement.node))
        symbols = (node.symbol for node in nodes if node.ast_type == ASTType.SymbolicTerm)
        read = {each.name for each in symbols if each.type == clingo.SymbolType.Function and not each.arguments}
    for name, text in values.items():
        if name in declared:
            continue
        if name not in read:
            hint = did_you_mean(name, declared, "leave it out, or write the name where it is read")
            raise DomainError(f"constant {name}: nothing in the program reads it; {hint}")
        yield f"-c{name}={text}"


def places_of_costs(program: Program) -> Iterator[str]:
    """Yield the place ``file:line:`` of each minimize statement."""
    for source in program.sources:
        if is_aspif(source):
            lines = enumerate(source.text.split("\n"), 1)
            yield from (f"{source.path}:{number}:" for number, line in lines if line.startswith(f"{MINIMIZE} "))
        else:
            statements, _ = parse_sources([(source, True)])
            costs = (each for each in statements if each.kind == ASTType.Minimize)
            yield from (f"{each.path}:{each.line}:" for each in costs)


def _ground_program(sources: Sequence[Source], constants: Mapping[str, Constant], *, optimal: bool) -> GivenProgram:
    """Return the program in an aspif file.

    Raises:
        DomainError: the file is malformed, or other files or constants are given.
    """
    source = next(filter(is_aspif, sources))
    if len(sources) > 1:
        raise DomainError(f"{source.path}:1: a ground program in aspif has to be the only file; leave the others out")
    for name in constants:
        raise DomainError(f"constant {name}: {source.path} is already ground; set it where the program is grounded")
    raise_problems(aspif_problems(source, optimal=optimal))
    return GivenProgram(Program((source,)), ())


def _refusals(statements: Sequence[Statement], suspects: Collection[Path], *, optimal: bool) -> Iterator[Problem]:
    """Yield unsupported statements; terms are searched only for `suspects`, because the search is slow."""
    for statement in statements:
        if statement.kind in REFUSED and not (optimal and statement.kind == ASTType.Minimize):
            wrong, todo = REFUSED[statement.kind]
            name = NAMES.get(statement.kind) or f"#theory {statement.node.name}"
            yield statement.problem(f"{name} is not supported because {wrong}; {todo}")
        for node in below(statement.node) if statement.path in suspects else ():
            if node.ast_type == ASTType.TheoryAtom:
                (wrong, todo), name = REFUSED[ASTType.TheoryDefinition], f"the theory atom &{node.term.name}"
            elif node.ast_type == ASTType.Function and node.external:
                (wrong, todo), name = REFUSED[ASTType.Script], f"the function @{node.name}"
            else:
                continue
            yield statement.problem(f"{name} is not supported because {wrong}; {todo}", node.location.begin.line)

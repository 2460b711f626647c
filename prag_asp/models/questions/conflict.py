"""Why a program has no answer set: a minimal set of its lines that together exclude every answer set.

Each line is kept or lifted. A lifted constraint is dropped; a lifted rule allows its head atoms instead of deriving
them. Lifting a line therefore only adds answer sets, and lines are lifted one by one until no more can be lifted (a
deletion-based minimal unsatisfiable subset; Marques-Silva 2010), starting from clingo's unsatisfiable cores. Lines
that only state data, that is, atoms that are true in any case, are kept, unless data alone exclude every answer set.
"""

from __future__ import annotations

import re
from collections.abc import Container, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import count
from operator import itemgetter
from pathlib import Path

import clingo
from clingo.ast import AST, ASTType, Sign

from prag_asp.logic.formula.liftable import RestrictingLine
from prag_asp.logic.ground.rules import Condition, GroundRecorder
from prag_asp.models.aspif import is_aspif
from prag_asp.models.ground_program import GroundModels, ground_models
from prag_asp.models.program_reader import GivenProgram, read_program
from prag_asp.models.questions.choices import AtomChoice, conditions_of_symbols, parse_choice, rules_of_choice
from prag_asp.models.questions.ground_lines import liftable_text
from prag_asp.processes.progress_events import stage
from prag_asp.program.constants import Constant
from prag_asp.program.grounding import Grounder
from prag_asp.program.parse import parse_sources
from prag_asp.program.sources import ADDED, Program, Source
from prag_asp.program.syntax import AtomNode, Signature, Statement, with_replaced

POLL = 0.05
"""The time between two checks for interrupts, in seconds."""

CONFLICTS = 100_000
"""The number of conflicts after which the solver gives up on a line: this takes a few seconds, but is deterministic."""

CONSTANT = re.compile(r"-?\d+|_*[a-z][\w']*")
"""An argument that is a number or a name."""


CHOICES = Path("<where>")
"""The path that stands for choices, whose lines are numbered from 1."""


@dataclass(frozen=True)
class Conflict:
    """Lines of a program that together exclude every answer set; if `minimal` is true, no proper subset does.

    A set is not known to be minimal if the solver gave up on one of its subsets.
    """

    lines: tuple[RestrictingLine, ...]
    minimal: bool


def explain_program(
    files: Sequence[str | Path | Source], constants: Mapping[str, Constant], where: Sequence[str] = ()
) -> Conflict | None:
    """Return lines that exclude every answer set of a program, or None if it has one; optimisation is ignored.

    The literals `where` choose and exclude shown symbols, and count as lines.

    Raises:
        DomainError: a file cannot be read or ground.
        QueryError: a text is not a literal, or no answer set can show its symbol.
    """
    given = read_program(files, constants, optimal=True)
    ground = ground_models(given)
    known = conditions_of_symbols(ground, project=False)
    return find_conflict(given, ground, [parse_choice(text, known) for text in where])


def find_conflict(
    given: GivenProgram, ground: GroundModels, choices: Sequence[AtomChoice] = (), *, project: bool = False
) -> Conflict | None:
    """Return lines and choices that exclude every answer set, or None if some answer set agrees with the choices."""

    def conflict_of(liftable: _LiftableLines) -> Conflict | None:
        return liftable.with_choices(choices, ground, project=project).conflict()

    for source in given.program.sources:
        if is_aspif(source):
            conflict = conflict_of(_liftable_ground(given, source, facts=False))
            return (
                conflict
                if conflict is None or conflict.lines
                else conflict_of(_liftable_ground(given, source, facts=True))
            )
    data = {_signature(symbol) for symbol, _ in ground.names}
    data -= {_signature(symbol) for symbol, atom in ground.names if atom not in ground.facts}
    conflict = conflict_of(_liftable_lines(given, ground, data))
    return (
        conflict if conflict is None or conflict.lines or not data else conflict_of(_liftable_lines(given, ground, ()))
    )


def _liftable_ground(given: GivenProgram, source: Source, *, facts: bool) -> _LiftableLines:
    """Return the lines of an aspif program, including facts if `facts` is true."""
    text, lines, kept = liftable_text(source, facts=facts)
    recorder = GroundRecorder()
    grounder = Grounder(given.program, "--opt-mode=ignore", strict=False, text=text, observer=recorder)
    grounder.ground([("base", [])])
    return _LiftableLines(grounder.control, lines, kept, recorder.shown)


def _liftable_lines(given: GivenProgram, ground: GroundModels, data: Container[Signature]) -> _LiftableLines:
    """Return the lines of a program, except those that only state data."""
    texts = [source.text for source in given.program.sources]
    prefix = next(name for name in ("_" * length for length in count(1)) if not any(name in each for each in texts))
    sources: list[Source] = []
    lines: list[RestrictingLine] = []
    for source in given.program.sources:
        statements, _ = parse_sources([(source, True)])
        replaced: dict[Statement, str] = {}
        for statement in statements:
            if _is_liftable(statement, data):
                kept = f"{prefix}kept({len(lines)})"
                replaced[statement] = " ".join(_liftable(statement, kept, f"{prefix}may"))
                text = _written(source, statement)
                lines.append(RestrictingLine(source.path, statement.line, text))
        sources.append(Source(source.path, with_replaced(source.text, replaced)))
    possible = (_possible(symbol, f"{prefix}may") for symbol, _ in ground.names if symbol.name)
    choice = f"{{ {prefix}kept(0..{len(lines) - 1}) }}." if lines else ""
    program = Program((*sources, Source(ADDED, " ".join([choice, *possible]))))
    recorder = GroundRecorder()
    grounder = Grounder(program, *given.arguments, "--opt-mode=ignore", strict=False, observer=recorder)
    grounder.ground([("base", [])])
    atoms = grounder.control.symbolic_atoms
    symbols = (clingo.Function(f"{prefix}kept", [clingo.Number(place)]) for place in range(len(lines)))
    literals = [atom.literal for atom in map(atoms.__getitem__, symbols) if atom is not None]
    return _LiftableLines(grounder.control, lines, literals, recorder.shown)


@dataclass(frozen=True)
class _LiftableLines:
    """Lines of a program that restrict answer sets, each with the literal that keeps it.

    `_shown` holds the conditions under which answer sets show a symbol.
    """

    _control: clingo.Control
    _lines: Sequence[RestrictingLine]
    _literals: Sequence[int]
    _shown: Mapping[clingo.Symbol, Sequence[Condition]]

    def with_choices(self, choices: Sequence[AtomChoice], ground: GroundModels, *, project: bool) -> _LiftableLines:
        """Return these lines and choices about symbols of a ground program; a choice can be lifted like a line."""
        if not choices:
            return self
        by_statement = project and ground.projected is not None
        lines, literals = [*self._lines], [*self._literals]
        with self._control.backend() as backend:
            for number, each in enumerate(choices, 1):
                atom = self._control.symbolic_atoms[each.symbol] if by_statement else None
                conditions = ((atom.literal,),) if atom is not None else self._shown.get(each.symbol, ())
                kept = backend.add_atom()
                backend.add_rule([kept], choice=True)
                for rule in rules_of_choice(each, conditions, backend.add_atom):
                    backend.add_rule(rule.heads, rule.body if rule.heads else (*rule.body, kept))
                lines.append(RestrictingLine(CHOICES, number, str(each)))
                literals.append(kept)
        return replace(self, _lines=lines, _literals=literals)

    def conflict(self) -> Conflict | None:
        """Return lines that exclude every answer set, or None if the program has one."""
        stage("looking for the lines")
        conflict = self._core(range(len(self._lines)))
        if conflict is None:
            return None
        assert isinstance(self._control.configuration.solve, clingo.Configuration)
        self._control.configuration.solve.solve_limit = CONFLICTS
        minimal = True
        for place in list(conflict):
            if place in conflict:
                try:
                    fewer = self._core([other for other in conflict if other != place])
                except _GivenUp:
                    minimal = False
                else:
                    conflict = conflict if fewer is None else fewer
        return Conflict(tuple(self._lines[place] for place in conflict), minimal)

    def _core(self, places: Sequence[int]) -> list[int] | None:
        """Return a subset of the lines that excludes every answer set while all other lines are lifted, or None.

        Raises:
            _GivenUp: the solver reached its limit.
        """
        chosen = set(places)
        assumed = [literal if place in chosen else -literal for place, literal in enumerate(self._literals)]
        with self._control.solve(assumptions=assumed, async_=True) as handle:
            try:
                while not handle.wait(POLL):
                    pass
                result = handle.get()
                if result.satisfiable:
                    return None
                if not result.unsatisfiable:
                    raise _GivenUp
                core = set(handle.core())
            finally:
                handle.cancel()
        # Lines that are lifted in the core restrict nothing, because lifting them only adds answer sets.
        return [place for place in sorted(chosen) if self._literals[place] in core]


class _GivenUp(Exception):
    """The signal that the solver has reached its limit."""


def _is_liftable(statement: Statement, data: Container[Signature]) -> bool:
    """Return whether a statement restricts answer sets and does not merely state data."""
    if not statement.is_rule or statement.part != "base":
        return False
    heads = _derived(statement)
    return not heads or any(head.signature not in data for head in heads)


def _derived(statement: Statement) -> list[AtomNode]:
    """Return the atoms that a rule derives; a negated head restricts answer sets like a constraint."""
    return [head for head in statement.heads if not head.negated]


def _liftable(statement: Statement, kept: str, may: str) -> Iterator[str]:
    """Yield rules equivalent to a statement if the atom `kept` is true, and to its lifted form otherwise."""
    body = "".join(f"{text}; " for _, text in statement.literals)
    yield f"{statement.node.head} :- {body}{kept}."
    allowed = [str(element) for element in _elements(statement.node.head)]
    if allowed:
        yield f"{{ {'; '.join(allowed)} }} :- {body}not {kept}."
    for head in _derived(statement):
        arguments = [text if CONSTANT.fullmatch(text) else f"V{place}" for place, text in enumerate(head.arguments)]
        terms = f"({','.join(arguments)})" if arguments else ""
        # An atom without variables may be true even if no rule can derive it.
        condition = f" : {may}_{head.name.replace('-', 'not_')}{terms}" if "V" in map(itemgetter(0), arguments) else ""
        yield f"{{ {head.name}{terms}{condition} }} :- not {kept}."


def _elements(head: AST) -> Iterator[AST]:
    """Yield the atoms of a head with their conditions, as elements of a choice."""
    if head.ast_type == ASTType.Literal:
        elements = [head]
    elif head.ast_type == ASTType.HeadAggregate:
        elements = [element.condition for element in head.elements]
    else:
        elements = list(head.elements)
    for element in elements:
        literal = element if element.ast_type == ASTType.Literal else element.literal
        if literal.sign == Sign.NoSign and literal.atom.ast_type == ASTType.SymbolicAtom:
            yield element


def _possible(symbol: clingo.Symbol, may: str) -> str:
    """Return the fact that an atom is possible."""
    name = f"{may}_{'not_' if symbol.negative else ''}{symbol.name}"
    return f"{name}({','.join(map(str, symbol.arguments))})." if symbol.arguments else f"{name}."


def _signature(symbol: clingo.Symbol) -> Signature:
    return ("-" * symbol.negative + symbol.name, len(symbol.arguments))


def _written(source: Source, statement: Statement) -> str:
    """Return the original text of a statement on one line."""
    begin, end = statement.node.location.begin, statement.node.location.end
    lines = source.text.encode().split(b"\n")[begin.line - 1 : end.line]  # clingo counts columns in bytes
    lines[-1] = lines[-1][: end.column - 1]
    lines[0] = lines[0][begin.column - 1 :]
    return " ".join(b" ".join(lines).decode().split())

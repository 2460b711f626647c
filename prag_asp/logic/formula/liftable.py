"""A program whose restricting lines can be lifted, one by one.

A line is restricting if it only removes plans: a constraint, a precondition, an initial value, an invariant or a goal.
Each such line holds if its atom is true. A postcondition sets a fluent to a value; if it is lifted, the atom
``__loose`` decides whether the fluent may have any value or the postcondition just has no effect. Composites are lifted
together, as ``--flat`` does, because constraints test that a plan is a concatenation of composites. Declarations of
entities, fluents and actions are not lifted.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from clingo.ast import ASTType

from prag_asp.program.parse import parse_sources
from prag_asp.program.sources import ADDED, HIERARCHY, Program, Source, owned
from prag_asp.program.syntax import Statement

KEPT, LOOSE = "__kept", "__loose"
"""The names of the atoms ``__kept(i)``, each of which keeps line i, and of the atom ``__loose`` (see above)."""

RESTRICTING = frozenset([
    ("precondition", 3), ("initially", 2), ("exclusive", 2), ("implies", 2), ("impossible", 2), ("goal", 2),
    ("at_most", 2),
])  # fmt: skip
"""The predicates whose statements only remove plans."""

EFFECT, COMPOSITE = ("postcondition", 3), ("composite", 1)
RULES = "rules"
"""The folder of the optional encodings, each of which a domain includes with one line."""


@dataclass(frozen=True)
class RestrictingLine:
    """An author's statement with its file, line and text or, for an optional rule, the line that includes it."""

    path: Path
    line: int
    text: str

    def __str__(self) -> str:
        return f"{self.path}:{self.line}: {self.text}"


@dataclass(frozen=True)
class LiftableProgram:
    """A program and its lines; line i holds if the atom ``__kept(i)``, chosen by the program, is true."""

    program: Program
    lines: tuple[RestrictingLine, ...]


def make_liftable(program: Program) -> LiftableProgram:
    """Return a program with one atom for each restricting line, or a single atom for a whole optional rule."""
    lines: list[RestrictingLine] = []
    sources: list[Source] = []
    for source, own in owned(program):
        optional = not own and source.path.parent.name == RULES
        composed = _composing(program) if not own and source.path.name == HIERARCHY else None
        if source.path == ADDED or not (own or optional or composed):
            sources.append(source)
            continue
        statements, _ = parse_sources([(source, own)])
        if composed:
            lines.append(composed)
        elif optional and any(map(_restricts, statements)):
            # The line that includes the rule, or the rule itself if the user named it.
            including = (
                RestrictingLine(other.path, line, f'#include "{RULES}/{path.name}".')
                for other in program.sources
                for line, path in other.includes
                if path.resolve() == source.path.resolve()
            )
            lines.append(next(including, RestrictingLine(source.path, 1, f"the rule {source.path.stem}")))
        texts = list[str]()
        for statement in statements:
            if not _restricts(statement):
                texts.append(statement.text)
                continue
            if own:
                lines.append(RestrictingLine(source.path, statement.line, statement.text))
            texts += _under(statement, f"{KEPT}({len(lines) - 1})")
        sources.append(Source(source.path, "\n".join(texts)))
    choice = "".join(f"{{ {KEPT}({number}) }}. " for number in range(len(lines)))
    return LiftableProgram(Program((*sources, Source(ADDED, f"{choice}{{ {LOOSE} }}."))), tuple(lines))


def _composing(program: Program) -> RestrictingLine | None:
    """Return the first line that declares a composite, which represents all of them, or None."""
    statements, _ = parse_sources((source, own) for source, own in owned(program) if own and source.path != ADDED)
    for statement in statements:
        if any(atom.signature == COMPOSITE for atom in statement.heads):
            return RestrictingLine(
                statement.path, statement.line, f"{statement.node} (with all composites, as --flat lifts them)"
            )
    return None


def _restricts(statement: Statement) -> bool:
    """Return whether a statement only removes plans."""
    if not statement.is_rule or statement.node.head.ast_type != ASTType.Literal:
        return False
    if not statement.heads:
        return True
    own = {atom.signature for atom in statement.heads}
    return not statement.timed and own <= RESTRICTING | {EFFECT}


def _under(statement: Statement, kept: str) -> Iterator[str]:
    """Yield a statement that applies if the atom `kept` is true, and its lifted form, which applies otherwise."""
    head, body = statement.node.head, "".join(f"{text}; " for _, text in statement.literals)
    yield f"{head} :- {body}{kept}."
    if any(atom.signature == EFFECT for atom in statement.heads):
        symbol = head.atom.symbol
        pool = symbol.arguments if symbol.ast_type == ASTType.Pool else [symbol]
        effects = [f"{EFFECT[0]}({each.arguments[0]},{each.arguments[1]},unknown)" for each in pool]
        lifted = f"({';'.join(effects)})" if len(effects) > 1 else effects[0]
        yield f"{lifted} :- {body}not {kept}; {LOOSE}."

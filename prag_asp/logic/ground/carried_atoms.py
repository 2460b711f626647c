"""All atoms that steps may carry along, from a single grounding of a step that follows itself.

If step t-1 is replaced by step t, the rules of one step derive from one another what successive steps would derive, and
clingo derives each atom once. A counter up to K thus takes K instances of its rule, whereas K successive steps take
K^2. The result may contain additional atoms, which no plan reaches, and may lack atoms that depend on the absence of
others.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable
from pathlib import Path

import clingo

from prag_asp.program.grounding import Grounder
from prag_asp.program.parse import parse_sources
from prag_asp.program.sources import CONTRACT, Program, Source
from prag_asp.program.syntax import Signature, Statement, with_replaced


def carried_atoms(
    program: Program, time: clingo.Symbol, open_atoms: Iterable[clingo.Symbol], carried: Collection[Signature]
) -> set[clingo.Symbol]:
    """Return the atoms of the predicates `carried`, without their time, that steps may derive.

    `open_atoms` are the atoms that are assumed to be either true or false.

    Raises:
        BoundReached: the atoms of a rule derive too many further values.
    """
    grounder = Grounder(Program(tuple(map(_onto_itself, program.sources))))
    grounder.ground([("base", [])])
    grounder.leave_open(clingo.Function(each.name, [*each.arguments, time]) for each in open_atoms)
    grounder.ground([("step", [time])])
    atoms = (atom.symbol for each in carried for atom in grounder.control.symbolic_atoms.by_signature(*each))
    return {clingo.Function(each.name, each.arguments[:-1]) for each in atoms if each.arguments[-1] == time}


def _onto_itself(source: Source) -> Source:
    """Return a source without constraints, in which the rules of a step read this step instead of the previous one.

    The contract gets another path, so that no folder counts as encodings, and the rules of all files are bounded.
    """
    replaced: dict[Statement, str] = {}
    for statement in parse_sources([(source, True)])[0]:
        if statement.part == "step" and statement.is_rule:
            now = statement.parameters[0] if statement.parameters else "t"
            replaced[statement] = statement.text.replace(f"({now}-1)", now) if statement.heads else ""
    path = Path("<contract>") if source.path.name == CONTRACT else source.path
    return Source(path, with_replaced(source.text, replaced))

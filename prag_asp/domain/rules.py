"""The optional rules that a user selects by name, such as ``no_undo`` or ``at_most(grasp,2)``."""

from __future__ import annotations

from pathlib import Path

from prag_asp.atom import parse_atom
from prag_asp.errors import DomainError
from prag_asp.program.parse import parse_sources
from prag_asp.program.paths import rule_names
from prag_asp.program.sources import Source, read_sources
from prag_asp.wording import did_you_mean


def rule_sources(rule: str, encodings: Path) -> tuple[Source, ...]:
    """Return the files of a rule; a rule with arguments is also stated as a fact, in an additional source.

    Raises:
        DomainError: there is no such rule, or it takes another number of arguments.
    """
    atom = parse_atom(rule)
    folder = encodings / "rules"
    names = rule_names(encodings)
    if atom.name not in names:
        otherwise = f"there are {', '.join(names) or 'none'} in {folder}"
        raise DomainError(f"{rule}: no such rule; {did_you_mean(atom.name, names, otherwise)}")
    sources = read_sources(folder / f"{atom.name}.lp", encodings)
    if not atom.arguments:
        return sources
    counts_taken = _argument_counts(sources, atom.name)
    if len(atom.arguments) not in counts_taken:
        if not counts_taken:
            raise DomainError(f"{rule}: the rule {atom.name} takes no arguments; write {atom.name}")
        counts = " or ".join(map(str, sorted(counts_taken)))
        raise DomainError(
            f"{rule}: the rule {atom.name} takes {counts} arguments, not {len(atom.arguments)}; "
            f"see the head of {folder / atom.name}.lp"
        )
    return (*sources, Source(Path(f"rule {atom}"), f"{atom}."))


def _argument_counts(sources: tuple[Source, ...], name: str) -> set[int]:
    """Return the arities of the facts that a rule reads under its name."""
    statements, _ = parse_sources((source, False) for source in sources)
    return {len(atom.arguments) for statement in statements for atom in statement.body if atom.name == name}

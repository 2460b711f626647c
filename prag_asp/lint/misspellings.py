"""Misspelled predicates, which clingo does not report, and reserved names."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from clingo.ast import ASTType

from prag_asp.program.predicates import RESERVED
from prag_asp.program.problem import Problem
from prag_asp.program.syntax import AtomNode, Signature, Statement, spelled
from prag_asp.wording import did_you_mean, is_misspelt, nearest

SHOWN = (ASTType.ShowSignature, ASTType.Defined)


def vocabulary_problems(statements: Sequence[Statement]) -> Iterator[Problem]:
    """Yield the heads that no rule reads, the atoms that no rule defines, and reserved names."""
    contract = contract_signatures(statements)
    unread = _unread_heads(statements, contract)
    undefined = _undefined_atoms(statements, contract)
    vocabulary = {name for name, _ in (*contract, *undefined) if not is_reserved(name)}
    for signature, (statement, atom) in unread.items():
        near = nearest(signature[0], vocabulary)
        for missing in [each for each in undefined if each[0] == near]:
            del undefined[missing]
        misspelt = _takes(signature[0], contract) or is_misspelt(signature[0], vocabulary)
        hint = _hint(signature[0], contract, vocabulary, "read it in the body of a rule, or remove it")
        problem = "unknown predicate" if near or _takes(signature[0], contract) else "no rule reads"
        text = f"{problem} {spelled(signature)}; {hint}"
        yield statement.problem(text, atom.line, "" if misspelt else "unused")
    defined = contract | {atom.signature for statement in statements for atom in statement.heads}
    names = {name for name, _ in defined if not is_reserved(name)}
    for signature, (statement, atom) in undefined.items():
        misspelt = _takes(signature[0], defined) or is_misspelt(signature[0], names)
        hint = _hint(signature[0], defined, names, "define it in a fact or a rule, or remove it")
        text = f"no rule defines {spelled(signature)}; {hint}"
        yield statement.problem(text, atom.line, "" if misspelt else "undefined")
    for statement in statements:
        for atom in statement.heads if statement.own else ():
            if is_reserved(atom.name):
                text = f"names that begin with {RESERVED} are reserved for the library"
                yield statement.problem(f"{text}; rename {spelled(atom.signature)}", atom.line)


def contract_signatures(statements: Iterable[Statement]) -> set[Signature]:
    """Return the predicates that the encodings declare or define."""
    signatures: set[Signature] = set()
    for statement in statements:
        if not statement.own:
            signatures |= {atom.signature for atom in statement.heads}
            if statement.kind == ASTType.Defined:
                signatures.add((statement.node.name, statement.node.arity))
    return signatures


def is_reserved(name: str) -> bool:
    """Return whether a predicate, strongly negated or not, has a name that is reserved for the library."""
    return name.removeprefix("-").startswith(RESERVED)


def _unread_heads(
    statements: Iterable[Statement], contract: set[Signature]
) -> dict[Signature, tuple[Statement, AtomNode]]:
    """Return the author's heads that no body reads and the contract does not declare, each at its first occurrence."""
    unread: dict[Signature, tuple[Statement, AtomNode]] = {}
    for statement in statements:
        if statement.own:
            for atom in statement.heads:
                if atom.signature not in contract:
                    unread.setdefault(atom.signature, (statement, atom))
    for statement in sorted(statements, key=lambda each: not each.own):
        if not unread:
            break
        for atom in statement.body:
            unread.pop(atom.signature, None)
        if statement.own and statement.kind in SHOWN:
            unread.pop((statement.node.name, statement.node.arity), None)
    return unread


def _takes(name: str, defined: Iterable[Signature]) -> str:
    """Return as text the arities of the predicates with the given name, or an empty text if there are none."""
    return " or ".join(str(arity) for other, arity in sorted(defined) if other == name)


def _hint(name: str, defined: Iterable[Signature], vocabulary: Iterable[str], otherwise: str) -> str:
    counts = _takes(name, defined)
    return f"{name} takes {counts} arguments" if counts else did_you_mean(name, vocabulary, otherwise)


def _undefined_atoms(
    statements: Iterable[Statement], contract: set[Signature]
) -> dict[Signature, tuple[Statement, AtomNode]]:
    """Return the author's body atoms that neither a head nor the contract defines, each at its first occurrence."""
    defined = set(contract)
    for statement in statements:
        defined |= {atom.signature for atom in statement.heads}
        if statement.own and statement.kind == ASTType.Defined:
            defined.add((statement.node.name, statement.node.arity))
    undefined: dict[Signature, tuple[Statement, AtomNode]] = {}
    for statement in statements:
        if statement.own:
            for atom in statement.body:
                if atom.signature not in defined:
                    undefined.setdefault(atom.signature, (statement, atom))
    return undefined

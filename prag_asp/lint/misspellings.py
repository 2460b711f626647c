"""Predicates that are misspelt, for clingo says nothing about them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

from clingo.ast import ASTType

from prag_asp.lint.reaching.relaxed import PREFIX
from prag_asp.program.problem import Problem
from prag_asp.program.sources import HIERARCHY
from prag_asp.program.syntax import AtomNode, Signature, Statement, spelled
from prag_asp.wording import did_you_mean, is_misspelt, nearest

LINTER = "the linter, which asks what may ever occur"

BY_LIBRARY = {
    **dict.fromkeys([("asked", 1), ("condition", 2), ("tested", 2), ("mentioned", 2)], "conditions and tasks"),
    **dict.fromkeys([("introduces_late", 2), ("successor", 2)], "conditions and tasks"),
    **dict.fromkeys([("joint_unit", 2), ("next_unit", 2), ("unit_named", 2), ("names_unit_late", 2)], "tasks"),
    ("left_out", 1): "the library, which leaves out what can never occur",
    **dict.fromkeys([("may_occur", 1), ("may_hold", 2), ("may_stand", 2)], LINTER),
}
"""What the library and its encodings for ``rules`` and ``conditions`` derive where they are asked for."""

OWNERS = {
    HIERARCHY: "the hierarchy of actions",
    "invariants.lp": "the invariants",
    "impossible.lp": "what is impossible",
}
"""Whose the predicates are that an encoding defines."""

SHARED = frozenset([("is_a", 2), ("holds", 3), ("known", 3), ("changed", 2)])
"""What the encodings define and a domain may add to."""

SHOWN = (ASTType.ShowSignature, ASTType.Defined)


def vocabulary_problems(statements: Sequence[Statement]) -> Iterator[Problem]:
    """Yield the heads that nothing reads, and the atoms that nothing defines."""
    contract = contract_signatures(statements)
    unread = _unread_heads(statements, contract)
    undefined = _undefined_atoms(statements, contract)
    known = {name for name, _ in contract} | {name for name, _ in undefined}
    for signature, (statement, atom) in unread.items():
        near = nearest(signature[0], known)
        for missing in [each for each in undefined if each[0] == near]:
            del undefined[missing]
        slip = _takes(signature[0], contract) or is_misspelt(signature[0], known)
        hint = _hint(signature[0], contract, known, "read it in the body of a rule, or remove it")
        what = "unknown predicate" if near or _takes(signature[0], contract) else "no rule reads"
        text = f"{what} {spelled(signature)}; {hint}"
        yield statement.problem(text, atom.line, "" if slip else "unused")
    yield from _undefined_problems(statements, contract, undefined)
    yield from _taken_problems(statements)


def contract_signatures(statements: Iterable[Statement]) -> set[Signature]:
    """Return the predicates that a domain may state: those of the contract, and what the encodings define."""
    signatures: set[Signature] = set()
    for statement in statements:
        if not statement.own:
            signatures |= {atom.signature for atom in statement.heads}
            if statement.kind == ASTType.Defined:
                signatures.add((statement.node.name, statement.node.arity))
    return signatures


def _taken_problems(statements: Sequence[Statement]) -> Iterator[Problem]:
    """Yield the own heads of predicates that only the library may derive."""
    shipped = [each for each in statements if not each.own]
    free = {(each.node.name, each.node.arity) for each in shipped if each.kind == ASTType.Defined} | SHARED
    taken = dict(BY_LIBRARY)
    for each in shipped:
        owner = OWNERS.get(each.path.name, f"the encodings ({each.path.name})")
        taken |= {atom.signature: owner for atom in each.heads if atom.signature not in free}
    for statement in statements:
        for atom in statement.heads if statement.own else ():
            whose = LINTER if atom.name.startswith(PREFIX) else taken.get(atom.signature)
            if whose:
                text = f"{spelled(atom.signature)} belongs to {whose}; choose another name"
                yield statement.problem(text, atom.line)


def _unread_heads(
    statements: Iterable[Statement], contract: set[Signature]
) -> dict[Signature, tuple[Statement, AtomNode]]:
    """Return the own heads outside of the contract that no body reads, where they first stand."""
    found: dict[Signature, tuple[Statement, AtomNode]] = {}
    for statement in statements:
        if statement.own:
            for atom in statement.heads:
                if atom.signature not in contract:
                    found.setdefault(atom.signature, (statement, atom))
    for statement in sorted(statements, key=lambda each: not each.own):
        if not found:
            break
        for atom in statement.body:
            found.pop(atom.signature, None)
        if statement.own and statement.kind in SHOWN:
            found.pop((statement.node.name, statement.node.arity), None)
    return found


def _takes(name: str, defined: Iterable[Signature]) -> str:
    """Return how many arguments a predicate takes, as text; nothing where there is none of that name."""
    return " or ".join(str(arity) for other, arity in sorted(defined) if other == name)


def _hint(name: str, defined: Iterable[Signature], known: Iterable[str], otherwise: str) -> str:
    counts = _takes(name, defined)
    return f"{name} takes {counts} arguments" if counts else did_you_mean(name, known, otherwise)


def _undefined_atoms(
    statements: Iterable[Statement], contract: set[Signature]
) -> dict[Signature, tuple[Statement, AtomNode]]:
    """Return the atoms of own bodies that are in no head and not in the contract, where they first stand."""
    defined = set(contract)
    for statement in statements:
        defined |= {atom.signature for atom in statement.heads}
        if statement.own and statement.kind == ASTType.Defined:
            defined.add((statement.node.name, statement.node.arity))
    found: dict[Signature, tuple[Statement, AtomNode]] = {}
    for statement in statements:
        if statement.own:
            for atom in statement.body:
                if atom.signature not in defined:
                    found.setdefault(atom.signature, (statement, atom))
    return found


def _undefined_problems(
    statements: Iterable[Statement],
    contract: set[Signature],
    undefined: Mapping[Signature, tuple[Statement, AtomNode]],
) -> Iterator[Problem]:
    defined = contract | {atom.signature for statement in statements for atom in statement.heads}
    for signature, (statement, atom) in undefined.items():
        name, known = signature[0], {other for other, _ in defined}
        slip = _takes(name, defined) or is_misspelt(name, known)
        hint = _hint(name, defined, known, "define it in a fact or a rule, or remove it")
        yield statement.problem(f"no rule defines {spelled(signature)}; {hint}", atom.line, "" if slip else "undefined")

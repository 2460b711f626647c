"""The lines of a ground aspif program, each with an atom that keeps it, and their text as rules.

A lifted constraint or assumption is dropped, and a lifted rule allows its head for any body. Outputs, projection,
externals and edges are unchanged.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import count
from typing import NamedTuple

from prag_asp.logic.formula.liftable import RestrictingLine
from prag_asp.models.aspif import ASSUME, COMMENT, OUTPUT, RULE
from prag_asp.program.sources import Source


class LiftableText(NamedTuple):
    """An aspif program for clingo, its liftable lines, and the atoms that keep them, line by line."""

    text: str
    lines: tuple[RestrictingLine, ...]
    kept: tuple[int, ...]


class _Rule(NamedTuple):
    """An aspif rule; `weights` is None for a conjunction."""

    choice: bool
    heads: tuple[int, ...]
    bound: int
    literals: tuple[int, ...]
    weights: tuple[int, ...] | None

    @property
    def is_fact(self) -> bool:
        return not self.choice and len(self.heads) == 1 and not self.literals and self.weights is None

    @property
    def restricts(self) -> bool:
        """Whether lifting the rule may add answer sets: a choice without a body already allows its heads."""
        return not self.choice or bool(self.literals) or self.weights is not None


def liftable_text(source: Source, *, facts: bool) -> LiftableText:
    """Return a checked program with lines that can be lifted, including facts if `facts` is true."""
    lines = source.text.split("\n")
    statements = list(enumerate(lines[1 : lines.index("0")], 2))
    names = dict(_names(text for _, text in statements))
    fresh = count(1 + max((abs(atom) for _, text in statements for atom in _atoms(text)), default=0))
    written, restricting, kept = [lines[0]], [], []
    for number, text in statements:
        kind, *fields = text.split(" ")
        rules: list[_Rule] = []
        if kind == str(RULE):
            rules.append(_rule(fields))
        elif kind == str(ASSUME):
            rules += (_Rule(False, (), 0, (-int(literal),), None) for literal in fields[1:])
        elif kind != str(COMMENT):
            written.append(text)
        liftable = [rule for rule in rules if rule.restricts and (facts or not rule.is_fact)]
        if not liftable:
            written += (text for _ in rules)
            continue
        kept.append(next(fresh))
        restricting.append(RestrictingLine(source.path, number, " ".join(_as_text(rule, names) for rule in rules)))
        for rule in liftable:
            written += _lifted(rule, kept[-1], fresh)
    written += (f"{RULE} 1 1 {atom} 0 0" for atom in kept)
    return LiftableText("".join(f"{line}\n" for line in [*written, "0"]), tuple(restricting), tuple(kept))


def _rule(fields: Sequence[str]) -> _Rule:
    choice, size, *rest = map(int, fields)
    heads, (is_sum, *body) = tuple(rest[:size]), rest[size:]
    if is_sum:
        bound, _, *pairs = body
        return _Rule(bool(choice), heads, bound, tuple(pairs[::2]), tuple(pairs[1::2]))
    return _Rule(bool(choice), heads, 0, tuple(body[1:]), None)


def _lifted(rule: _Rule, kept: int, fresh: Iterator[int]) -> Iterator[str]:
    """Yield the lines of a rule that holds if an atom is true, and that allows its heads otherwise."""
    body = rule.literals
    if rule.weights is not None:
        body = (next(fresh),)
        pairs = " ".join(map(str, (each for pair in zip(rule.literals, rule.weights, strict=True) for each in pair)))
        yield f"{RULE} 0 1 {body[0]} 1 {rule.bound} {len(rule.weights)} {pairs}".rstrip()
    heads = " ".join(map(str, (len(rule.heads), *rule.heads)))
    yield f"{RULE} {int(rule.choice)} {heads} 0 {len(body) + 1} {' '.join(map(str, (*body, kept)))}"
    if rule.heads:
        yield f"{RULE} 1 {heads} 0 1 {-kept}"


def _as_text(rule: _Rule, names: Mapping[int, str]) -> str:
    """Return a rule in clingo's language."""

    def spell(literal: int) -> str:
        return ("not " if literal < 0 else "") + names.get(abs(literal), f"x_{abs(literal)}")

    heads = "; ".join(map(spell, rule.heads))
    head = f"{{ {heads} }}" if rule.choice else heads
    body = ", ".join(map(spell, rule.literals))
    if rule.weights is not None:
        pairs = enumerate(zip(rule.weights, rule.literals, strict=True), 1)
        body = f"#sum {{ {'; '.join(f'{weight},{place} : {spell(each)}' for place, (weight, each) in pairs)} }}"
        body += f" >= {rule.bound}"
    return f"{head} :- {body}.".lstrip() if body or not head else f"{head}."


def _names(statements: Iterator[str]) -> Iterator[tuple[int, str]]:
    """Yield the atoms that are the only condition of an output, with the name of the output, in reverse order."""
    for text in reversed(list(statements)):
        name, condition = _output(text)
        if len(condition) == 1 and condition[0] > 0:
            yield condition[0], name


def _output(text: str) -> tuple[str, tuple[int, ...]]:
    """Return the term and the condition of an output; both are empty for any other statement."""
    kind, _, rest = text.partition(" ")
    if kind != str(OUTPUT):
        return "", ()
    length, _, rest = rest.partition(" ")
    content = rest.encode()
    return content[: int(length)].decode(), tuple(map(int, content[int(length) :].split()[1:]))


def _atoms(text: str) -> Iterator[int]:
    """Yield the atoms in a statement, as negative numbers if they are negated."""
    kind, *fields = text.split(" ")
    if kind == str(RULE):
        rule = _rule(fields)
        yield from (*rule.heads, *rule.literals)
    elif kind == str(OUTPUT):
        yield from _output(text)[1]
    elif kind in ATOMS_FROM:
        yield from map(int, fields[ATOMS_FROM[kind]])


ATOMS_FROM: Mapping[str, slice] = {
    "3": slice(1, None), "5": slice(0, 1), "6": slice(1, None), "7": slice(1, 2), "8": slice(3, None),
}  # fmt: skip
"""The fields with atoms in other statements, by kind: projection, externals, assumptions, heuristics, edges.

Conditions of heuristics are irrelevant, and minimize statements contain only atoms of rules.
"""

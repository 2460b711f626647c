"""The premise of the one-step program: the step is the same function at every time.

It holds if no rule reads the number of a step, or a step other than the one before. The ground program of a single step
does not show that, so the syntax of the rules decides.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property, lru_cache

import clingo
from clingo.ast import AST, ASTType

from prag_asp.atom import STRING
from prag_asp.errors import EngineError
from prag_asp.logic.ground.growth import growing_heads
from prag_asp.program.parse import parse_sources
from prag_asp.program.predicates import HOLDS, OCCURS
from prag_asp.program.sources import Program, owned
from prag_asp.program.syntax import AtomNode, Signature, Statement, atoms, children_of, plain_atom, spelled

START = "0"
"""The text of the time of the start."""

PARTS = ("base", "step", "check")


@dataclass(frozen=True)
class _Times:
    """The text of the number of the step in the rules of a program part: the parameter of the part."""

    now: str

    @property
    def before(self) -> str:
        """The text of the step before."""
        return f"({self.now}-1)"

    @cached_property
    def spelled(self) -> re.Pattern[str]:
        """Finds the number of the step in a text."""
        return re.compile(rf"(?<![\w']){re.escape(self.now)}(?![\w'(])")

    def depend(self, atom: AtomNode) -> bool:
        """Return whether an argument of an atom other than its time contains the number of the step."""
        others = atom.arguments[:-1] if _time_of(atom) in (self.now, self.before) else atom.arguments
        return any(self.spelled.search(STRING.sub("", argument)) for argument in others)

    def stand_in(self, node: AST, text: str) -> bool:
        """Return whether a literal contains the number of the step other than as the time of an atom."""
        if not self.spelled.search(text):
            return False
        plain = plain_atom(node, text)
        return self.depend(plain) if plain else self._stand_below(node)

    def _stand_below(self, node: AST) -> bool:
        """Return the same for any node of a syntax tree."""
        kind = node.ast_type
        if kind == ASTType.SymbolicTerm:
            return bool(node.symbol == clingo.Function(self.now))
        if kind == ASTType.SymbolicAtom:
            return any(map(self.depend, atoms(node, str(node))))
        return any(map(self._stand_below, children_of(node)))


_times = cache(_Times)


@dataclass(frozen=True)
class Obstacle:
    """Why a step is not a function of the state and the action: `what` at a `place`, which is a file and a line."""

    what: str
    place: str = ""
    remedy: str = ""

    def error(self) -> EngineError:
        """Return the obstacle as an error."""
        return EngineError(self.what, place=self.place, remedy=self.remedy)


@dataclass(frozen=True)
class StepReads:
    """The predicates that the rules of a step read.

    `timed` are the predicates with a time, `previous` those read at step t-1, and `last` those that the check after the
    last step reads. `growing` are the timed ones that may take ever new values. `obstacles` are the reasons why the
    step is no function of the state and the action.
    """

    timed: frozenset[Signature]
    previous: frozenset[Signature]
    obstacles: tuple[Obstacle, ...]
    growing: frozenset[Signature]
    last: frozenset[Signature]


@dataclass(frozen=True)
class _TimedRule:
    """A rule with the text of the number of the step in its part."""

    statement: Statement
    times: _Times

    @property
    def heads(self) -> tuple[AtomNode, ...]:
        """The atoms that the rule derives."""
        return self.statement.heads

    def atoms(self) -> Iterator[AtomNode]:
        """Yield all atoms, including those of conditions."""
        yield from self.statement.heads
        yield from self.statement.body

    def obstacle(self, what: str, remedy: str = "") -> Obstacle:
        """Return an obstacle at the line of the rule."""
        return Obstacle(what, f"{self.statement.path}:{self.statement.line}", remedy)


@lru_cache(maxsize=1024)
def _reads_number(rule: _TimedRule) -> bool:
    """Return whether a rule contains the number of the step other than as the time of an atom."""
    statement, times = rule.statement, rule.times
    if not times.spelled.search(statement.text):
        return False
    head = statement.node.head
    return any(times.stand_in(node, text) for node, text in ((head, str(head)), *statement.literals))


def read_step(program: Program) -> StepReads:
    """Return the predicates of step t-1 that the parts ``step(t)`` and ``check(t)`` of a program read.

    Statements that clingo cannot parse are skipped: grounding the program raises the error.
    """
    statements, _ = parse_sources(owned(program))
    rules: dict[str, list[_TimedRule]] = {name: [] for name in PARTS}
    for statement in statements:
        if statement.is_rule:
            times = _times(statement.parameters[0] if statement.parameters else "t")
            rules.setdefault(statement.part, []).append(_TimedRule(statement, times))
    timed: set[Signature] = {OCCURS, HOLDS}
    for rule in rules["step"]:
        timed |= {atom.signature for atom in rule.heads if _time_of(atom) == rule.times.now}
    obstacles = [*_numbered(rules, timed)]
    rules["base"] = [rule for rule in rules["base"] if _may_carry_time(rule, timed)]
    previous: set[Signature] = set()
    for name in PARTS:
        for rule in rules[name]:
            obstacle = _obstacle(rule, name, timed, previous)
            if obstacle:
                obstacles.append(obstacle)
    stepping = (rule.statement for rule in rules["step"])
    growing = {head for each in stepping for head in growing_heads(each.heads, each.literals, timed)}
    last = {atom.signature for rule in rules["check"] for atom in rule.atoms() if _time_of(atom) == rule.times.now}
    return StepReads(frozenset(timed), frozenset(previous), tuple(obstacles), frozenset(growing), frozenset(last))


def _numbered(rules: Mapping[str, Sequence[_TimedRule]], timed: Collection[Signature]) -> Iterator[Obstacle]:
    """Yield the rules of the base part or the last check that state atoms by the number of a step."""
    last = {atom.signature for rule in rules["check"] for atom in rule.heads if _time_of(atom) == rule.times.now}
    at, before = set(last), set[Signature]()
    for name in ("step", "check"):
        for rule in rules[name]:
            for atom in rule.atoms():
                time = _time_of(atom)
                if time == rule.times.now and atom.signature not in timed:
                    at.add(atom.signature)
                    if name == "step" and atom.signature in last:
                        what = "is read in a step, and made after the last one"
                        yield rule.obstacle(f"{spelled(atom.signature)} {what}")
                elif time == rule.times.before:
                    before.add(atom.signature)
    for rule in rules["base"]:
        for atom in rule.heads:
            if atom.signature in at or (atom.signature in before and _time_of(atom) != START):
                yield rule.obstacle(f"{spelled(atom.signature)} is stated by the number of a step")


def _may_carry_time(rule: _TimedRule, timed: Collection[Signature]) -> bool:
    """Return whether the text of a rule has the name of a timed predicate, or the step before."""
    text = rule.statement.text
    return rule.times.before in text or any(name in text for name, _ in timed)


def _obstacle(rule: _TimedRule, part: str, timed: Collection[Signature], previous: set[Signature]) -> Obstacle | None:
    """Return the reason why a rule differs between steps, or None; add the predicates that it reads to `previous`."""
    for atom in rule.atoms():
        wrong = _read_elsewhere(atom, timed) if part == "base" else _misread(atom, part, rule.times, timed)
        if wrong:
            return rule.obstacle(f"{atom.name}/{len(atom.arguments)} {wrong[0]}", *wrong[1:])
        if _time_of(atom) == rule.times.before:
            previous.add(atom.signature)
    if part == "step" and any(_time_of(atom) != rule.times.now for atom in rule.heads):
        return rule.obstacle(f"a head in step({rule.times.now}) does not carry the time {rule.times.now}")
    if part != "base" and _reads_number(rule):
        return rule.obstacle("the rule reads the number of the step", "carry a counter along instead")
    return None


def _read_elsewhere(atom: AtomNode, timed: Collection[Signature]) -> tuple[str, ...] | None:
    """Return the problem of reading an atom in the base part, or None."""
    if atom.signature in timed and _time_of(atom) != START:
        return ("is read outside of the parts step(t) and check(t)",)
    return None


def _misread(atom: AtomNode, part: str, times: _Times, timed: Collection[Signature]) -> tuple[str, ...] | None:
    """Return the problem of an atom of a step or a check, with the remedy if there is one, or None."""
    time = _time_of(atom)
    if atom.name.startswith("-") and (time in (times.now, times.before) or atom.signature in timed):
        return "is strongly negated", "carry a predicate of another name along instead"
    if time == times.before and part == "check":
        return ("is read at step t-1 by the check after the last step",)
    if atom.signature in timed and time not in (times.now, times.before, START):
        return ("is read at a step other than t and t-1",)
    return None


def _time_of(atom: AtomNode) -> str:
    return atom.arguments[-1] if atom.arguments else ""

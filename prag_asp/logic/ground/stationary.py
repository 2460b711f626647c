"""The premise of the one-step program: the step is the same function at every time.

It holds if no rule reads the number of a step, or a step other than the previous one. The ground program of a single
step does not show this, so it is decided from the syntax of the rules.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import clingo
from clingo.ast import AST, ASTType

from prag_asp.atom import STRING
from prag_asp.errors import EngineError
from prag_asp.logic.ground.growth import growing_heads
from prag_asp.program.parse import parse_sources
from prag_asp.program.predicates import HOLDS, OCCURS
from prag_asp.program.sources import Program, encodings_folder, owned
from prag_asp.program.syntax import AtomNode, Signature, Statement, atoms, children_of, plain_atom, spelled

START = "0"
"""The text of the initial time."""

ONE_ACTION = "1 <= { occurs(A,t): action(A), not _pruned(A) } <= 1."
ANY_ACTION = "1 <= { occurs(A,t): action(A) } <= 1."
"""The rule of ``step.lp`` by which exactly one action occurs, with and without pruning, as clingo writes it."""

PARTS = ("base", "step", "check")


@dataclass(frozen=True)
class Obstacle:
    """A reason why a step is not a function of the state and the action.

    `what` states the reason, and `place` is the file and the line that are its cause.
    """

    what: str
    place: str = ""
    remedy: str = ""

    def error(self) -> EngineError:
        """Return the obstacle as an error."""
        return EngineError(self.what, place=self.place, remedy=self.remedy)


@dataclass(frozen=True)
class StepReads:
    """The predicates that the rules of a step read.

    `timed` are the predicates with a time, `previous` the predicates read at step t-1, and `last` the predicates that
    the check after the last step reads. `growing` are the timed predicates whose arguments may take new values forever.
    `obstacles` are the reasons why the step is not a function of the state and the action.
    """

    timed: frozenset[Signature]
    previous: frozenset[Signature]
    obstacles: tuple[Obstacle, ...]
    growing: frozenset[Signature]
    last: frozenset[Signature]


@dataclass(frozen=True)
class _TimedRule:
    """A rule and the text of the step number in it, `now`: the parameter of the rule's program part."""

    statement: Statement
    now: str

    @property
    def before(self) -> str:
        """The text of the previous step."""
        return f"({self.now}-1)"

    @property
    def heads(self) -> tuple[AtomNode, ...]:
        """The atoms that the rule derives."""
        return self.statement.heads

    def atoms(self) -> Iterator[AtomNode]:
        """Yield all atoms, including the atoms of conditions."""
        yield from self.statement.heads
        yield from self.statement.body

    def obstacle(self, what: str, remedy: str = "") -> Obstacle:
        """Return an obstacle at the line of the rule."""
        return Obstacle(what, f"{self.statement.path}:{self.statement.line}", remedy)


@lru_cache(maxsize=1024)
def _reads_number(rule: _TimedRule) -> bool:
    """Return whether a rule contains the step number anywhere except as the time of an atom."""
    number = re.compile(rf"(?<![\w']){re.escape(rule.now)}(?![\w'(])")

    def atom_reads(atom: AtomNode) -> bool:
        others = atom.arguments[:-1] if _time_of(atom) in (rule.now, rule.before) else atom.arguments
        return any(number.search(STRING.sub("", argument)) for argument in others)

    def node_reads(node: AST) -> bool:
        if node.ast_type == ASTType.SymbolicTerm:
            return bool(node.symbol == clingo.Function(rule.now))
        if node.ast_type == ASTType.SymbolicAtom:
            return any(map(atom_reads, atoms(node, str(node))))
        return any(map(node_reads, children_of(node)))

    if not number.search(rule.statement.text):
        return False
    head = rule.statement.node.head
    for node, text in ((head, str(head)), *rule.statement.literals):
        if number.search(text):
            plain = plain_atom(node, text)
            if atom_reads(plain) if plain else node_reads(node):
                return True
    return False


def read_step(program: Program) -> StepReads:
    """Return the predicates of step t-1 that the parts ``step(t)`` and ``check(t)`` of a program read.

    Statements that clingo cannot parse are skipped; grounding the program raises the error.
    """
    statements, _ = parse_sources(owned(program))
    rules: dict[str, list[_TimedRule]] = {name: [] for name in PARTS}
    for statement in statements:
        if statement.is_rule:
            now = statement.parameters[0] if statement.parameters else "t"
            rules.setdefault(statement.part, []).append(_TimedRule(statement, now))
    timed: set[Signature] = {OCCURS, HOLDS}
    acting = [rule for rule in rules["step"] if any(atom.signature == OCCURS for atom in rule.heads)]
    for rule in rules["step"]:
        timed |= {atom.signature for atom in rule.heads if _time_of(atom) == rule.now}
    obstacles = list(_acting(acting, encodings_folder(program)))
    obstacles += _numbered(rules, timed)
    # A base-part rule can have a time only if it contains the name of a timed predicate or the previous step.
    rules["base"] = [
        rule
        for rule in rules["base"]
        if rule.before in rule.statement.text or any(name in rule.statement.text for name, _ in timed)
    ]
    previous: set[Signature] = set()
    found = (_obstacle(rule, name, timed, previous) for name in PARTS for rule in rules[name])
    obstacles += [obstacle for obstacle in found if obstacle]
    stepping = (rule.statement for rule in rules["step"])
    growing = {head for each in stepping for head in growing_heads(each.heads, each.literals, timed)}
    last = {atom.signature for rule in rules["check"] for atom in rule.atoms() if _time_of(atom) == rule.now}
    return StepReads(frozenset(timed), frozenset(previous), tuple(obstacles), frozenset(growing), frozenset(last))


def _acting(rules: Sequence[_TimedRule], encodings: Path | None) -> Iterator[Obstacle]:
    """Yield an obstacle for each choice of actions other than that of ``step.lp``, or one if there is no choice."""
    remedy = "choose the engine clingo, or restore that rule"
    choices = [
        each for each in rules if not each.statement.own and each.statement.node.head.ast_type != ASTType.Literal
    ]
    for rule in choices:
        if rule.statement.text not in (ONE_ACTION, ANY_ACTION):
            what = "this rule lets actions occur otherwise than in step.lp, where each step has exactly one"
            yield rule.obstacle(what, remedy)
    if encodings is not None and not choices:
        yield Obstacle("no rule lets exactly one action occur in each step", f"{encodings / 'step.lp'}:1", remedy)


def _numbered(rules: Mapping[str, Sequence[_TimedRule]], timed: Collection[Signature]) -> Iterator[Obstacle]:
    """Yield an obstacle for each rule of the base part or the final check with an atom whose time is a step number."""
    last = {atom.signature for rule in rules["check"] for atom in rule.heads if _time_of(atom) == rule.now}
    at, before = set(last), set[Signature]()
    for name in ("step", "check"):
        for rule in rules[name]:
            for atom in rule.atoms():
                time = _time_of(atom)
                if time == rule.now and atom.signature not in timed:
                    at.add(atom.signature)
                elif time == rule.before:
                    before.add(atom.signature)
    for rule in rules["base"]:
        for atom in rule.heads:
            if atom.signature in at or (atom.signature in before and _time_of(atom) != START):
                yield rule.obstacle(f"{spelled(atom.signature)} is derived for a fixed step number")


def _obstacle(rule: _TimedRule, part: str, timed: Collection[Signature], previous: set[Signature]) -> Obstacle | None:
    """Return the reason why a rule differs between steps, or None; add the predicates that it reads to `previous`."""
    now, before = rule.now, rule.before
    for atom in rule.atoms():
        time, problem, remedy = _time_of(atom), "", ""
        if part == "base":
            if atom.signature in timed and time != START:
                problem = "is read outside of the parts step(t) and check(t)"
        elif atom.name.startswith("-") and (time in (now, before) or atom.signature in timed):
            problem, remedy = "is strongly negated", "carry a predicate of another name along instead"
        elif time == before and part == "check":
            problem = "is read at step t-1 by the check after the last step"
        elif atom.signature in timed and time not in (now, before, START):
            problem = "is read at a step other than t and t-1"
        if problem:
            return rule.obstacle(f"{spelled(atom.signature)} {problem}", remedy)
        if time == before:
            previous.add(atom.signature)
    if part == "step" and any(_time_of(atom) != now for atom in rule.heads):
        return rule.obstacle(f"a head in step({now}) does not carry the time {now}")
    if part != "base" and _reads_number(rule):
        return rule.obstacle("the rule reads the number of the step", "carry a counter along instead")
    return None


def _time_of(atom: AtomNode) -> str:
    return atom.arguments[-1] if atom.arguments else ""

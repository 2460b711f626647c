"""Write a domain for BDDL problems: classes, objects, regions, and the logic that all such domains share."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

from prag_asp.atom import Atom
from prag_asp.bddl.bddl_reader import BDDL, bddl_files, read_bddl
from prag_asp.bddl.goal_rules import goal_rules
from prag_asp.bddl.ground_goals import FactValue, conjuncts, fact_values
from prag_asp.bddl.ground_problems import LOCATIONS, GroundProblem, ground_problem
from prag_asp.errors import DomainError
from prag_asp.pddl.clingo_names import TERMS, clingo_names
from prag_asp.pddl.program_text import filled, heading, statement
from prag_asp.wording import plural

if TYPE_CHECKING:
    import clingo

LOGIC = "manipulation.lp"
"""The file of rules that each written domain includes."""

SWITCHES = ("turnon", "toggled_on")
OPEN = "open"
KIND = re.compile(r"is_a\(\w,(\w+)\)")
"""A class that occurs in a rule."""


def logic_text() -> str:
    """Return the rules that all written domains share."""
    return Path(__file__).with_name(LOGIC).read_text(encoding="utf-8")


@dataclass(frozen=True)
class SuiteDomain:
    """A domain for several problems, given by file name: one program, in which a constant selects the problem.

    If an object of some kind holds objects, opens or is switched in any problem, all objects of this kind can do so.
    """

    problems: Mapping[str, GroundProblem]
    title: str

    def files(self) -> dict[str, str]:
        """Return the texts of the files of the domain by name."""
        (first, *others) = self.names
        files = {LOGIC: logic_text()}
        if not others:
            lines = [*self._head(), *self._union(), *heading("The problem"), "", *self._problem(first, "")]
            return {**files, "domain.lp": "\n".join(lines) + "\n"}
        for name in self.names:
            body = f"problem = {self.names[name]}"
            title = self.problems[name].language or self.problems[name].name
            lines = [f"% {title}", "", *self._problem(name, body)]
            files[f"problems/{self.names[name]}.lp"] = "\n".join(lines) + "\n"
        includes = [f'#include "problems/{name}.lp".' for name in self.names.values()]
        select = [
            "% The problem; another one is selected by -c problem=NAME.",
            f"#const problem = {self.names[first]}.",
        ]
        lines = [*self._head(), *select, "", *self._union(), *heading("The problems"), "", *includes]
        return {**files, "domain.lp": "\n".join(lines) + "\n"}

    def program(self, name: str) -> str:
        """Return the whole program of one problem as one text."""
        head = [line for line in self._head() if LOGIC not in line]
        return "\n".join([*head, logic_text(), *self._union_of(name), "", *self._problem(name, "")]) + "\n"

    def _union_of(self, name: str) -> list[str]:
        """Return the rules about the kinds of objects in one problem, from all problems of the suite."""
        kinds = {self._kinds[each] for each in self.problems[name].kinds.values()}
        return [line for line in self._rules if set(KIND.findall(line)) <= kinds]

    @cached_property
    def _rules(self) -> tuple[str, ...]:
        return tuple(self._union())

    @cached_property
    def names(self) -> Mapping[str, str]:
        """The name of each problem in the program."""
        stems = {name: re.sub(r"[^a-z0-9_]", "_", Path(name).stem.lower()) for name in self.problems}
        unique = clingo_names(stems.values(), "problem")
        taken: dict[str, int] = {}
        result = {}
        for name, stem in stems.items():
            number = taken[stem] = taken.get(stem, 0) + 1
            result[name] = unique[stem] if number == 1 else f"{unique[stem]}_{number}"
        return result

    @cached_property
    def _kinds(self) -> Mapping[str, str]:
        return clingo_names((kind for each in self.problems.values() for kind in each.kinds.values()), "some")

    @cached_property
    def _objects(self) -> Mapping[str, str]:
        names = (name for each in self.problems.values() for name in each.kinds)
        return clingo_names(names, "the", self._kinds.values())

    @cached_property
    def _predicates(self) -> Mapping[str, str]:
        names = (each.fact.name for problem in self.problems.values() for each in _facts(problem))
        return clingo_names(dict.fromkeys([*LOCATIONS, *SWITCHES, OPEN, *names]), "is", (), {*TERMS, "holding"})

    def fluent(self, atom: Atom) -> str:
        """Return a fact as a fluent of the program."""
        arguments = ",".join(self._objects[each] for each in atom.arguments)
        return f"{self._predicates[atom.name]}({arguments})" if arguments else self._predicates[atom.name]

    @cached_property
    def _given_names(self) -> tuple[Mapping[str, str], Mapping[str, str]]:
        predicates, objects = self._predicates.items(), self._objects.items()
        return {ours: given for given, ours in predicates}, {ours: given for given, ours in objects}

    def own_fact(self, fluent: clingo.Symbol) -> Atom:
        """Return a fluent of the program as a BDDL fact; names that BDDL does not know are kept."""
        predicates, objects = self._given_names
        names = (str(each) for each in fluent.arguments)
        return Atom(predicates.get(fluent.name, fluent.name), tuple(objects.get(each, each) for each in names))

    def _head(self) -> list[str]:
        lines = [f"% {self.title}"]
        for kind, names in {"classes": self._kinds, "objects": self._objects, "predicates": self._predicates}.items():
            changed = [f"{ours} is {given}" for given, ours in names.items() if ours != given]
            lines += [f"% Names of {kind} in BDDL: {', '.join(changed)}."] if changed else []
        return [*lines, "", '#include "rules/closed_world.lp".', f'#include "{LOGIC}".', ""]

    def _union(self) -> list[str]:
        """Return rules that state, for each kind of object, the properties that it has in any of the problems."""
        opens = {kind for each in self._kind_facts() if each[0] == OPEN for kind in each[1][:1]}
        movable = {each.kinds[name] for each in self.problems.values() for name in each.movable}
        takes = dict.fromkeys((name, kinds[1]) for name, kinds in self._moves())
        switched = dict.fromkeys((name, kinds[0]) for name, kinds in self._kind_facts() if name in SWITCHES and kinds)
        member = {kind: f"is_a(X,{self._kinds[kind]})" for kind in self._kinds}
        lines = [f"movable(X) :- {member[kind]}." for kind in sorted(movable)]
        lines += [f"takes_{name}(X) :- {member[kind]}." for name, kind in sorted(takes)]
        lines += [f"openable(X) :- {member[kind]}." for kind in sorted(opens)]
        lines += [f"has_{name}(X) :- {member[kind]}." for name, kind in sorted(switched)]
        places = {kind for name, kind in takes if LOCATIONS[name]}
        lines += [f"door(X,X) :- {member[kind]}." for kind in sorted(opens & places)]
        pairs = {
            (each.kinds[name], each.kinds[target])
            for each in self.problems.values()
            for name, (target, _) in each.parts.items()
            if target in each.kinds
        }
        behind = sorted((part, whole) for part, whole in pairs if part in places - opens and whole in opens)
        lines += [f"door(X,Y) :- part_of(X,Y), {member[part]}, is_a(Y,{self._kinds[whole]})." for part, whole in behind]
        takers, switches = (f"takes_{name}/1" for name in LOCATIONS), (f"has_{name}/1" for name in SWITCHES)
        undefined = [
            f"#defined {name}."
            for name in ("movable/1", *takers, *switches, "openable/1", "door/2", "changeable/1", "part_of/2")
        ]
        return [*undefined, "", *lines]

    def _kind_facts(self) -> Iterator[tuple[str, tuple[str, ...]]]:
        """Yield the predicates of all facts, with the kinds of their arguments."""
        for problem in self.problems.values():
            for each in _facts(problem):
                yield each.fact.name, tuple(problem.kinds[name] for name in each.fact.arguments)

    def _moves(self) -> Iterator[tuple[str, tuple[str, ...]]]:
        """Yield the facts about where movable objects are, in the same form as `_kind_facts`."""
        for problem in self.problems.values():
            for each in _facts(problem):
                arguments = each.fact.arguments
                if each.fact.name in LOCATIONS and len(arguments) == 2 and arguments[0] in problem.movable:
                    yield each.fact.name, tuple(problem.kinds[name] for name in arguments)

    def _problem(self, name: str, body: str) -> list[str]:
        """Return the facts of one problem, each under a condition, which may be empty."""
        problem, given = self.problems[name], [body] if body else []
        of_kind: dict[str, list[str]] = {}
        for each, kind in problem.kinds.items():
            of_kind.setdefault(self._kinds[kind], []).append(self._objects[each])
        lines = [statement(f"class({kind})", given) for kind in of_kind]
        lines += [statement(f"entity({_pool(names)},{kind})", given) for kind, names in of_kind.items()]
        whole = {part: target for part, (target, _) in problem.parts.items() if target in problem.kinds}
        lines += [statement(f"part_of({self._objects[part]},{self._objects[to]})", given) for part, to in whole.items()]
        facts = dict.fromkeys(each.fact for each in _facts(problem))
        handled = {each for each in facts if self._is_handled(problem, each)}
        fixed = [each for each in facts if each not in handled and _is_fixed(problem, each)]
        free = [each for each in facts if each not in handled and each not in fixed]
        lines += [statement(f"fluent({text})", given) for text in self._pools(fixed)]
        lines += [statement(f"changeable({text})", given) for text in self._pools(free)]
        true = [each.fact for each in problem.initial if each.value]
        lines += [statement(f"initially({text}, true)", given) for text in self._pools(true)]
        placed = {each.arguments[0] for each in true if each.name in LOCATIONS and each.arguments}
        lines += [
            statement(f"initially(unplaced({self._objects[each]}), true)", given)
            for each in problem.kinds
            if each in problem.movable - placed
        ]
        parts = conjuncts(problem.goal)
        literals = [each for each in parts if isinstance(each, FactValue)]
        for value in (True, False):
            wanted = self._pools([each.fact for each in literals if each.value is value])
            lines += [statement(f"goal({text}, {str(value).lower()})", given) for text in wanted]
        others = [each for each in parts if not isinstance(each, FactValue)]
        return [*lines, *goal_rules(others, self.fluent, body, self.names[name])]

    def _is_handled(self, problem: GroundProblem, fact: Atom) -> bool:
        """Return whether the shared rules declare and change a fact."""
        if fact.name in LOCATIONS:
            return len({*fact.arguments}) == 2 and fact.arguments[0] in problem.movable
        return fact.name in (OPEN, *SWITCHES) and len(fact.arguments) == 1

    def _pools(self, facts: Iterable[Atom]) -> Iterator[str]:
        return filled_pools([self.fluent(each) for each in facts])


def read_suite(path: str | Path) -> SuiteDomain:
    """Return the domain of a BDDL file, or of all BDDL files in a folder and its subfolders.

    Raises:
        DomainError: there is no such file, or some files are not BDDL problems; the message contains a line for each
            error.
    """
    path = Path(path)
    files = bddl_files(path) if path.is_dir() else [path]
    if not files:
        raise DomainError(f"{path}: no file in this folder ends in {BDDL}; give a folder of BDDL problems")
    problems: dict[str, GroundProblem] = {}
    mistakes: list[str] = []
    for file in files:
        try:
            problems[str(file.relative_to(path)) if path.is_dir() else file.name] = ground_problem(
                read_bddl(file), file
            )
        except DomainError as error:
            mistakes += error.lines
    if mistakes:
        raise DomainError(*mistakes)
    (first, *others) = problems.values()
    what = f"{plural(len(problems), 'problem')} of {path.resolve().name}" if others else f"The problem {first.name}"
    return SuiteDomain(problems, f"{what}, imported from BDDL.")


def _facts(problem: GroundProblem) -> Iterator[FactValue]:
    yield from problem.initial
    yield from fact_values(problem.goal)


def _is_fixed(problem: GroundProblem, fact: Atom) -> bool:
    """Return whether a fact states the place of an object that does not move."""
    return fact.name in (*LOCATIONS, "inroom", "insource")


def filled_pools(texts: Sequence[str]) -> Iterator[str]:
    """Yield terms as pools of limited width: a single term, or several in parentheses, separated by semicolons."""
    terms = [f"{text};" for text in texts[:-1]] + [*texts[-1:]]
    for line in filled(terms, width=90):
        pool = line.removesuffix(";")
        yield f"({pool})" if ";" in pool else pool


def _pool(names: Sequence[str]) -> str:
    return f"({'; '.join(names)})" if len(names) > 1 else names[0]

"""The compilation of a formula into a diagram, by exhaustive search with component caching.

The trace of the search (Bayardo and Pehoushek 2000; Sang et al. 2004) is a deterministic decomposable negation normal
form (Huang and Darwiche 2005). A learning SAT solver tests whether each case has an answer set, so that only
satisfiable cases are explored. Only projection variables are decided: if none is left, there is one projected model (as
in Lagniez and Marquis 2019). Copies of atoms in loops are not decided either, because unit propagation derives them.

Unit propagation uses only the given clauses, never learned ones, so that the diagram depends only on the formula.
"""

from __future__ import annotations

from array import array
from collections import Counter
from collections.abc import Callable, Container, Generator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from itertools import chain, count

from prag_asp.logic.formula.clause_builder import Literal
from prag_asp.logic.formula.solver import Solver
from prag_asp.models.answer_set_formula import ModelFormula
from prag_asp.models.diagram import Branch, Diagram
from prag_asp.models.foundedness import FoundednessOracle
from prag_asp.models.prepared_formula import Missing, PreparedFormula
from prag_asp.program.finite.components import components

REPORTED = 1000
"""The number of nodes between two progress reports."""

LOOK = 64
"""The number of node visits between two calls of `look`."""

Progress = Callable[[str], None]
Node = int


@dataclass(frozen=True)
class _Part:
    """The variables of a component of the formula, and its listed clauses and sums, both sorted.

    Sums are numbered after the clauses; `missing` holds the missing weights of each sum.
    """

    variables: tuple[int, ...]
    clauses: tuple[int, ...]
    missing: Mapping[int, Missing]


@dataclass(frozen=True)
class _Case:
    """The decisions that lead to a case, the number of literals that they imply, and a model that satisfies them."""

    decisions: tuple[Literal, ...]
    implied: int
    model: Sequence[Literal]


_Work = Generator[tuple[_Part, _Case], Node, Node]
"""A generator that yields components, receives their nodes, and returns the node of the whole formula."""


def compile_formula(
    formula: ModelFormula,
    prepared: PreparedFormula,
    progress: Progress | None = None,
    look: Callable[[], None] = lambda: None,
) -> Diagram:
    """Return the diagram of a formula; `look` is called periodically, and can raise an error to abort compilation."""
    if prepared.contradictory:
        return Diagram(())
    clauses = (*prepared.clauses, *prepared.nodes)
    propagation = Solver(max(len(prepared.names) - 1, 1), clauses)  # only propagates, so it learns nothing
    with closing(FoundednessOracle(formula.completion)) as oracle, propagation:
        return _Compiler(prepared, oracle, propagation, progress, look).compile()


class _Compiler:
    """The search for the nodes."""

    def __init__(
        self,
        prepared: PreparedFormula,
        oracle: FoundednessOracle,
        propagation: Solver,
        progress: Progress | None,
        look: Callable[[], None],
    ) -> None:
        self._formula, self._oracle, self._propagation = prepared, oracle, propagation
        self._progress, self._look = progress, look
        clauses, variables = prepared.clauses, len(prepared.order.variables)
        self._variables_of = [tuple(sorted({abs(literal) for literal in clause})) for clause in clauses]
        self._with: dict[int, list[int]] = {}
        self._where: list[list[int]] = [[] for _ in range(variables + 1)]
        self._beside: list[list[int]] = [[] for _ in range(variables + 1)]
        for number, clause in enumerate(clauses):
            if len(clause) == 2 and not prepared.copies:
                # The clause is open if and only if both variables are, so no component lists it.
                one, other = self._variables_of[number]
                self._beside[one].append(other)
                self._beside[other].append(one)
                continue
            for literal in clause:
                self._with.setdefault(literal, []).append(number)
                self._where[abs(literal)].append(number)
        self._sums = dict(enumerate(prepared.sums, len(clauses)))
        for number, each in self._sums.items():
            self._variables_of.append(each.variables)
            for variable in each.variables:
                self._where[variable].append(number)
        self._nodes: list[tuple[Branch, ...]] = [(Branch((), ()),)]
        self._known: dict[bytes, Node] = {}
        self._either: dict[int, Node] = {}

    def compile(self) -> Diagram:
        """Return the diagram."""
        model = self._oracle.model()
        if model is None:
            return Diagram(())
        case = _Case((), 0, model)
        variables = range(1, len(self._where))
        missing = {number: each.missing for number, each in self._sums.items()}
        parts = self._parts(set(variables), set(chain.from_iterable(self._where)), set(variables), missing)
        children = [self._compile_part(part, case) for part in parts] + [
            self._free(name) for name in self._formula.free
        ]
        kept = (each for each in self._formula.fixed if abs(each) in self._formula.kept)
        self._nodes.append((Branch(tuple(kept), tuple(each for each in children if each)),))
        return Diagram(tuple(self._nodes))

    def _compile_part(self, part: _Part, case: _Case) -> Node:
        """Return the node of a component, without recursion because formulas are deeper than Python's stack."""
        waiting = [self._node(part, case)]
        answer: Node | None = None
        for visit in count(1):
            if not waiting:
                break
            if visit % LOOK == 0:
                self._look()
            try:
                subproblem = waiting[-1].send(answer)  # type: ignore[arg-type]  # generators start with None
            except StopIteration as done:
                waiting.pop()
                answer = done.value
            else:
                waiting.append(self._node(*subproblem))
                answer = None
        assert answer is not None
        return answer

    def _node(self, part: _Part, case: _Case) -> _Work:
        """Compute the node of a component whose variables are open in a satisfiable case."""
        chosen = next((variable for variable in part.variables if variable in self._formula.projection), 0)
        if not chosen:
            return 0
        key = self._key(part)
        if key in self._known:
            return self._known[key]
        names, kept = self._formula.names, self._formula.kept
        branches = []
        for literal in (chosen, -chosen):
            further = self._decide(case, literal)
            if further is None:
                continue
            below, implied = further
            left, clauses = set(part.variables), set(part.clauses)
            new = [each for each in implied if abs(each) in left]
            left.difference_update(map(abs, new))
            touched: set[int] = set()
            for each in new:
                touched.update(self._beside[abs(each)])
                for clause in clauses.intersection(self._where[abs(each)]):
                    touched.update(self._variables_of[clause])
            for each in new:
                clauses.difference_update(self._with.get(each, ()))
            missing = self._after(part, new) if part.missing else {}
            clauses.difference_update(part.missing.keys() - missing.keys())
            parts = self._parts(left.copy(), clauses, touched & left, missing)
            children = []
            for inner in parts:
                left.difference_update(inner.variables)
                children.append((yield inner, below))
            children += [self._free(names[each]) for each in sorted(left & self._formula.projection)]
            named = sorted((names[abs(each)], each > 0) for each in new)
            literals = tuple(name if true else -name for name, true in named if name in kept)
            branches.append(Branch(literals, tuple(each for each in children if each)))
        self._known[key] = self._add_node(tuple(branches))
        return self._known[key]

    def _add_node(self, branches: tuple[Branch, ...]) -> Node:
        self._nodes.append(branches)
        if self._progress and len(self._nodes) % REPORTED == 0:
            self._progress(f"compiling: {len(self._nodes):,} nodes")
        return len(self._nodes) - 1

    def _decide(self, case: _Case, literal: Literal) -> tuple[_Case, list[Literal]] | None:
        """Return the case with one more decision and the implied literals, or None if it has no model."""
        decisions = (*case.decisions, literal)
        implied = self._propagation.propagated(decisions)
        if implied is None:
            return None
        new = implied[case.implied :]  # propagation follows the decisions in order
        if (case.model[self._formula.names[abs(literal)] - 1] > 0) == (literal > 0):
            return _Case(decisions, len(implied), case.model), new
        names = self._formula.names
        model = self._oracle.model([names[each] if each > 0 else -names[-each] for each in decisions])
        return None if model is None else (_Case(decisions, len(implied), model), new)

    def _after(self, part: _Part, new: Sequence[Literal]) -> dict[int, Missing]:
        """Return the missing weights of a component's open sums after further literals have become true."""
        missing = dict(part.missing)
        for literal in new:
            for number in self._where[abs(literal)]:
                if number in missing:
                    missing[number] = self._sums[number].after(missing[number], literal)
        return {number: each for number, each in missing.items() if not each.is_closed}

    def _parts(
        self, waiting: set[int], unseen: set[int], touched: set[int], missing: Mapping[int, Missing]
    ) -> list[_Part]:
        """Return the components into which the clauses `unseen` and the binary clauses connect the variables `waiting`.

        Each component contains one of the variables `touched`, so a search may stop at the last of these. All three
        sets are consumed. Variables without clauses are in no component.
        """
        components = []
        while touched:
            own, own_clauses = [touched.pop()], []
            waiting.discard(own[0])
            for member in own:  # grows during the iteration
                if not touched:
                    break
                reached = [*self._beside[member]]
                for clause in self._where[member]:
                    if clause in unseen:
                        unseen.discard(clause)
                        own_clauses.append(clause)
                        reached += self._variables_of[clause]
                for other in reached:
                    if other in waiting:
                        waiting.discard(other)
                        own.append(other)
                        touched.discard(other)
            if not touched:  # all remaining variables are connected to the last touched one
                own += waiting
                own_clauses += unseen
            if own_clauses or len(own) > 1:
                own_sums = sorted(missing.keys() & own_clauses) if missing else ()
                components.append(
                    _Part(tuple(sorted(own)), tuple(sorted(own_clauses)), {each: missing[each] for each in own_sums})
                )
        return sorted(components, key=lambda part: part.variables[0])

    def _key(self, part: _Part) -> bytes:
        """Return the cache key of a component.

        Equivalent copies are merged, so the key encodes which copies are connected, but not how.
        """
        if not self._formula.copies:
            sums = array("q", chain.from_iterable(part.missing.values())).tobytes() if part.missing else b""
            return array("i", [*part.variables, 0, *part.clauses]).tobytes() + sums
        if not any(variable in self._formula.copies for variable in part.variables):
            long = [clause for clause in part.clauses if len(self._variables_of[clause]) > 2]
            return array("i", [*part.variables, 0, *long]).tobytes()
        own, formula = set(part.variables), self._formula
        left = [[literal for literal in formula.clauses[clause] if abs(literal) in own] for clause in part.clauses]
        one, read = _merge_copies(formula.copies, left)
        merged = {tuple(sorted({one.get(literal, literal) for literal in clause})) for clause in left}
        clauses = sorted(clause for clause in merged if not any(-literal in clause for literal in clause))
        # A copy must be derived if its atom is already true.
        atoms = {copy: formula.copies[copy] for copy in part.variables if copy in formula.copies}
        needed = {one.get(copy, copy) for copy, atom in atoms.items() if atom is not None and atom not in own}
        clauses += [(copy,) for copy in sorted(needed & read)]
        decided = [variable for variable in part.variables if variable not in formula.copies]
        return array("i", [*decided, 0, *chain.from_iterable((*clause, 0) for clause in clauses)]).tobytes()

    def _free(self, name: int) -> Node:
        """Return the node of a variable without constraints."""
        if name not in self._either:
            both = ((name,), (-name,)) if name in self._formula.kept else ((), ())
            self._either[name] = self._add_node(tuple(Branch(literals, ()) for literals in both))
        return self._either[name]


def _merge_copies(
    copies: Container[int], clauses: Sequence[Sequence[Literal]]
) -> tuple[dict[Literal, Literal], set[int]]:
    """Return a representative literal for each merged copy, and the variables that the remaining clauses read.

    One copy derives another by a binary clause; if no other clause derives the latter, the two are equivalent. A class
    is represented by its least copy that further clauses read, so that unread copies do not matter.
    """
    pairs: list[tuple[int, int]] = []
    read: set[int] = set()
    for clause in clauses:
        first, second = (min(clause), max(clause)) if len(clause) == 2 else (1, 1)
        if first < 0 < second and -first in copies and second in copies:
            pairs.append((-first, second))
        else:
            read.update(map(abs, clause))
    ways = Counter(literal for clause in clauses for literal in clause if literal > 0)
    graph: dict[int, list[int]] = {}
    for first, second in pairs:
        graph.setdefault(first, []).append(second)
        if ways[second] == 1:
            graph.setdefault(second, []).append(first)
    groups = [group for group in components(graph, lambda copy: graph.get(copy, ())) if len(group) > 1]
    group_of = {copy: place for place, group in enumerate(groups) for copy in group}
    for first, second in pairs:  # a clause between two groups reads both
        if first not in group_of or group_of[first] != group_of.get(second):
            read |= {first, second}
    one: dict[Literal, Literal] = {}
    for group in groups:
        chosen = min((copy for copy in group if copy in read), default=min(group))
        one |= {sign * copy: sign * chosen for copy in group for sign in (1, -1) if copy != chosen}
    return one, read

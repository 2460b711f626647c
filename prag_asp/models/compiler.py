"""Compile a formula into a diagram: case by case, with parts that share no variable compiled alone, and once.

This is exhaustive search with component caching (Bayardo and Pehoushek 2000; Sang et al. 2004), whose trace is a
deterministic decomposable negation normal form (Huang and Darwiche 2005). A SAT solver that learns says of each case
whether it has an answer set, so no case is looked at that leads nowhere. Variables that are not projected on are not
decided: where only they are left, there is one projected model (as in Lagniez and Marquis 2019). Neither are copies of
atoms in loops, which unit propagation derives.

A case is closed under unit propagation of the clauses given, never of learned ones: the diagram is a function of the
formula alone.
"""

from __future__ import annotations

from array import array
from collections.abc import Callable, Generator, Iterable, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from itertools import chain, count

from prag_asp.logic.formula.clause_builder import TRUE, Literal
from prag_asp.logic.formula.solver import Solver
from prag_asp.models.answer_set_formula import ModelFormula
from prag_asp.models.atom_copies import merge_copies
from prag_asp.models.diagram import Branch, Diagram
from prag_asp.models.foundedness import FoundednessOracle
from prag_asp.models.variable_order import DecisionOrder, decision_order

REPORTED = 1000
"""Nodes between two reports of progress."""

LOOK = 64
"""Visits of nodes between two looks at what else goes on."""

Progress = Callable[[str], None]
Node = int


@dataclass(frozen=True)
class _Part:
    """Variables and clauses of a part of the formula, both sorted."""

    variables: tuple[int, ...]
    clauses: tuple[int, ...]


@dataclass(frozen=True)
class _Case:
    """The decisions that lead to a case, and a model of all of them."""

    decisions: tuple[Literal, ...]
    model: Sequence[Literal]


_Work = Generator[tuple[_Part, _Case], Node, Node]
"""Asks for the nodes of parts, and returns that of a whole."""


@dataclass(frozen=True)
class PreparedFormula:
    """A formula as it is compiled: units are propagated, and variables numbered in the order they are decided in.

    `names` has the variable of each number, from 1; `projection` are the numbers of those that may be decided, and
    `kept` the names of those whose values the diagram has. `copies` has the atom of each copy, 0 for one that is fixed,
    and None for a gate. All models have the literals `fixed`; no clause reads the variables `free`. If the formula is
    `contradictory`, the other fields have no meaning.
    """

    clauses: tuple[tuple[Literal, ...], ...]
    names: tuple[int, ...]
    fixed: tuple[Literal, ...]
    free: tuple[int, ...]
    projection: frozenset[int]
    kept: frozenset[int]
    copies: Mapping[int, int | None]
    order: DecisionOrder
    contradictory: bool

    @property
    def cost(self) -> str:
        """The size of the formula, as messages name it."""
        clauses, variables = len(self.clauses), len(self.names) - 1
        over = f"{variables:,} variable{'s' if variables > 1 else ''}"
        return f"{clauses:,} clause{'s' if clauses > 1 else ''} over {over}, width {self.order.width}"


def prepare(formula: ModelFormula, kept: Iterable[int]) -> PreparedFormula:
    """Return a formula as it is compiled, for a diagram that has the values of some variables."""
    cnf, copies = formula.cnf, formula.completion.copies
    fixed, clauses = _propagate(cnf.clauses)
    order = decision_order(clauses or (), swept=bool(copies))
    number = {variable: place for place, variable in enumerate(order.variables, 1)}
    variables = range(1, cnf.variables + 1) if formula.whole else cnf.shown
    projection = [variable for variable in variables if variable not in copies]
    known = {abs(literal) for literal in fixed}
    return PreparedFormula(
        tuple(tuple(number[abs(each)] * (1 if each > 0 else -1) for each in clause) for clause in clauses or ()),
        (0, *order.variables),
        tuple(sorted(fixed, key=abs)),
        tuple(variable for variable in projection if variable not in number and variable not in known),
        frozenset(number[variable] for variable in projection if variable in number),
        frozenset(kept),
        {
            number[variable]: None if literal == TRUE else number.get(abs(literal), 0)
            for variable, literal in copies.items()
            if variable in number
        },
        order,
        contradictory=clauses is None,
    )


def compile_formula(
    formula: ModelFormula,
    prepared: PreparedFormula,
    progress: Progress | None = None,
    look: Callable[[], None] = lambda: None,
) -> Diagram:
    """Return the diagram of a formula; `look` is called every now and then, and ends it by an error."""
    if prepared.contradictory:
        return Diagram(())
    with closing(FoundednessOracle(formula.completion)) as oracle, _propagation(prepared) as propagation:
        return _Compiler(prepared, oracle, propagation, progress, look).compile()


def _propagation(prepared: PreparedFormula) -> Solver:
    """Return a solver of the clauses that is never asked to solve, so that it learns nothing."""
    return Solver(max(len(prepared.names) - 1, 1), prepared.clauses)


def _propagate(
    clauses: Iterable[Sequence[Literal]],
) -> tuple[set[Literal], list[tuple[Literal, ...]] | None]:
    """Return the literals that unit clauses lead to and the clauses that are left, None where one has no literal."""
    fixed: set[Literal] = set()
    left: list[tuple[Literal, ...]] = [tuple(dict.fromkeys(clause)) for clause in clauses]
    while True:
        kept, before = [], len(fixed)
        for clause in left:
            if any(literal in fixed for literal in clause):
                continue
            open_literals = tuple(literal for literal in clause if -literal not in fixed)
            if not open_literals:
                return fixed, None
            if len(open_literals) == 1:
                fixed.add(open_literals[0])
            else:
                kept.append(open_literals)
        left = kept
        if len(fixed) == before:
            return fixed, list(dict.fromkeys(left))


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
        self._given, self._oracle, self._propagation = prepared, oracle, propagation
        self._progress, self._look = progress, look
        clauses, variables = prepared.clauses, len(prepared.names) - 1
        self._variables_of = [tuple(sorted({abs(literal) for literal in clause})) for clause in clauses]
        self._with: dict[int, list[int]] = {}
        self._where: list[list[int]] = [[] for _ in range(variables + 1)]
        for number, clause in enumerate(clauses):
            for literal in clause:
                self._with.setdefault(literal, []).append(number)
                self._where[abs(literal)].append(number)
        self._nodes: list[tuple[Branch, ...]] = [(Branch((), ()),)]
        self._known: dict[bytes, Node] = {}
        self._either: dict[int, Node] = {}

    def compile(self) -> Diagram:
        """Return the diagram."""
        model = self._oracle.model()
        if model is None:
            return Diagram(())
        case = _Case((), model)
        parts = self._parts(range(1, len(self._given.names)), range(len(self._given.clauses)))
        children = [self._compile_part(part, case) for part in parts] + [self._free(name) for name in self._given.free]
        kept = (each for each in self._given.fixed if abs(each) in self._given.kept)
        self._nodes.append((Branch(tuple(kept), tuple(each for each in children if each)),))
        return Diagram(tuple(self._nodes))

    def _compile_part(self, part: _Part, case: _Case) -> Node:
        """Return the node of a part, without recursion: formulas are deeper than Python's stack."""
        waiting = [self._node(part, case)]
        answer: Node | None = None
        for visit in count(1):
            if not waiting:
                break
            if visit % LOOK == 0:
                self._look()
            try:
                asked = waiting[-1].send(answer)  # type: ignore[arg-type]  # a generator begins with None
            except StopIteration as done:
                waiting.pop()
                answer = done.value
            else:
                waiting.append(self._node(*asked))
                answer = None
        assert answer is not None
        return answer

    def _node(self, part: _Part, case: _Case) -> _Work:
        """Find the node of a part whose variables a case leaves open; the case has a model."""
        chosen = next((variable for variable in part.variables if variable in self._given.projection), 0)
        if not chosen:
            return 0
        key = self._key(part)
        if key in self._known:
            return self._known[key]
        branches = []
        for literal in (chosen, -chosen):
            further = self._decide(case, literal)
            if further is None:
                continue
            below, implied = further
            own = set(part.variables)
            new = [each for each in implied if abs(each) in own]
            parts, free = self._split(part, own, new)
            children = []
            for inner in parts:
                children.append((yield inner, below))
            children += [self._free(self._given.names[each]) for each in free]
            branches.append(Branch(self._kept_literals(new), tuple(each for each in children if each)))
        self._known[key] = self._add_node(tuple(branches))
        return self._known[key]

    def _add_node(self, branches: tuple[Branch, ...]) -> Node:
        self._nodes.append(branches)
        if self._progress and len(self._nodes) % REPORTED == 0:
            self._progress(f"compiling: {len(self._nodes):,} nodes")
        return len(self._nodes) - 1

    def _decide(self, case: _Case, literal: Literal) -> tuple[_Case, list[Literal]] | None:
        """Return the case with one more decision and what it implies, None where it has no model."""
        decisions = (*case.decisions, literal)
        implied = self._propagation.propagated(decisions)
        if implied is None:
            return None
        if (case.model[self._given.names[abs(literal)] - 1] > 0) == (literal > 0):
            return _Case(decisions, case.model), implied
        model = self._oracle.model([self._name(each) for each in decisions])
        return None if model is None else (_Case(decisions, model), implied)

    def _name(self, literal: Literal) -> Literal:
        return self._given.names[literal] if literal > 0 else -self._given.names[-literal]

    def _split(self, part: _Part, own: set[int], new: Sequence[Literal]) -> tuple[list[_Part], list[int]]:
        """Return the parts that are left of one where literals are true, and its variables that nothing reads now."""
        satisfied = {clause for literal in new for clause in self._with.get(literal, ())}
        left = own.difference(map(abs, new))
        parts = self._parts(sorted(left), [clause for clause in part.clauses if clause not in satisfied])
        for each in parts:
            left.difference_update(each.variables)
        return parts, sorted(left & self._given.projection)

    def _parts(self, variables: Sequence[int], clauses: Sequence[int]) -> list[_Part]:
        """Return the parts that variables fall into by clauses that are open; what no clause reads is in none."""
        unseen, waiting = set(clauses), set(variables)
        found = []
        for variable in variables:
            if variable not in waiting:
                continue
            waiting.discard(variable)
            own_variables, own_clauses = [variable], []
            for each in own_variables:  # grows on the way
                for clause in self._where[each]:
                    if clause in unseen:
                        unseen.discard(clause)
                        own_clauses.append(clause)
                        for other in self._variables_of[clause]:
                            if other in waiting:
                                waiting.discard(other)
                                own_variables.append(other)
            if own_clauses:
                found.append(_Part(tuple(sorted(own_variables)), tuple(sorted(own_clauses))))
        return found

    def _key(self, part: _Part) -> bytes:
        """Return what tells the part from others: a clause of two literals is open where both variables are."""
        if any(variable in self._given.copies for variable in part.variables):
            return self._key_of_copies(part)
        long = [clause for clause in part.clauses if len(self._variables_of[clause]) > 2]
        return array("i", [*part.variables, 0, *long]).tobytes()

    def _key_of_copies(self, part: _Part) -> bytes:
        """Return what tells a part with copies from others; copies that derive each other are one, whichever.

        So it is told what is connected, but not how.
        """
        own, given = set(part.variables), self._given
        left = [[each for each in given.clauses[clause] if abs(each) in own] for clause in part.clauses]
        one, read = merge_copies(given.copies, left)
        told = {tuple(sorted({one.get(each, each) for each in clause})) for clause in left}
        clauses = sorted(clause for clause in told if not any(-each in clause for each in clause))
        # Where its atom is true already, a copy has to be derived.
        atoms = {copy: given.copies[copy] for copy in part.variables if copy in given.copies}
        needed = {one.get(copy, copy) for copy, atom in atoms.items() if atom is not None and atom not in own}
        clauses += [(copy,) for copy in sorted(needed & read)]
        decided = [variable for variable in part.variables if variable not in given.copies]
        return array("i", [*decided, 0, *chain.from_iterable((*clause, 0) for clause in clauses)]).tobytes()

    def _kept_literals(self, literals: Sequence[Literal]) -> tuple[Literal, ...]:
        """Return the literals of a branch that the diagram is asked for, by their names."""
        names, kept = self._given.names, self._given.kept
        named = sorted((names[abs(each)], each > 0) for each in literals)
        return tuple(name if true else -name for name, true in named if name in kept)

    def _free(self, name: int) -> Node:
        """Return the node of a variable that may have either value."""
        if name not in self._either:
            both = ((name,), (-name,)) if name in self._given.kept else ((), ())
            self._either[name] = self._add_node(tuple(Branch(literals, ()) for literals in both))
        return self._either[name]

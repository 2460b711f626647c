"""A step of a domain as a function from states to states, evaluated on all states of a frontier at once.

Nothing here knows what a rule means. The ground rules are evaluated once with no action, which leaves every atom a
column over the states; an action then re-evaluates just the atoms that depend on it, and only on the states in which
it breaks no constraint that reads the state directly.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import clingo
import numpy as np
from numpy.typing import NDArray

from prag_asp.logic.cone import find_cone
from prag_asp.logic.normal import Body, NormalStep
from prag_asp.logic.strata import Column, Stratum, body_column, evaluate, stratify

States = NDArray[np.bool_]
"""Shape (number of variables, number of states)."""


@dataclass(frozen=True)
class Successors:
    """What one action makes of a frontier.

    `sources` are the columns of the frontier in which it is valid, shape (m,); `states` has the states after it, shape
    (number of variables, m); `labels` the truth of each label, shape (number of labels, m).
    """

    sources: NDArray[np.intp]
    states: States
    labels: NDArray[np.bool_]


@dataclass(frozen=True)
class _Move:
    """What is left of the rules once the action is fixed: guards over the state, then rules, then constraints."""

    guards: tuple[Body, ...]
    strata: tuple[Stratum, ...]
    bodies: Mapping[int, tuple[Body, ...]]
    constraints: tuple[Body, ...]
    touched: frozenset[int]
    constants: Mapping[int, bool]
    impossible: bool


@dataclass(frozen=True)
class Transition:
    """The step function of a domain over the states of its cone of influence.

    `variables` are timed atoms without their time, `actions` all actions in clingo's order of terms and `labels` the
    atoms of step t whose truth each edge carries.
    """

    step: NormalStep
    variables: tuple[clingo.Symbol, ...]
    constraints: tuple[Body, ...]
    labels: tuple[clingo.Symbol, ...]

    @property
    def actions(self) -> tuple[clingo.Symbol, ...]:
        """All actions that some rule lets occur."""
        return tuple(self.step.occurs)

    @cached_property
    def initial(self) -> States:
        """The initial state as a single column, or no column where the domain's start contradicts itself."""
        ground = self.step.ground
        column = np.array([[symbol in ground.initial] for symbol in self.variables], dtype=np.bool_)
        return column.reshape(len(self.variables), 1)[:, : 1 if ground.consistent else 0]

    @cached_property
    def _now(self) -> tuple[int, ...]:
        """The atoms of the variables after the step; 0 where nothing derives a variable."""
        now, bodies = self.step.ground.now, self.step.bodies
        atoms = (now.get(symbol, 0) for symbol in self.variables)
        kept = set(self.step.occurs.values())
        return tuple(atom if atom in bodies or atom in kept else 0 for atom in atoms)

    @cached_property
    def _label_atoms(self) -> tuple[int, ...]:
        return tuple(self.step.ground.now.get(symbol, 0) for symbol in self.labels)

    @cached_property
    def _strata(self) -> list[Stratum]:
        roots = [abs(literal) for body in self.constraints for literal in body.literals]
        return stratify([*roots, *self._now, *self._label_atoms], self.step.bodies)

    @cached_property
    def _readers(self) -> Mapping[int, list[int]]:
        readers: dict[int, list[int]] = {}
        for stratum in self._strata:
            for atom in stratum.atoms:
                for body in self.step.bodies[atom]:
                    for literal in body.literals:
                        readers.setdefault(abs(literal), []).append(atom)
        return readers

    @cached_property
    def _constraint_readers(self) -> Mapping[int, list[int]]:
        readers: dict[int, list[int]] = {}
        for number, body in enumerate(self.constraints):
            for literal in body.literals:
                readers.setdefault(abs(literal), []).append(number)
        return readers

    @cached_property
    def _order(self) -> Mapping[int, int]:
        return {atom: place for place, stratum in enumerate(self._strata) for atom in stratum.atoms}

    @cached_property
    def _moves(self) -> list[_Move]:
        return [_compile(self, atom) for atom in self.step.occurs.values()]

    def accepts(self, states: States) -> Column:
        """Return in which states a plan may end, shape (number of states,)."""
        size = states.shape[1]
        ground = self.step.ground
        columns = {ground.now[s]: row for s, row in zip(self.variables, states, strict=True) if s in ground.now}
        read = _reader(columns, size)
        roots = [abs(literal) for body in self.step.final for literal in body.literals]
        evaluate(stratify(roots, self.step.final_bodies), self.step.final_bodies.__getitem__, columns, read, size)
        broken = np.zeros(size, dtype=np.bool_)
        for body in self.step.final:
            broken |= body_column(body, read, size)
        return ~broken

    def expand(self, states: States) -> Iterable[Successors]:
        """Yield what each action makes of a frontier, in the order of `actions`."""
        size = states.shape[1]
        before = self.step.ground.before
        columns = {before[s]: row for s, row in zip(self.variables, states, strict=True) if s in before}
        read = _reader(columns, size)
        evaluate(self._strata, self.step.bodies.__getitem__, columns, read, size)
        broken: dict[int, Column] = {}
        for number, body in enumerate(self.constraints):
            value = body_column(body, read, size)
            if value.any():
                broken[number] = value
        after = np.stack([read(atom) for atom in self._now]) if self._now else states
        labels = np.stack([read(atom) for atom in self._label_atoms]) if self.labels else np.zeros((0, size), np.bool_)
        for move in self._moves:
            yield self._apply(move, read, broken, after, labels)

    def _apply(
        self,
        move: _Move,
        read: Callable[[int], Column],
        broken: Mapping[int, Column],
        after: States,
        labels: NDArray[np.bool_],
    ) -> Successors:
        size = after.shape[1]
        valid = np.full(size, not move.impossible)
        for number, value in broken.items():
            if number not in move.touched:
                valid &= ~value
        for guard in move.guards:
            valid &= ~body_column(guard, read, size)
        sources = np.flatnonzero(valid)
        columns: dict[int, Column] = {
            atom: np.full(len(sources), value, dtype=np.bool_) for atom, value in move.constants.items()
        }

        def column(atom: int) -> Column:
            if atom not in columns:
                columns[atom] = read(atom)[sources]
            return columns[atom]

        if len(sources):
            evaluate(move.strata, move.bodies.__getitem__, columns, column, len(sources))
            bad = np.zeros(len(sources), dtype=np.bool_)
            for body in move.constraints:
                bad |= body_column(body, column, len(sources))
            if bad.any():
                kept = ~bad
                sources = sources[kept]
                columns = {atom: value[kept] for atom, value in columns.items()}
        return Successors(
            sources,
            _override(after[:, sources], self._now, columns),
            _override(labels[:, sources], self._label_atoms, columns),
        )


def _override(rows: NDArray[np.bool_], atoms: Sequence[int], columns: Mapping[int, Column]) -> NDArray[np.bool_]:
    for place, atom in enumerate(atoms):
        if atom in columns:
            rows[place] = columns[atom]
    return rows


def _reader(columns: Mapping[int, Column], size: int) -> Callable[[int], Column]:
    """Return a reader of columns for which an atom that nothing derives is false."""
    false = np.zeros(size, dtype=np.bool_)
    return lambda atom: columns.get(atom, false)


def build_transition(step: NormalStep, labels: Sequence[clingo.Symbol] = ()) -> Transition:
    """Return the step function of a domain over the cone of influence of its constraints and of `labels`."""
    atoms = [step.ground.now[symbol] for symbol in labels if symbol in step.ground.now]
    cone = find_cone(step, atoms)
    return Transition(step, cone.variables, cone.constraints, tuple(labels))


def _compile(transition: Transition, action: int) -> _Move:
    """Return what is left of the rules once `action` occurs and no other action does."""
    step = transition.step
    affected: set[int] = set()
    waiting = [action]
    while waiting:
        for reader in transition._readers.get(waiting.pop(), ()):
            if reader not in affected:
                affected.add(reader)
                waiting.append(reader)
    constants = {atom: atom == action for atom in step.occurs.values()}
    bodies: dict[int, tuple[Body, ...]] = {}
    strata = []
    for place in sorted({transition._order[atom] for atom in affected}):
        stratum = transition._strata[place]
        inside = set(stratum.atoms) if stratum.recursive else set()
        for atom in stratum.atoms:
            left = [_simplified(body, constants) for body in step.bodies[atom]]
            if any(body is True for body in left):
                constants[atom] = True
            elif atom not in inside and all(body is False for body in left):
                constants[atom] = False
            bodies[atom] = tuple(body for body in left if isinstance(body, Body))
        open_atoms = tuple(atom for atom in stratum.atoms if atom not in constants)
        if open_atoms:
            strata.append(Stratum(open_atoms, stratum.recursive))
    touched = {n for atom in (*affected, action) for n in transition._constraint_readers.get(atom, ())}
    left = [_simplified(transition.constraints[number], constants) for number in sorted(touched)]
    residual = [body for body in left if isinstance(body, Body)]
    written = {*transition._now, *transition._label_atoms}
    direct = [body for body in residual if not any(abs(literal) in affected for literal in body.literals)]
    later = tuple(body for body in residual if body not in direct)
    needed = _needed(strata, bodies, written | {abs(literal) for body in later for literal in body.literals})
    return _Move(
        tuple(direct), needed, bodies, later, frozenset(touched),
        {atom: value for atom, value in constants.items() if atom in written or atom in affected},
        impossible=any(body is True for body in left),
    )  # fmt: skip


def _needed(strata: Sequence[Stratum], bodies: Mapping[int, tuple[Body, ...]], roots: set[int]) -> tuple[Stratum, ...]:
    """Return the strata that the atoms `roots` still depend on after simplification."""
    needed = set(roots)
    found = []
    for stratum in reversed(strata):
        if needed & set(stratum.atoms):
            needed |= {abs(literal) for atom in stratum.atoms for body in bodies[atom] for literal in body.literals}
            found.append(stratum)
    return tuple(reversed(found))


def _simplified(body: Body, constants: Mapping[int, bool]) -> Body | bool:
    """Return a body without its literals of known truth, or its truth where that decides it."""
    if body.weights:
        return _simplified_sum(body, constants)
    literals = []
    for literal in body.literals:
        known = constants.get(abs(literal))
        if known is None:
            literals.append(literal)
        elif known != (literal > 0):
            return False
    return Body(tuple(literals)) if literals else True


def _simplified_sum(body: Body, constants: Mapping[int, bool]) -> Body | bool:
    bound, literals, weights = body.bound, [], []
    for literal, weight in zip(body.literals, body.weights, strict=True):
        known = constants.get(abs(literal))
        if known is None:
            literals.append(literal)
            weights.append(weight)
        elif known == (literal > 0):
            bound -= weight
    if bound <= 0:
        return True
    if sum(weights) < bound:
        return False
    return Body(tuple(literals), bound, tuple(weights))

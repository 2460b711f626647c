"""One step of a domain as ground rules, exactly as clingo grounds them."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import clingo

from prag_asp.errors import EngineError
from prag_asp.logic.ground.derivable import may_derive
from prag_asp.logic.ground.growth import locate_head
from prag_asp.logic.ground.rules import GroundRecorder, Rule, Unsupported
from prag_asp.logic.ground.stationary import Obstacle, StepReads
from prag_asp.program.atom_arrays import ground_atoms
from prag_asp.program.facts import Facts
from prag_asp.program.finite.checks import BoundReached, measure
from prag_asp.program.finite.guards import guard_program
from prag_asp.program.grounding import Grounder, Part
from prag_asp.program.predicates import FINAL, HOLDS, OCCURS, STATE
from prag_asp.program.sources import Program
from prag_asp.program.syntax import Signature

MOST_STEPS = 10**6
"""The largest number of steps that are ground one by one: each takes about a millisecond, and memory."""

STEP = 1_000_000_000
"""The number of the ground step, which no domain uses for anything else."""

FEW_STEPS, MOST_ATOMS, MOST_SYMBOLS = 30, 1_000_000, 10_000
"""The numbers of steps, of atoms, and of symbols in one atom from which a carried predicate counts as endless.

A step may double the symbols of an atom, so that few steps fill the memory.
"""

MOST_GROWING, FEW_AT_ONCE = 20_000, 2
"""The same limits of atoms and of steps between two tests for predicates whose atoms may derive one another."""

PART = re.compile(r"(#program\s+)(base|step)\b")
"""Finds the program parts that an extension has."""

CONTRACT = {HOLDS, OCCURS}

NOW, BEFORE, START = clingo.Number(STEP), clingo.Number(STEP - 1), clingo.Number(0)
OPEN_VALUES = (clingo.Function("true"), clingo.Function("false"))

Seeds = dict[clingo.Symbol, None]
"""The atoms that step t-1 may have, without their time, in the order in which they are declared to clingo."""


@dataclass(frozen=True)
class GroundStep:
    """The ground rules of one step in any state, by program part.

    `names` holds the symbol of every named atom; `before`, `now` and `ending` the atoms of step t-1 and of step t by
    their symbol without its time. `initial` are the timed symbols that hold at the start, without their time;
    `obstacles` are the reasons why the step is no function of the state and the action. With `after_steps_alone`, the
    final check is wrong for a plan without actions: clingo has simplified it by atoms that are true after every step,
    but not initially.
    `grounding` can ground more rules on top of the step (see `extend_step`).
    """

    rules: Mapping[str, tuple[Rule, ...]]
    names: Mapping[int, clingo.Symbol]
    before: Mapping[clingo.Symbol, int]
    now: Mapping[clingo.Symbol, int]
    initial: frozenset[clingo.Symbol]
    consistent: bool
    obstacles: tuple[Obstacle, ...]
    after_steps_alone: bool = False
    grounding: Grounding | None = field(default=None, repr=False, compare=False)


def ground_step(program: Program, facts: Facts, reads: StepReads) -> GroundStep:
    """Ground one step of a program for every state that it may start from.

    The atoms of step t-1 are not known beforehand: the step is ground again until it derives no new ones. If it always
    derives new ones, like an unbounded counter, the result has an obstacle.

    Raises:
        DomainError: clingo cannot ground the program.
    """
    try:
        return _ground_step(program, facts, reads)
    except BoundReached as error:
        # A plan of a given length may not reach the bound: engines that unroll the steps decide that.
        place = f"{error.problem.path}:{error.problem.line}"
        return _unbounded(Obstacle(error.problem.text, place), reads)


def _ground_step(program: Program, facts: Facts, reads: StepReads) -> GroundStep:
    seeds = _seeds(facts, reads)
    started = _start(program, reads)
    if started.initial <= seeds.keys() and not _may_carry(started.grounder, program, reads):
        ground = _ground_once(started, program, seeds, facts, reads)
        if not _unforeseen(ground, seeds, reads):  # the step carries only the state
            return ground
        started = _start(program, reads)
    endless = _add_carried(seeds, program, reads)
    for _ in range(0 if endless else _bounds(program, reads).steps):
        ground = _ground_once(started, program, seeds, facts, reads)
        new = _unforeseen(ground, seeds, reads)
        if not new:
            return ground
        seeds |= dict.fromkeys(sorted(new))
        started = _start(program, reads)
    name, arity = endless or _signature(min(new))
    where = locate_head(program, (name, arity))
    what = f"{name}/{arity} takes new values at every step without end"
    return _unbounded(Obstacle(what, where, "add a condition that ends it"), reads)


def _unbounded(obstacle: Obstacle, reads: StepReads) -> GroundStep:
    """Return an empty step with the obstacle that it always derives new atoms."""
    return GroundStep({}, {}, {}, {}, frozenset(), consistent=True, obstacles=(*reads.obstacles, obstacle))


def _may_carry(grounder: Grounder, program: Program, reads: StepReads) -> bool:
    """Return whether steps may carry anything but the state, given that the start has nothing else."""
    carried = reads.previous - CONTRACT
    return bool(carried) and may_derive(program, grounder.control.symbolic_atoms, CONTRACT, carried)


def _unforeseen(ground: GroundStep, seeds: Seeds, reads: StepReads) -> set[clingo.Symbol]:
    """Return the atoms of the start and of the step that the next step reads, but that `seeds` lacks."""
    new = {symbol for symbol in ground.now if symbol not in seeds and _signature(symbol) in reads.previous}
    if new:
        unsupported = _unsupported(ground, seeds)
        new = {symbol for symbol in new if ground.now[symbol] not in unsupported}
    return new | (ground.initial - seeds.keys())


def _unsupported(ground: GroundStep, seeds: Seeds) -> set[int]:
    """Return the atoms that no rule derives from any state.

    clingo knows an atom that only ``not p(X,t-1)`` mentions, and would carry it along.
    """
    waiting = [rule for part in ground.rules.values() for rule in part]
    derived = {head for rule in waiting for head in rule.heads}
    absent = {atom for symbol, atom in ground.before.items() if symbol not in seeds} - derived
    missing = derived | absent
    while True:
        firing = [rule for rule in waiting if rule.weights or missing.isdisjoint(rule.body)]
        if not firing:
            return missing
        waiting = [rule for rule in waiting if not rule.weights and not missing.isdisjoint(rule.body)]
        missing.difference_update(head for rule in firing for head in rule.heads)


class _Bounds(NamedTuple):
    """The numbers of steps and atoms from which a carried predicate counts as endless.

    `at_once` is the largest number of steps between two tests.
    """

    steps: int = MOST_ATOMS
    atoms: int = MOST_ATOMS
    at_once: int = MOST_ATOMS


def _bounds(program: Program, reads: StepReads) -> _Bounds:
    """Return the bounds of the search for all carried atoms.

    A bounded counter ends at a number that the program names, or not far beyond.
    """
    if not guard_program(program).endless_steps:
        return _Bounds()
    if reads.growing & reads.previous:
        return _Bounds(FEW_STEPS, MOST_GROWING, FEW_AT_ONCE)
    numbers = (int(digits) for digits in re.findall(r"(?<!\d)\d{1,4}(?!\d)", program.text))
    return _Bounds(FEW_STEPS + 2 * max(numbers, default=0))


def _add_carried(seeds: Seeds, program: Program, reads: StepReads) -> Signature | None:
    """Add the atoms that steps may carry to `seeds`; return a predicate that exceeds the bounds, if there is one.

    Steps are ground one after another, and the atoms are tested after 1, 2, 4, ... of them.
    """
    carried = sorted(reads.previous - CONTRACT)
    if not carried:
        return None
    grounder = Grounder(program)
    grounder.ground([("base", [])])
    atoms = grounder.control.symbolic_atoms
    _declare(grounder, seeds | dict.fromkeys(sorted(_initial(grounder, reads))), [])
    most, steps, stated = _bounds(program, reads), 0, len(atoms)
    sizes: dict[clingo.Symbol, int] = {}
    while True:
        more = min(max(steps, 1), most.at_once)
        grounder.ground([("step", [clingo.Number(STEP + step)]) for step in range(steps, steps + more)])
        steps += more
        last = clingo.Number(STEP + steps - 1)
        symbols = [atom.symbol for each in carried for atom in atoms.by_signature(*each)]
        large = next((symbol for symbol in symbols if measure(symbol, sizes, _size) > MOST_SYMBOLS), None)
        if large is not None:
            return _signature(timeless(large))
        seeds |= dict.fromkeys(timeless(symbol) for symbol in symbols if symbol.arguments[-1] != last)
        new = {timeless(symbol) for symbol in symbols if symbol.arguments[-1] == last} - seeds.keys()
        if not new:
            return None
        seeds |= dict.fromkeys(sorted(new))
        if steps > most.steps or len(atoms) - stated > most.atoms:
            return _signature(min(new))


def _size(inner: Iterable[int]) -> int:
    return 1 + sum(inner)


def timeless(symbol: clingo.Symbol) -> clingo.Symbol:
    """Return a timed atom without its last argument."""
    return clingo.Function(symbol.name, symbol.arguments[:-1])


def _signature(symbol: clingo.Symbol) -> Signature:
    return symbol.name, len(symbol.arguments) + 1


def _seeds(facts: Facts, reads: StepReads) -> Seeds:
    """Return the atoms of the contract that step t-1 may have; static fluents have the value of the start."""
    seeds: Seeds = {}
    if HOLDS in reads.previous:
        seeds |= dict.fromkeys(HOLDS.timeless(*each) for each in _open_values(facts))
    if OCCURS in reads.previous:
        seeds |= dict.fromkeys(OCCURS.timeless(action) for action in facts.tried)
    return seeds


def _open_values(facts: Facts) -> Iterator[list[clingo.Symbol]]:
    """Yield each fluent with each value that it may have in a state."""
    static = {fluent: clingo.Function(value) for fluent, value in facts.static}
    for fluent in facts.fluents:
        for value in (static[fluent],) if fluent in static else OPEN_VALUES:
            yield [fluent, value]


def extend_step(
    step: GroundStep, rules: Program, carried: Iterable[clingo.Symbol], reads: StepReads
) -> GroundStep | None:
    """Return a ground step with more rules, which are ground on top of it; None if all has to be ground again.

    A step can be extended once. `rules` may have the parts ``base`` and ``step(t)``; no rule of the step may read what
    they derive. `carried` are the atoms that they derive at one step and read at the next, without their time. `reads`
    describes the step together with the rules.
    """
    grounding = step.grounding
    if grounding is None or grounding.extended or grounding.grounder.control.is_conflicting:
        return None
    grounding.extended = True
    grounder, recorder = grounding.grounder, grounding.recorder
    grounder.add("base", [PART.sub(r"\1extended_\2", f"#program base. {rules.text}")])
    # Besides facts, clingo now adds projections of atoms of the step, which no rule of the extension reads.
    recorder.part = "extended_base"
    grounder.ground([("extended_base", [])])
    recorder.rules.pop("extended_base", None)
    recorder.part = "step"
    _declare(grounder, carried, [])
    grounder.ground([("extended_step", [NOW])])
    if grounder.control.is_conflicting:
        return None
    extended = _recorded(grounder, recorder, reads)
    return None if _unforeseen(extended, dict.fromkeys([*step.before, *carried]), reads) else extended


def _ground_once(started: Grounding, program: Program, seeds: Seeds, facts: Facts, reads: StepReads) -> GroundStep:
    grounder, recorder = started.grounder, started.recorder
    # clingo defines the projection that `not p(_,t)` reads as soon as atoms p(X,t) exist.
    recorder.part = "step"
    # Later steps may add known values of this state: it stays open, so that no goal makes it a fact here.
    open_states = [STATE(*each, NOW) for each in _open_values(facts)]
    _declare(grounder, seeds, open_states)
    _ground_parts(grounder, recorder, ("step", "hindsight"))
    if grounder.control.is_conflicting:
        return _ground_start(program, open_states, reads)
    return replace(_ground_end(started, reads), grounding=started)


def _ground_start(program: Program, open_states: Iterable[clingo.Symbol], reads: StepReads) -> GroundStep:
    """Ground the final check without a step, because no state allows one: clingo grounds nothing after a conflict."""
    started = _start(program, reads)
    started.recorder.part = "step"
    _declare(started.grounder, (), open_states)
    return _ground_end(started, reads)


def _ground_end(started: Grounding, reads: StepReads) -> GroundStep:
    """Ground the checks of the final state, which may be the start."""
    started.recorder.part = "step"
    _open_start(started)
    _ground_parts(started.grounder, started.recorder, ("check", "ending"))
    return _recorded(started.grounder, started.recorder, reads)


def _ground_parts(grounder: Grounder, recorder: GroundRecorder, parts: Iterable[str]) -> None:
    for part in parts:
        recorder.part = part
        grounder.ground([(part, [NOW])])


def _initial(grounder: Grounder, reads: StepReads) -> set[clingo.Symbol]:
    """Return the atoms of the start, without their time."""
    initial: set[clingo.Symbol] = set()
    for signature in reads.timed | reads.previous:
        for (*arguments, time), _, _ in ground_atoms(grounder.control, *signature):
            if time == START:
                initial.add(clingo.Function(signature[0], arguments))
    return initial


def _open_start(started: Grounding) -> None:
    """Declare the atoms of only the initial state as open: the check of a plan without actions reads them."""
    atoms = started.grounder.control.symbolic_atoms
    at_now = (clingo.Function(each.name, [*each.arguments, NOW]) for each in sorted(started.initial))
    started.grounder.leave_open(each for each in at_now if atoms[each] is None)


def _declare(grounder: Grounder, seeds: Iterable[clingo.Symbol], others: Iterable[clingo.Symbol]) -> None:
    """Declare the `seeds` at step t-1 and the `others` as open."""
    grounder.leave_open([*(clingo.Function(each.name, [*each.arguments, BEFORE]) for each in seeds), *others])


def ground_plan(program: Program, length: int, reads: StepReads) -> GroundStep:
    """Ground all steps of plans of a length; `names` then has the atoms of every step.

    Raises:
        DomainError: clingo cannot ground the program.
    """
    started = _start(program, reads)
    started.recorder.part = "step"
    started.grounder.ground(unrolled(length))
    return _recorded(started.grounder, started.recorder, reads)


def unrolled(length: int) -> list[Part]:
    """Return the program parts of plans of a length, after the base.

    Raises:
        EngineError: there are too many steps.
    """
    if length > MOST_STEPS:
        raise EngineError(
            f"length {length:,}: an engine that grounds each step takes at most {MOST_STEPS:,}; "
            "choose a smaller length, or the engine automaton"
        )
    steps: list[Part] = [("step", [clingo.Number(k)]) for k in range(1, length + 1)]
    return [*steps, ("check", [clingo.Number(length)])]


@dataclass
class Grounding:
    """A grounder with at least the base part of a program; `initial` are the atoms of the start without their time."""

    grounder: Grounder
    recorder: GroundRecorder
    initial: set[clingo.Symbol]
    extended: bool = False


def _start(program: Program, reads: StepReads) -> Grounding:
    grounder, recorder = Grounder(program), GroundRecorder(base_facts=False)
    grounder.control.register_observer(recorder)
    grounder.ground([("base", [])])
    return Grounding(grounder, recorder, _initial(grounder, reads))


def _recorded(grounder: Grounder, recorder: GroundRecorder, reads: StepReads) -> GroundStep:
    obstacles = [*reads.obstacles]
    if Unsupported.THEORY in recorder.unsupported:
        obstacles.append(Obstacle(Unsupported.THEORY.value))
    names: dict[int, clingo.Symbol] = {}
    by_time: dict[clingo.Symbol, dict[clingo.Symbol, int]] = {NOW: {}, BEFORE: {}}
    initial: set[clingo.Symbol] = set()
    always: list[clingo.Symbol] = []
    for name, arity in sorted(reads.timed | reads.previous | {STATE, FINAL}):
        for arguments, literal, is_fact in ground_atoms(grounder.control, name, arity):
            symbol, (*others, time) = clingo.Function(name, arguments), arguments
            if not (literal or is_fact):  # only `not` reads it
                continue
            if time == START:
                initial.add(clingo.Function(name, others))
                if not is_fact:
                    obstacles.append(Obstacle(f"{symbol} depends on a choice: plans do not begin in one state"))
                continue
            if time == NOW and is_fact and (name, arity) in reads.timed & (reads.last | CONTRACT):
                always.append(clingo.Function(name, others))
            names[literal] = symbol
            if time in by_time:
                by_time[time][clingo.Function(name, others)] = literal
    if any(rule.heads for rule in recorder.rules.get("base", [])):
        obstacles.append(Obstacle("the base part makes a choice"))
    return GroundStep(
        {part: tuple(rules) for part, rules in recorder.rules.items()},
        names, by_time[BEFORE], by_time[NOW], frozenset(initial),
        consistent=not any(not rule.heads for rule in recorder.rules.get("base", [])),
        obstacles=tuple(dict.fromkeys(obstacles)), after_steps_alone=any(each not in initial for each in always),
    )  # fmt: skip

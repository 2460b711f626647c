"""One step of a domain as ground rules, exactly as clingo made them."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import NamedTuple

import clingo

from prag_asp.errors import EngineError
from prag_asp.logic.ground.derivable import may_derive
from prag_asp.logic.ground.growth import locate_head
from prag_asp.logic.ground.rules import GroundRecorder, Rule, Unsupported
from prag_asp.logic.ground.stationary import Obstacle, StepReads
from prag_asp.program.atom_arrays import ground_atoms
from prag_asp.program.facts import Facts
from prag_asp.program.finite.checks import BoundReached, measured
from prag_asp.program.finite.guards import guarded
from prag_asp.program.grounding import Grounder, Part
from prag_asp.program.predicates import FINAL, HOLDS, OCCURS, STATE
from prag_asp.program.sources import Program
from prag_asp.program.syntax import Signature

MOST_STEPS = 10**6
"""Steps that are ground one by one at most: each takes a millisecond, and memory."""

STEP = 1_000_000_000
"""The number of the step that is grounded: one that no domain uses for anything else."""

FEW_STEPS, MOST_ATOMS, MOST_SYMBOLS = 30, 1_000_000, 10_000
"""Where a predicate that carries something along is held to go on without end: after so many steps, or atoms, or where
one of its atoms is made of so many symbols: a step may double them."""

MOST_GROWING, FEW_AT_ONCE = 20_000, 2
"""So many atoms, where each may be made of others; they are looked at after so many steps, which may double them."""

CONTRACT = {HOLDS, OCCURS}

NOW, BEFORE, START = clingo.Number(STEP), clingo.Number(STEP - 1), clingo.Number(0)
OPEN_VALUES = (clingo.Function("true"), clingo.Function("false"))

Seeds = dict[clingo.Symbol, None]
"""What step t-1 may have, timed atoms without their time, in the order in which clingo is told of them."""


@dataclass(frozen=True)
class GroundStep:
    """The ground rules of one step in any state, by program part.

    `names` holds the symbol of every named atom; `before`, `now` and `ending` the atoms of step t-1 and of step t by
    their symbol without its time. `initial` are the timed symbols that hold at the start, without their time;
    `obstacles` says why the step is not a function of the state and the action, where it is not. What judges a plan is
    right `after_steps_alone` where every step makes something so that the start does not: clingo takes it for granted.
    """

    rules: Mapping[str, tuple[Rule, ...]]
    names: Mapping[int, clingo.Symbol]
    before: Mapping[clingo.Symbol, int]
    now: Mapping[clingo.Symbol, int]
    initial: frozenset[clingo.Symbol]
    consistent: bool
    obstacles: tuple[Obstacle, ...]
    after_steps_alone: bool = False


def ground_step(program: Program, facts: Facts, reads: StepReads) -> GroundStep:
    """Ground one step of a program for every state that it may start from.

    Which atoms step t-1 may have is not known beforehand: the step is grounded again until it makes no new ones. Where
    it makes new ones without end, such as a counter without a bound, the result has an obstacle that says so.

    Raises:
        DomainError: clingo cannot ground the program.
    """
    try:
        return _ground_step(program, facts, reads)
    except BoundReached as error:
        # No plan of some length needs to come so far: the engines that ground each step by itself find out.
        place = f"{error.problem.path}:{error.problem.line}"
        return _unbounded(Obstacle(error.problem.text, place), reads)


def _ground_step(program: Program, facts: Facts, reads: StepReads) -> GroundStep:
    seeds = _seeds(facts, reads)
    started = _start(program, reads)
    if started.initial <= seeds.keys() and not _may_carry(started.grounder, program, reads):
        ground = _ground_once(started, program, seeds, facts, reads)
        if not _unforeseen(ground, seeds, reads):  # nothing but the state is carried along
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
    """Return a step of which nothing is known but that it may make ever more."""
    return GroundStep({}, {}, {}, {}, frozenset(), consistent=True, obstacles=(*reads.obstacles, obstacle))


def _may_carry(grounder: Grounder, program: Program, reads: StepReads) -> bool:
    """Return whether steps may carry anything but the state, where the start has nothing else to carry."""
    carried = reads.previous - CONTRACT
    return bool(carried) and may_derive(program, grounder.control.symbolic_atoms, CONTRACT, carried)


def _unforeseen(ground: GroundStep, seeds: Seeds, reads: StepReads) -> set[clingo.Symbol]:
    """Return what the start or a step makes that the next step reads, but that was not left open before it."""
    made = {symbol for symbol in ground.now if symbol not in seeds and _signature(symbol) in reads.previous}
    if made:
        unsupported = _unsupported(ground, seeds)
        made = {symbol for symbol in made if ground.now[symbol] not in unsupported}
    return made | (ground.initial - seeds.keys())


def _unsupported(ground: GroundStep, seeds: Seeds) -> set[int]:
    """Return the atoms that no rule derives, whatever the step before was.

    Where ``not p(X,t-1)`` is all that is said of an atom, clingo knows it nevertheless, and carries it on.
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
    """After how many steps or atoms what still takes new values is held to take them without end.

    It is looked at after so many steps at once, or fewer.
    """

    steps: int = MOST_ATOMS
    atoms: int = MOST_ATOMS
    at_once: int = MOST_ATOMS


def _bounds(program: Program, reads: StepReads) -> _Bounds:
    """Return how far it is looked for the end of what steps carry along.

    A counter that is bounded ends at a number that the program names, or not far beyond.
    """
    if not guarded(program).endless_steps:
        return _Bounds()
    if reads.growing & reads.previous:
        return _Bounds(FEW_STEPS, MOST_GROWING, FEW_AT_ONCE)
    numbers = (int(digits) for digits in re.findall(r"(?<!\d)\d{1,4}(?!\d)", program.text))
    return _Bounds(FEW_STEPS + 2 * max(numbers, default=0))


def _add_carried(seeds: Seeds, program: Program, reads: StepReads) -> Signature | None:
    """Add to `seeds` what steps may carry along; return a predicate that does not come to an end.

    Steps are ground one after another, and looked at after 1, 2, 4, ... of them, within bounds.
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
        found = [atom.symbol for each in carried for atom in atoms.by_signature(*each)]
        large = next((symbol for symbol in found if measured(symbol, sizes, _size) > MOST_SYMBOLS), None)
        if large is not None:
            return _signature(timeless(large))
        seeds |= dict.fromkeys(timeless(symbol) for symbol in found if symbol.arguments[-1] != last)
        new = {timeless(symbol) for symbol in found if symbol.arguments[-1] == last} - seeds.keys()
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
    """Return what step t-1 may have by the contract; static fluents have the value of the start."""
    seeds: Seeds = {}
    if HOLDS in reads.previous:
        seeds |= dict.fromkeys(HOLDS.timeless(*each) for each in _open_values(facts))
    if OCCURS in reads.previous:
        seeds |= dict.fromkeys(OCCURS.timeless(action) for action in facts.tried)
    return seeds


def _open_values(facts: Facts) -> Iterator[list[clingo.Symbol]]:
    """Yield the fluents, each with each value that a state may give it."""
    static = {fluent: clingo.Function(value) for fluent, value in facts.static}
    for fluent in facts.fluents:
        for value in (static[fluent],) if fluent in static else OPEN_VALUES:
            yield [fluent, value]


def _ground_once(started: _Started, program: Program, seeds: Seeds, facts: Facts, reads: StepReads) -> GroundStep:
    grounder, recorder = started.grounder, started.recorder
    # What `not p(_,t)` reads is defined by rules that clingo makes as soon as the atoms p(X,t) are there.
    recorder.part = "step"
    # What later steps tell of the state after this one is open as well: no goal may make it a fact here.
    told = [STATE(*each, NOW) for each in _open_values(facts)]
    _declare(grounder, seeds, told)
    _ground_parts(grounder, recorder, ("step", "hindsight"))
    if grounder.control.is_conflicting:
        return _ground_start(program, told, reads)
    return _ground_end(started, reads)


def _ground_start(program: Program, told: Iterable[clingo.Symbol], reads: StepReads) -> GroundStep:
    """Ground what judges a plan without a step, where no state allows one: clingo grounds nothing after a conflict."""
    started = _start(program, reads)
    started.recorder.part = "step"
    _declare(started.grounder, (), told)
    return _ground_end(started, reads)


def _ground_end(started: _Started, reads: StepReads) -> GroundStep:
    """Ground what judges the state after a step, or that at the start."""
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
    found: set[clingo.Symbol] = set()
    for signature in reads.timed | reads.previous:
        for (*arguments, time), _, _ in ground_atoms(grounder.control, *signature):
            if time == START:
                found.add(clingo.Function(signature[0], arguments))
    return found


def _open_start(started: _Started) -> None:
    """Leave open which atoms that only the start has are there: the check of a plan without a step reads them."""
    atoms = started.grounder.control.symbolic_atoms
    at_now = (clingo.Function(each.name, [*each.arguments, NOW]) for each in sorted(started.initial))
    started.grounder.leave_open(each for each in at_now if atoms[each] is None)


def _declare(grounder: Grounder, seeds: Iterable[clingo.Symbol], told: Iterable[clingo.Symbol]) -> None:
    """Leave open what step t-1 may have, and the atoms `told`."""
    grounder.leave_open([*(clingo.Function(each.name, [*each.arguments, BEFORE]) for each in seeds), *told])


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


class _Started(NamedTuple):
    """The base part of a program, ground, and what holds at the start, without its time."""

    grounder: Grounder
    recorder: GroundRecorder
    initial: set[clingo.Symbol]


def _start(program: Program, reads: StepReads) -> _Started:
    grounder, recorder = Grounder(program), GroundRecorder(base_facts=False)
    grounder.control.register_observer(recorder)
    grounder.ground([("base", [])])
    return _Started(grounder, recorder, _initial(grounder, reads))


def _recorded(grounder: Grounder, recorder: GroundRecorder, reads: StepReads) -> GroundStep:
    obstacles = [*reads.obstacles]
    if Unsupported.THEORY in recorder.unsupported:
        obstacles.append(Obstacle(Unsupported.THEORY.value))
    names: dict[int, clingo.Symbol] = {}
    found: dict[clingo.Symbol, dict[clingo.Symbol, int]] = {NOW: {}, BEFORE: {}}
    initial: set[clingo.Symbol] = set()
    always: list[clingo.Symbol] = []
    for name, arity in sorted(reads.timed | reads.previous | {STATE, FINAL}):
        for arguments, literal, is_fact in ground_atoms(grounder.control, name, arity):
            symbol, (*others, time) = clingo.Function(name, arguments), arguments
            if not (literal or is_fact):  # it is read by `not` alone
                continue
            if time == START:
                initial.add(clingo.Function(name, others))
                if not is_fact:
                    obstacles.append(Obstacle(f"{symbol} depends on a choice: plans do not begin in one state"))
                continue
            if time == NOW and is_fact and (name, arity) in reads.timed & (reads.last | CONTRACT):
                always.append(clingo.Function(name, others))
            names[literal] = symbol
            if time in found:
                found[time][clingo.Function(name, others)] = literal
    if any(rule.heads for rule in recorder.rules.get("base", [])):
        obstacles.append(Obstacle("the base part makes a choice"))
    return GroundStep(
        {part: tuple(rules) for part, rules in recorder.rules.items()},
        names, found[BEFORE], found[NOW], frozenset(initial),
        consistent=not any(not rule.heads for rule in recorder.rules.get("base", [])),
        obstacles=tuple(dict.fromkeys(obstacles)), after_steps_alone=any(each not in initial for each in always),
    )  # fmt: skip

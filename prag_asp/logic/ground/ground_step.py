"""One step of a domain as ground rules, exactly as clingo grounds them."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import clingo

from prag_asp.logic.ground.carried_atoms import carried_atoms
from prag_asp.logic.ground.growth import locate_head
from prag_asp.logic.ground.rules import GroundRecorder, Rule, Unsupported
from prag_asp.logic.ground.stationary import Obstacle, StepReads
from prag_asp.program.atom_arrays import ground_atoms
from prag_asp.program.facts import Facts
from prag_asp.program.finite.checks import BoundReached, measure
from prag_asp.program.finite.guards import guard_program
from prag_asp.program.grounding import Grounder, ProgramPart
from prag_asp.program.predicates import FINAL, HOLDS, OCCURS, STATE
from prag_asp.program.sources import Program
from prag_asp.program.syntax import Signature, spelled

STEP = 1_000_000_000
"""The number of the ground step, which no domain uses for anything else."""

FEW_STEPS, MOST_ATOMS, MOST_SYMBOLS = 30, 1_000_000, 10_000
"""The numbers of steps, of atoms, and of symbols in one atom above which a carried predicate counts as unbounded. A
step may double the number of symbols of an atom, so a few steps may exhaust the memory."""

MOST_GROWING, FEW_AT_ONCE = 20_000, 2
"""The corresponding limits on atoms, and on steps between two tests, for predicates whose atoms may derive one another.
"""

FAR, MOST_FORESEEN = 32, 25_000
"""The number of steps after which the atoms of all later steps are found at once, and the maximum number of these
atoms: grounding a step for this many takes half a minute."""

PART = re.compile(r"(#program\s+)(base|step)\b")
"""The pattern that finds the program parts of an extension."""

CONTRACT = {HOLDS, OCCURS}

NOW, BEFORE, START = clingo.Number(STEP), clingo.Number(STEP - 1), clingo.Number(0)
OPEN_VALUES = (clingo.Function("true"), clingo.Function("false"))

Seeds = dict[clingo.Symbol, None]
"""The atoms that step t-1 may have, without their time, in the order in which they are declared to clingo."""


@dataclass(frozen=True, eq=False)
class GroundStep:
    """The ground rules of one step in any state, keyed by program part; equality is identity.

    `names` holds the symbol of every named atom; `before` and `now` hold the atoms of step t-1 and of step t, keyed by
    their symbol without its time. `initial` are the timed symbols that hold initially, without their time; `obstacles`
    are the reasons why the step is not a function of the state and the action. With `after_steps_alone`, the final
    check is wrong for a plan without actions: clingo has simplified it using atoms that are true after every step but
    not initially. `grounding` can ground more rules on top of the step (see `extend_step`).
    """

    rules: Mapping[str, tuple[Rule, ...]]
    names: Mapping[int, clingo.Symbol]
    before: Mapping[clingo.Symbol, int]
    now: Mapping[clingo.Symbol, int]
    initial: frozenset[clingo.Symbol]
    consistent: bool
    obstacles: tuple[Obstacle, ...]
    after_steps_alone: bool = False
    grounding: Grounding | None = field(default=None, repr=False)


def ground_step(program: Program, facts: Facts, reads: StepReads) -> GroundStep:
    """Ground one step of a program for every state from which it may start.

    The atoms of step t-1 are not known beforehand: the step is grounded again until it derives no new ones. A step that
    carries only the state is grounded once. A step that carries more, like the hierarchy of `kitchen`, is grounded at
    least twice, because clingo instantiates the rules that read an atom only if the atom was declared before. If a step
    always derives new atoms, like an unbounded counter, the result has an obstacle.

    Raises:
        DomainError: clingo cannot ground the program.
    """
    static = {fluent: (clingo.Function(value),) for fluent, value in facts.static}
    values = [(fluent, value) for fluent in facts.fluents for value in static.get(fluent, OPEN_VALUES)]
    seeds: Seeds = {}
    if HOLDS in reads.previous:
        seeds |= dict.fromkeys(HOLDS.timeless(*each) for each in values)
    if OCCURS in reads.previous:
        seeds |= dict.fromkeys(OCCURS.timeless(action) for action in facts.tried)
    # Later steps may add known values of this state, so it stays open, and no goal makes it a fact here.
    open_states = [STATE(*each, NOW) for each in values]
    complete_steps = 0
    # A step with growing atoms, as of conditions, is nearly always grounded again, and clingo reports rules slowly.
    recorded = not reads.growing & reads.previous
    try:
        while True:
            started = _start(program, reads, recorded=recorded)
            seeds |= dict.fromkeys(sorted(started.initial))
            known = len(seeds)
            _declare(started.grounder, seeds, open_states)
            endless = _ground_until_closed(started.grounder, seeds, program, reads)
            if endless is None and len(seeds) == known and recorded:  # the step is grounded for all atoms it carries
                ground = _ground_end(started, program, open_states, reads)
                new = _unforeseen(ground, seeds, reads)
                if not new:
                    return ground
                seeds |= dict.fromkeys(sorted(new))
                complete_steps += 1
                endless = _signature(min(new)) if complete_steps == _bounds(program, reads).steps else None
            recorded = True
            if endless:
                what = f"{spelled(endless)} takes new values at every step without end"
                obstacle = Obstacle(what, locate_head(program, endless), "add a condition that ends it")
                break
    except BoundReached as error:
        # A plan of a given length may not reach the bound: engines that unroll the steps decide that.
        obstacle = Obstacle(error.problem.text, f"{error.problem.path}:{error.problem.line}")
    return GroundStep({}, {}, {}, {}, frozenset(), consistent=True, obstacles=(*reads.obstacles, obstacle))


def _unforeseen(ground: GroundStep, seeds: Seeds, reads: StepReads) -> set[clingo.Symbol]:
    """Return the atoms of the initial state and of the step that the next step reads but that `seeds` lacks."""
    new = {symbol for symbol in ground.now if symbol not in seeds and _signature(symbol) in reads.previous}
    if new:
        unsupported = _unsupported(ground, seeds)
        new = {symbol for symbol in new if ground.now[symbol] not in unsupported}
    return new | (ground.initial - seeds.keys())


def _unsupported(ground: GroundStep, seeds: Seeds) -> set[int]:
    """Return the atoms that no rule derives from any state.

    clingo also records atoms that occur only in ``not p(X,t-1)``; these must not be carried along.
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
    """The numbers of steps and atoms above which a predicate counts as unbounded, and of steps between two tests."""

    steps: int = MOST_ATOMS
    atoms: int = MOST_ATOMS
    at_once: int = MOST_ATOMS


def _bounds(program: Program, reads: StepReads) -> _Bounds:
    """Return the bounds of the search for all carried atoms.

    A bounded counter ends at or just beyond a number in the program.
    """
    if not guard_program(program).endless_steps:
        return _Bounds()
    if reads.growing & reads.previous:
        return _Bounds(FEW_STEPS, MOST_GROWING, FEW_AT_ONCE)
    numbers = (int(digits) for digits in re.findall(r"(?<!\d)\d{1,4}(?!\d)", program.text))
    return _Bounds(FEW_STEPS + 2 * max(numbers, default=0))


def _ground_until_closed(grounder: Grounder, seeds: Seeds, program: Program, reads: StepReads) -> Signature | None:
    """Ground a step, and further steps as long as they carry new atoms, which are added to `seeds`.

    Return a predicate that exceeds the bounds, or None. The atoms are tested after 1, 2, 4, ... steps.
    """
    atoms = grounder.control.symbolic_atoms
    carried = sorted(reads.previous - CONTRACT)
    steps, more, stated = 0, 1, len(atoms)
    sizes: dict[clingo.Symbol, int] = {}
    while True:
        grounder.ground([("step", [clingo.Number(STEP + step)]) for step in range(steps, steps + more)])
        steps += more
        last = clingo.Number(STEP + steps - 1)
        symbols = [atom.symbol for each in carried for atom in atoms.by_signature(*each)]
        for symbol in symbols:
            if measure(symbol, sizes, lambda inner: 1 + sum(inner)) > MOST_SYMBOLS:
                return _signature(timeless(symbol))
        # The atoms of step t-1 include those that rules read by `not not`, for which they are already ground.
        before = seeds.keys() | {timeless(symbol) for symbol in symbols if symbol.arguments[-1] != last}
        new = {timeless(symbol) for symbol in symbols if symbol.arguments[-1] == last} - before
        seeds |= dict.fromkeys(timeless(symbol) for symbol in symbols if symbol.arguments[-1] not in (START, BEFORE))
        if not new:
            return None
        bounds = _bounds(program, reads)
        if steps > bounds.steps or len(atoms) - stated > bounds.atoms:
            return _signature(min(new))
        if steps == FAR:
            foreseen = carried_atoms(program, NOW, seeds, carried) - seeds.keys()
            if len(foreseen) > MOST_FORESEEN:
                return _signature(min(new))
            if foreseen:
                seeds |= dict.fromkeys(sorted(foreseen))
                return None
        more = min(steps, bounds.at_once)


def timeless(symbol: clingo.Symbol) -> clingo.Symbol:
    """Return a timed atom without its last argument, the time."""
    return clingo.Function(symbol.name, symbol.arguments[:-1])


def _signature(symbol: clingo.Symbol) -> Signature:
    return symbol.name, len(symbol.arguments) + 1


def extend_step(
    step: GroundStep, rules: Program, carried: Iterable[clingo.Symbol], reads: StepReads
) -> GroundStep | None:
    """Return a ground step with more rules ground on top of it, or None if everything has to be ground again.

    A step can be extended once. `rules` may have the parts ``base`` and ``step(t)``; no rule of the step may read an
    atom that `rules` derives. `carried` are the atoms, without their time, that `rules` derives at one step and reads
    at the next. `reads` describes the step together with the rules.
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


def _ground_end(
    started: Grounding, program: Program, open_states: Sequence[clingo.Symbol], reads: StepReads
) -> GroundStep:
    """Ground hindsight and the checks of the final state, which may be the initial state, on top of a step.

    If no state allows a step, the checks are grounded without it, because clingo grounds nothing after a conflict.
    """
    started.ground("hindsight")
    ends = started
    if started.grounder.control.is_conflicting:
        ends = _start(program, reads)
        _declare(ends.grounder, (), open_states)
    # The check of a plan without actions reads atoms that only the initial state has: they stay open.
    atoms = ends.grounder.control.symbolic_atoms
    at_now = (clingo.Function(each.name, [*each.arguments, NOW]) for each in sorted(ends.initial))
    ends.recorder.part = "step"
    ends.grounder.leave_open(each for each in at_now if atoms[each] is None)
    ends.ground("check")
    ends.ground("ending")
    ground = _recorded(ends.grounder, ends.recorder, reads)
    return replace(ground, grounding=started) if ends is started else ground


def _declare(grounder: Grounder, seeds: Iterable[clingo.Symbol], others: Iterable[clingo.Symbol]) -> None:
    """Declare the atoms `seeds` at step t-1 and the atoms `others` as open."""
    grounder.leave_open([*(clingo.Function(each.name, [*each.arguments, BEFORE]) for each in seeds), *others])


def ground_plan(program: Program, length: int, reads: StepReads) -> GroundStep:
    """Ground all steps of plans of a given length; `names` then contains the atoms of every step.

    Raises:
        DomainError: clingo cannot ground the program.
    """
    started = _start(program, reads)
    started.grounder.ground(unrolled(length))
    return _recorded(started.grounder, started.recorder, reads)


def unrolled(length: int) -> list[ProgramPart]:
    """Return the program parts of plans of a given length, after the base."""
    steps: list[ProgramPart] = [("step", [clingo.Number(k)]) for k in range(1, length + 1)]
    return [*steps, ("check", [clingo.Number(length)])]


@dataclass
class Grounding:
    """A grounder with at least the base part of a program; `initial` are the initial atoms without their time.

    Rules are recorded as those of a step unless `ground` grounds another part.
    """

    grounder: Grounder
    recorder: GroundRecorder
    initial: set[clingo.Symbol]
    extended: bool = False

    def ground(self, part: str) -> None:
        """Ground a part with the step number, and record its rules."""
        self.recorder.part = part
        self.grounder.ground([(part, [NOW])])


def _start(program: Program, reads: StepReads, *, recorded: bool = True) -> Grounding:
    """Ground the base part; if `recorded`, rules that are ground afterwards are recorded as those of a step."""
    recorder = GroundRecorder(base_facts=False)
    grounder = Grounder(program, observer=recorder if recorded else None)
    grounder.ground([("base", [])])
    # From here on, clingo defines the projection that `not p(_,t)` reads as soon as atoms p(X,t) exist.
    recorder.part = "step"
    initial: set[clingo.Symbol] = set()
    for name, arity in reads.timed | reads.previous:
        for (*arguments, time), _, _ in ground_atoms(grounder.control, name, arity):
            if time == START:
                initial.add(clingo.Function(name, arguments))
    return Grounding(grounder, recorder, initial)


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
            if not (literal or is_fact):  # only `not` reads it
                continue
            *others, time = arguments
            untimed = clingo.Function(name, others)
            if time == START:
                initial.add(untimed)
                if not is_fact:
                    spelled_atom = clingo.Function(name, arguments)
                    obstacles.append(
                        Obstacle(f"{spelled_atom} depends on a choice, so the initial state is not unique")
                    )
                continue
            if time == NOW and is_fact and (name, arity) in reads.timed & (reads.last | CONTRACT):
                always.append(untimed)
            names[literal] = clingo.Function(name, arguments)
            if time in by_time:
                by_time[time][untimed] = literal
    if any(rule.heads for rule in recorder.rules.get("base", [])):
        obstacles.append(Obstacle("the base part makes a choice"))
    return GroundStep(
        {part: tuple(rules) for part, rules in recorder.rules.items()},
        names, by_time[BEFORE], by_time[NOW], frozenset(initial),
        consistent=not any(not rule.heads for rule in recorder.rules.get("base", [])),
        obstacles=tuple(dict.fromkeys(obstacles)), after_steps_alone=any(each not in initial for each in always),
    )  # fmt: skip

"""The logic of one domain: its program, ground step, symmetries and step functions, each computed once on demand."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import clingo

from prag_asp.domain.load import Domain
from prag_asp.logic.symmetry.symmetries import Symmetries
from prag_asp.processes.progress_events import stage
from prag_asp.program.paths import data_folder
from prag_asp.program.sources import ADDED, Program, read_text

if TYPE_CHECKING:
    from prag_asp.logic.ground.ground_step import GroundStep
    from prag_asp.logic.ground.stationary import Obstacle, StepReads
    from prag_asp.logic.step.normal import NormalStep
    from prag_asp.logic.step.transition import Transition

INTERCHANGEABLE = "looking for interchangeable entities"
LOOP_FREE = ("conditions", "loop_free.lp")


def logic_of(domain: Domain) -> DomainLogic:
    """Return the logic of a domain, which all its spaces share."""
    if "logic" not in domain.derived:
        domain.derived["logic"] = DomainLogic(domain)
    logic: DomainLogic = domain.derived["logic"]
    return logic


@dataclass(frozen=True)
class DomainLogic:
    """The logic of a domain.

    If a step is not a function of the state and the action, `step` and `transition` raise an EngineError with the
    reason. Everything else works on the unrolled program.

    `bare` is the logic of the domain without conditions, for a domain under conditions. Conditions may distinguish
    entities, so renamings must preserve the rules of both logics.

    `part_of` is a logic whose plans include all plans of this one, as a subset that is closed under the renamings of
    `part_of`. Plans are then counted up to these renamings, so that the tasks of all parts together are the tasks of
    `part_of`.
    """

    domain: Domain
    bare: DomainLogic | None = None
    part_of: DomainLogic | None = None

    @cached_property
    def program(self) -> Program:
        """The program whose answer sets are plans."""
        from prag_asp.logic.ground.program import whole_program  # noqa: PLC0415 - not needed for counts from a cached automaton

        return whole_program(self.domain)

    @cached_property
    def whole(self) -> DomainLogic:
        """The logic without pruning, in which every action is tried from every state."""
        facts = self.domain.facts
        if not (facts.unreachable or facts.static):
            return self
        domain = replace(self.domain, facts=replace(facts, unreachable=(), static=()))
        return replace(self, domain=domain, bare=self.bare and self.bare.whole)

    @cached_property
    def reads(self) -> StepReads:
        """The predicates of the previous step that a step reads."""
        from prag_asp.logic.ground.stationary import read_step  # noqa: PLC0415 - not needed for counts from a cached automaton

        return read_step(self.domain.program)

    @cached_property
    def ground(self) -> GroundStep:
        """One ground step.

        Raises:
            EngineError: a step reads more than the previous step.
        """
        if self.reads.obstacles:
            raise self.reads.obstacles[0].error()
        from prag_asp.logic.ground.ground_step import ground_step  # noqa: PLC0415 - not needed for counts from a cached automaton

        return ground_step(self.program, self.domain.facts, self.reads)

    @property
    def obstacles(self) -> tuple[Obstacle, ...]:
        """The reasons why a step is not a function of the state and the action."""
        return self.reads.obstacles or self.ground.obstacles

    @cached_property
    def step(self) -> NormalStep:
        """One step in normal form."""
        from prag_asp.logic.step.strata import stratified_step  # noqa: PLC0415 - not needed for counts from a cached automaton

        ground = self.ground
        stage("preparing the step")
        return stratified_step(ground)

    def symmetries(self, length: int) -> Symmetries:
        """Return which entities are interchangeable in plans of a given length.

        In most domains, the result is the same at all lengths. Pruned actions are also considered: two entities are
        interchangeable only if the whole program treats them alike.
        """
        if self.part_of is not None:
            return self.part_of.symmetries(length)
        if self.whole is not self:
            from prag_asp.logic.symmetry.symmetry import may_interchange  # noqa: PLC0415 - not needed for plans and skeletons

            return self.whole.symmetries(length) if may_interchange(self.domain.facts) else Symmetries()
        if not self._without_loops.obstacles:
            return self._without_loops._symmetries
        from prag_asp.logic.ground.ground_step import ground_plan  # noqa: PLC0415 - not needed for counts from a cached automaton

        return self._find_symmetries(lambda model: ground_plan(model.program, length, model.reads))

    def groups(self, length: int) -> tuple[tuple[clingo.Symbol, ...], ...]:
        """Return the groups of entities whose members are pairwise interchangeable in plans of a given length."""
        return self.symmetries(length).groups

    @cached_property
    def _symmetries(self) -> Symmetries:
        return self._find_symmetries(lambda model: model.ground)

    def _find_symmetries(self, ground: Callable[[DomainLogic], GroundStep]) -> Symmetries:
        """Return which entities are interchangeable, found on the program that `ground` grounds.

        If the domain states invariants for some entities that are only entailed for others, all entailed invariants are
        added first.
        """
        from prag_asp.logic.symmetry.symmetry import find_symmetries  # noqa: PLC0415 - not needed for plans and skeletons

        bare = self.bare
        beside = None if bare is None else lambda: ground(bare._closed() or bare)

        def alike(model: DomainLogic) -> Symmetries:
            program = ground(model)
            stage(INTERCHANGEABLE)
            return find_symmetries(model.domain.facts, program, beside)

        symmetries = alike(self)
        closed = self._closed(symmetries.groups)
        return symmetries if closed is None else alike(closed)

    def _closed(self, groups: Collection[Sequence[clingo.Symbol]] = ()) -> DomainLogic | None:
        """Return the logic with all entailed invariants, or None if it cannot have more symmetries than `groups`."""
        from prag_asp.logic.ground.program import closed_program  # noqa: PLC0415 - not needed for plans and skeletons
        from prag_asp.logic.symmetry.asymmetric_invariants import states_unevenly  # noqa: PLC0415

        if not states_unevenly(self.domain.facts, groups) or (program := closed_program(self.domain)) is None:
            return None
        return DomainLogic(replace(self.domain, program=program))

    @cached_property
    def _without_loops(self) -> DomainLogic:
        """The logic without the rules that forbid loops, which read all previous steps and treat all entities alike.

        The unrolled program of a given length is not a replacement: clingo simplifies it for the initial state.
        """
        sources, shipped = self.domain.program.sources, data_folder("encodings").joinpath(*LOOP_FREE)
        remaining = tuple(
            source for source in sources if source.path.parts[-2:] != LOOP_FREE or source.text != read_text(shipped)
        )
        if len(remaining) == len(sources):
            return self
        return replace(self, domain=replace(self.domain, program=Program(remaining)))

    @cached_property
    def _task_step(self) -> NormalStep:
        """One step of tasks in normal form, ground on top of the step of plans if possible."""
        from prag_asp.logic.ground.ground_step import extend_step  # noqa: PLC0415 - as above
        from prag_asp.logic.ground.program import canonical_extension  # noqa: PLC0415
        from prag_asp.logic.step.strata import stratified_step  # noqa: PLC0415

        program, symmetries = self.task_program(0), self.symmetries(0)
        extension = canonical_extension(self.domain, symmetries.groups, symmetries.joint)
        if extension is not None:
            step = extend_step(self.ground, *extension, self._reads(program))
            if step is not None:
                return stratified_step(step)
        return self._stratified(program)

    @cached_property
    def _transitions(self) -> dict[bool, Transition]:
        """The step functions of plans (key False) and of tasks (key True), shared by all levels and engines."""
        return {}

    def _stratified(self, program: Program) -> NormalStep:
        """Return one step of a program in normal form."""
        from prag_asp.logic.ground.ground_step import ground_step  # noqa: PLC0415 - as above
        from prag_asp.logic.step.strata import stratified_step  # noqa: PLC0415

        return stratified_step(ground_step(program, self.domain.facts, self._reads(program)))

    def _reads(self, program: Program) -> StepReads:
        """Return the predicates that a step of a program reads, ignoring the facts that the library adds."""
        from prag_asp.logic.ground.stationary import read_step  # noqa: PLC0415 - as above

        return read_step(Program(tuple(source for source in program.sources if source.path != ADDED)))

    def task_program(self, length: int) -> Program:
        """Return the program whose answer sets are tasks of a given length: plans with canonical names of entities."""
        symmetries = self.symmetries(length)
        if not symmetries:
            return self.program
        if symmetries not in self._canonical:
            from prag_asp.logic.ground.program import canonical_program  # noqa: PLC0415 - as above

            self._canonical[symmetries] = canonical_program(self.domain, symmetries.groups, symmetries.joint)
        return self._canonical[symmetries]

    @cached_property
    def _canonical(self) -> dict[Symmetries, Program]:
        """The programs of tasks; the keys are symmetries."""
        return {}

    def transition(
        self, *, tasks: bool, weighed: Sequence[str] = (), labels: Sequence[clingo.Symbol] = ()
    ) -> Transition:
        """Return the step function of plans, or of tasks.

        `weighed` contains facts to add, together with ``rules/weights.lp``. The edges are labelled with the atoms
        `labels`.

        Raises:
            EngineError: the step is not a function of the state and the action.
        """
        if self.obstacles:
            raise self.obstacles[0].error()
        from prag_asp.logic.ground.program import weighing_program  # noqa: PLC0415 - as above
        from prag_asp.logic.step.transition import build_transition  # noqa: PLC0415

        reduces = tasks and bool(self.symmetries(0))
        if not weighed and not labels:
            if reduces not in self._transitions:
                self._transitions[reduces] = build_transition(self._task_step if reduces else self.step)
            return self._transitions[reduces]
        if not weighed:
            return build_transition(self._task_step if reduces else self.step, labels)
        program = self.task_program(0) if reduces else self.program
        return build_transition(self._stratified(weighing_program(self.domain, program, weighed)), labels)

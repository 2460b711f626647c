"""The logic of one domain, each part made once, when it is first asked for."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import clingo

from prag_asp.domain.load import Domain
from prag_asp.logic.ground.ground_step import GroundStep, ground_plan, ground_step
from prag_asp.logic.ground.program import canonical_program, closed_program, weighing_program, whole_program
from prag_asp.logic.ground.stationary import Obstacle, StepReads, read_step
from prag_asp.logic.step.normal import NormalStep
from prag_asp.logic.step.strata import stratified_step
from prag_asp.logic.step.transition import Transition, build_transition
from prag_asp.logic.symmetry.symmetries import Symmetries
from prag_asp.processes.progress_events import stage
from prag_asp.program.sources import ADDED, Program

INTERCHANGEABLE = "looking for interchangeable entities"
LOOP_FREE = ("conditions", "loop_free.lp")


@dataclass(frozen=True)
class Model:
    """What logic knows of a domain.

    A plan's step may fail to be a function of state and action. Then `step` and `transition` raise EngineError, which
    says why, and what else there is works on the unrolled program.

    With `bare`, its domain is that of another model under conditions. These tell entities apart, and make none alike:
    renamings keep what that model says as well, whatever is left of it under the conditions.

    With `part_of`, its plans are some of those of another model, chosen by what all renamings of its tasks keep. They
    are counted up to these renamings alone, so that the tasks of all parts of it are its own.
    """

    domain: Domain
    bare: Model | None = None
    part_of: Model | None = None

    @cached_property
    def program(self) -> Program:
        """The program whose answer sets are plans."""
        return whole_program(self.domain)

    @cached_property
    def whole(self) -> Model:
        """The model whose steps try every action from every state, those that are never reached as well."""
        facts = self.domain.facts
        if not (facts.unreachable or facts.static):
            return self
        domain = replace(self.domain, facts=replace(facts, unreachable=(), static=()))
        return replace(self, domain=domain, bare=self.bare and self.bare.whole)

    @cached_property
    def reads(self) -> StepReads:
        """What a step reads of the step before."""
        return read_step(self.domain.program)

    @cached_property
    def ground(self) -> GroundStep:
        """One step, ground.

        Raises:
            EngineError: a step reads more than the step before it.
        """
        if self.reads.obstacles:
            raise self.reads.obstacles[0].error()
        return ground_step(self.program, self.domain.facts, self.reads)

    @property
    def obstacles(self) -> tuple[Obstacle, ...]:
        """Why a step is not a function of the state and the action, where it is not."""
        return self.reads.obstacles or self.ground.obstacles

    @cached_property
    def step(self) -> NormalStep:
        """One step in normal form."""
        ground = self.ground
        stage("preparing the step")
        return stratified_step(ground)

    def symmetries(self, length: int) -> Symmetries:
        """Return which entities are interchangeable in plans of a length; most domains have the same for all.

        What is never reached may tell entities apart as well: what the author has written decides.
        """
        if self.part_of is not None:
            return self.part_of.symmetries(length)
        if self.whole is not self:
            from prag_asp.logic.symmetry.symmetry import may_interchange  # noqa: PLC0415 - plans and skeletons need none

            return self.whole.symmetries(length) if may_interchange(self.domain.facts) else Symmetries()
        if not self._without_loops.obstacles:
            return self._without_loops._symmetries
        return self._found(lambda model: ground_plan(model.program, length, model.reads))

    def groups(self, length: int) -> tuple[tuple[clingo.Symbol, ...], ...]:
        """Return the groups of entities any two of which are interchangeable alone, in plans of a length."""
        return self.symmetries(length).groups

    @cached_property
    def _symmetries(self) -> Symmetries:
        return self._found(lambda model: model.ground)

    def _found(self, ground: Callable[[Model], GroundStep]) -> Symmetries:
        """Return which entities are interchangeable, as it is found on a part of the ground program.

        Where the invariants may say of single entities what follows anyway, all that follows is stated first.
        """
        from prag_asp.logic.symmetry.symmetry import find_symmetries  # noqa: PLC0415 - plans and skeletons need none

        bare = self.bare
        beside = None if bare is None else lambda: ground(bare._closed() or bare)

        def alike(model: Model) -> Symmetries:
            program = ground(model)
            stage(INTERCHANGEABLE)
            return find_symmetries(model.domain.facts, program, beside)

        found = alike(self)
        closed = self._closed(found.groups)
        return found if closed is None else alike(closed)

    def _closed(self, groups: Collection[Sequence[clingo.Symbol]] = ()) -> Model | None:
        """Return the model that states all that the invariants entail, where more than `groups` may be alike in it."""
        from prag_asp.logic.symmetry.asymmetric_invariants import stated_unevenly  # noqa: PLC0415 - plans and skeletons need none

        if not stated_unevenly(self.domain.facts, groups) or (program := closed_program(self.domain)) is None:
            return None
        return Model(replace(self.domain, program=program))

    @cached_property
    def _without_loops(self) -> Model:
        """The model without the rules that forbid loops: these reach back over all steps, and treat all entities alike.

        The unrolled program of a length would not do: clingo leaves out of it what the start decides in so few steps.
        """
        sources = self.domain.program.sources
        left = tuple(source for source in sources if source.path.parts[-2:] != LOOP_FREE)
        if len(left) == len(sources):
            return self
        return replace(self, domain=replace(self.domain, program=Program(left)))

    @cached_property
    def _task_step(self) -> NormalStep:
        """One step of tasks in normal form, made once for all engines."""
        return self._stratified(self.task_program(0))

    @cached_property
    def _plan_transition(self) -> Transition:
        """The step function of plans, whose moves all levels and engines compile once."""
        return build_transition(self.step)

    @cached_property
    def _task_transition(self) -> Transition:
        """The same of tasks."""
        return build_transition(self._task_step)

    def _stratified(self, program: Program) -> NormalStep:
        """Return one step of a program in normal form; what the library adds tells nothing of what a step reads."""
        reads = read_step(Program(tuple(source for source in program.sources if source.path != ADDED)))
        return stratified_step(ground_step(program, self.domain.facts, reads))

    def task_program(self, length: int) -> Program:
        """Return the program whose answer sets are tasks of a length: plans with their entities named in order."""
        found = self.symmetries(length)
        if not found:
            return self.program
        if found not in self._canonical:
            self._canonical[found] = canonical_program(self.domain, found.groups, found.joint)
        return self._canonical[found]

    @cached_property
    def _canonical(self) -> dict[Symmetries, Program]:
        """The programs of tasks, by the symmetries that these are counted up to."""
        return {}

    def transition(
        self, *, tasks: bool, weighed: Sequence[str] = (), labels: Sequence[clingo.Symbol] = ()
    ) -> Transition:
        """Return the step function of plans, or of tasks.

        `weighed` are facts to add together with ``rules/weights.lp``, whose atoms `labels` the edges then carry.

        Raises:
            EngineError: the step is not a function of the state and the action.
        """
        if self.obstacles:
            raise self.obstacles[0].error()
        tells_apart = tasks and bool(self.symmetries(0))
        if not weighed and not labels:
            return self._task_transition if tells_apart else self._plan_transition
        if not weighed:
            return build_transition(self._task_step if tells_apart else self.step, labels)
        program = self.task_program(0) if tells_apart else self.program
        return build_transition(self._stratified(weighing_program(self.domain, program, weighed)), labels)

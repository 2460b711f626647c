"""A Gymnasium environment in which an agent pursues the subgoals of tasks."""

from __future__ import annotations

import weakref
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from prag_asp.atom import Atom, atom_of
from prag_asp.dataset.scenes import scene_of
from prag_asp.dataset.store.dataset import Dataset
from prag_asp.domain.load import Domain
from prag_asp.errors import QueryError
from prag_asp.output.digests import digest
from prag_asp.physics import Budget, Witness, require_physics
from prag_asp.physics.control.control import Control
from prag_asp.physics.control.names import UPRIGHT, USUAL_RATE, ControlName
from prag_asp.rl.arena import Arena
from prag_asp.rl.camera_views import Image, Viewer, Window, has_display
from prag_asp.rl.environment_options import Until, check_arguments, conditions_of, moves_of, options_of
from prag_asp.rl.goal_env import GoalEnv, Observation, observation_space
from prag_asp.rl.goals import PLACES, Subgoal, subgoals_of
from prag_asp.rl.observations import Layout, ObservationKind, observe
from prag_asp.rl.reward_annealing import RewardAnnealing
from prag_asp.rl.rewards import Reward, step_rewards
from prag_asp.rl.state_checksum import verify_checksum, with_checksum
from prag_asp.rl.tasks.episode_sampler import EpisodeSampler, EpisodeStart
from prag_asp.rl.tasks.named_origin import Lengths, Shares, SplitOptions, named_origin
from prag_asp.rl.tasks.task_origin import Curricula
from prag_asp.rl.tasks.task_sources import WitnessFinder
from prag_asp.space.parts.ranked_tasks import RankedTasks
from prag_asp.space.task_space import TaskSpace
from prag_asp.task import Task

if TYPE_CHECKING:
    from prag_asp.physics.situation import Situation

STEPS = 100
"""The default limit on the steps for a subgoal."""

EPISODE = ("stage", "task", "witness", "_over", "_last", "_left", "_before", "_episode_info", "_curriculum", "_latest")
"""The attributes of an environment that describe the current episode, apart from its start and its actions."""

REBUILT = (
    "domain", "scene", "layout", "situation", "_resources", "_viewer", "_window", "_sampler", "_arena", "_start",
    "_measured",
)  # fmt: skip
"""The attributes that a copy of an environment rebuilds from the arguments and the episode."""


class TaskEnv(GoalEnv):
    """An environment in which an agent moves all arms; tasks come from a `space` or a `dataset`, or are one `task`.

    Instead of a space, give a `domain` and a `length`; instead of a dataset, its folder. With `split`, only the part
    with that name is used: a part of a dataset, or of a space divided by `shares` (80 % ``train`` and 20 % ``test`` by
    default), by whole `skeletons`, or by a held-out name (`hold_out`), in the same way as `generate` does with the same
    seed. The conditions `where` restrict a space or a dataset. Tasks of a space whose final state equals the initial
    state are excluded unless `trivial` is true. Thus plain values suffice to define an environment.

    An observation is an array of the kind `observation` (`layout.names` names its features); with `goals` or `cameras`,
    it is a dictionary that holds this array under `observation`. Following the convention of goal environments, `goals`
    adds `achieved_goal` and `desired_goal`, each of shape (2 * `PLACES`,), with vectors for the current and the
    previous step; `prag_asp.rl.rewards` explains the vectors. `control` is the name of a control convention; the
    attribute `control` holds the names, units and scales of the components of an action. There are `rate` actions per
    second, a divisor of 120. `action_scale` scales the displacements in actions, but not those of the fingers; it is
    useful for skills that need small motions.

    `stage` is the initial subgoal, from 0 (-1 is the last, "any" is random); the episode begins in the state of the
    witness at the start of this subgoal. It lasts `until` that "subgoal" or the whole "task" is reached, but at most
    `steps` steps for each subgoal. Only the predicates decide whether a subgoal is reached. With `everything`, all
    bodies are observed, not only those in the current action. The dense part of a "faded" reward is annealed over
    `fade` steps or, if `fade` is "success", with the success rate; `discount` is the discount factor of the potentials.
    For tasks from a space, witnesses are searched for within a `budget`.

    With a `part` of the space, only the tasks of the part are used. A `curriculum` chooses the tasks
    (`LengthCurriculum`, `NoveltyCurriculum`, `AdaptiveCurriculum` or `BanditCurriculum`) or the initial subgoals
    (`ReverseCurriculum`); there may be one of each kind. Curricula learn only from the episodes of this environment.
    `info` has the same keys at a reset and at each step, among them the instruction in a `language` at three levels of
    detail, the sentence for the current subgoal, the exact `probability` of the task and that of its stage
    (`stage_probability`), and the number of samples that were `rejected` before this task. Observations also contain
    the images of `cameras`, each under `camera_` followed by the name of the camera: 8-bit colours, with the width and
    height in pixels given by `size`. With the `render_mode` "human", a window shows the first camera after each reset
    and step, at the simulated speed.

    A copy, by `pickle` or `copy.deepcopy`, has its own simulators and continues the episode identically, bit for bit:
    it replays the actions of the episode.

    Raises:
        QueryError: an argument is invalid, or the task has no witness.
        SceneError: the domain has no scene, or the scene has no shape for an entity in a task.
        PhysicsMissingError: PyBullet or frankik is not installed.
    """

    metadata = {"render_modes": ["rgb_array", "human"], "render_fps": USUAL_RATE}

    def __init__(
        self,
        space: TaskSpace | None = None,
        *,
        domain: Domain | str | None = None,
        length: Lengths | None = None,
        where: Sequence[str] = (),
        split: str | None = None,
        shares: Shares | None = None,
        skeletons: bool = False,
        hold_out: str | None = None,
        split_seed: int = 0,
        trivial: bool = False,
        part: RankedTasks | None = None,
        dataset: Dataset | str | Path | None = None,
        task: Task | None = None,
        witness: Witness | None = None,
        curriculum: Curricula = None,
        stage: int | str = 0,
        until: Until = "task",
        reward: Reward = "dense",
        fade: int | Literal["success"] = "success",
        discount: float = 0.99,
        control: ControlName = UPRIGHT,
        rate: int = USUAL_RATE,
        action_scale: float = 1.0,
        observation: ObservationKind = "relative",
        everything: bool = False,
        goals: bool = False,
        steps: int = STEPS,
        budget: Budget | None = None,
        language: str = "en",
        cameras: Sequence[str] = (),
        size: int | tuple[int, int] | None = None,
        render_mode: Literal["rgb_array", "human"] | None = None,
    ) -> None:
        self._arguments = {name: value for name, value in locals().items() if name != "self"}
        origin = named_origin(
            space=space, part=part, dataset=dataset, task=task, domain=domain, length=length,
            where=where if task is not None else conditions_of(where, stage), curriculum=curriculum,
            split=SplitOptions(split, shares, skeletons, hold_out, split_seed), trivial=trivial,
        )  # fmt: skip
        check_arguments(self._arguments, self.metadata["render_modes"])
        require_physics()
        self.domain = origin.domain(domain if length is None else None)
        self.scene = scene_of(self.domain)
        self._resources = ExitStack()
        # releases the simulators even if the environment is not closed
        weakref.finalize(self, self._resources.close)
        self._viewer = Viewer(self.scene, cameras, size, self._resources)
        self.control = Control.of(control, self.scene, rate, scale=action_scale)
        actions, joints = map(atom_of, self.domain.facts.actions), control.startswith("joint")
        self.layout = Layout.of(self.scene, actions, everything=everything, kind=observation, joints=joints)
        self._until, self._steps = until, int(steps)
        annealing = RewardAnnealing(fade)
        self._annealing = annealing if reward == "faded" else None
        self._spec = f"{origin.title}, {fade if reward == 'faded' else 'no fading'}"
        finder = WitnessFinder(self.scene, self._resources, budget)
        self._sampler = EpisodeSampler(
            origin, witness, stage, finder, domain=self.domain, layout=self.layout, language=language
        )
        self._arena: Arena | None = None
        self._measured: tuple[Subgoal, Situation, list[float]] | None = None
        self._over = True
        self.share, self.discount, self.has_goals = float(reward != "sparse"), float(discount), bool(goals)
        # Gymnasium's checker tries all modes that an environment lists.
        modes = [mode for mode in self.metadata["render_modes"] if mode != "human" or has_display()]
        self.metadata, self.render_mode = self.metadata | {"render_fps": rate, "render_modes": modes}, render_mode
        self._window = Window(f"prag_asp: {origin.title}", rate) if render_mode == "human" else None
        low, high = (bound.astype(np.float32) for bound in (self.control.low, self.control.high))
        self.action_space = spaces.Box(low, high, dtype=np.float32)
        self.observation_space = observation_space(len(self.layout.names), self._viewer.spaces, goals=goals)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Begin an episode.

        `options` may set the `task` (and its `witness`), the `rank` of a task (in a dataset, the number of the task) or
        a `scenario`, the initial `stage`, the `steps` for each subgoal, and the `texts` of the task (`TaskTexts`, such
        as the `texts` of an entry of a dataset); all other values are sampled. With a `seed`, all later samples depend
        only on the seed; without any seed, they are random.

        Raises:
            QueryError: the options are invalid, or the task has no witness.
            NotFound: `PATIENCE` samples in a row are not feasible.
        """
        request = options_of(options)
        super().reset(seed=seed)
        if seed is not None or not self._sampler.seeded:
            self._sampler.seed(self.np_random)
        start = self._sampler.begin(request, self.np_random)
        # An error before this line leaves the current episode unchanged.
        self._start, self.stage = start, start.stage
        self.task, self.witness = start.assignment.task, start.assignment.witness
        self._over = False
        self._last = self.stage if self._until == "subgoal" else len(start.subgoals) - 1
        self._left = int(request.get("steps") or self._steps) * (self._last + 1 - self.stage)
        if self._annealing is not None:
            self.share = self._annealing.share
        self._moves: list[NDArray[np.float64]] = []
        self._perform()
        measured, here = self._goal(self.situation)
        self._before = here
        self._episode_info, self._curriculum = start.info(), self._sampler.summary()
        self._latest = self._observation(self.situation, here), self._info(measured, success=False)
        self._show()
        return self._latest

    def step(self, action: NDArray[np.float32]) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Apply an action for its duration; it is clipped to the bounds of the action space.

        Raises:
            QueryError: the action is malformed or not finite, no episode has begun, or it has ended.
        """
        arena = self._begun_arena
        if self._over:
            raise QueryError("the episode has ended; reset the environment")
        moves = moves_of(action, self.control)
        self.situation = situation = arena.act(moves)
        self._moves.append(moves)
        measured, here = self._goal(situation)
        if self.stage < self._last and max(here[1:].tolist()) <= 0.0:
            self.stage += 1
            measured, here = self._goal(situation)
        seen = self._observation(situation, here)
        reward, ended = step_rewards(self._before, here, self._desired(), discount=self.discount, share=self.share)
        self._before = here
        self._left -= 1
        done, late = bool(ended), self._left <= 0
        if self._annealing is not None:
            self._annealing.step()
        if done or late:
            self._over = True
            if self._annealing is not None:
                self._annealing.end(done)
            self._sampler.update(self._start, self.stage, success=done)
        self._latest = seen, self._info(measured, success=done)
        self._show()
        return seen, float(reward), done, late and not done, self._latest[1]

    def render(self) -> Image | None:
        """Return an image from the first of the `cameras`, or from the scene's first camera.

        Return None if there is no render mode, or in the mode "human", where each reset and step shows the image.

        Raises:
            QueryError: no episode has begun.
        """
        if self.render_mode != "rgb_array":
            return None
        assert self._begun_arena
        return self._viewer.image(self.situation)

    def _show(self) -> None:
        """Show the current moment in the window, if there is one."""
        if self._window is not None:
            self._window.show(self._viewer.image(self.situation))

    def save_state(self) -> dict[str, Any]:
        """Return the state of the episode, which can be pickled; samplers and curricula are not part of it.

        Raises:
            QueryError: no episode has begun.
        """
        assert self._begun_arena
        start, moves = replace(self._start, subgoals=()), list(self._moves)
        attributes = {name: getattr(self, name) for name in EPISODE}
        return {"environment": self._kind, "start": start, "moves": moves, **attributes}

    def restore_state(self, state: Mapping[str, Any]) -> tuple[Observation, dict[str, Any]]:
        """Continue an episode, bit for bit, of this environment or of one with the same arguments.

        Replay the actions of the episode, and return the observation and the info of its last step.

        Raises:
            QueryError: the value is not the state of an episode, or the environment of that episode has a different
                domain, control convention, rate or observation.
        """
        try:
            kind, start, moves, attributes = (
                state["environment"], state["start"], list(state["moves"]), {name: state[name] for name in EPISODE}
            )  # fmt: skip
        except (KeyError, TypeError) as error:
            raise QueryError(f"this is not a state of an episode ({error!r:.60}); give that of save_state") from None
        if kind != self._kind:
            raise QueryError("the state belongs to another environment; make this one with the same arguments")
        self.__dict__.update(attributes)
        self._moves = moves
        self._resume(start)
        return self._latest

    @property
    def _kind(self) -> str:
        """A digest of the domain, the actions and the observations of the environment."""
        control = self.control.name, self.control.rate, self.control.upper.tolist()
        return digest([self.domain.label, control, list(self.layout.names), str(self.observation_space)])

    def state_dict(self) -> dict[str, Any]:
        """Return a checkpoint of the samplers, the curricula and the annealing, as JSON values.

        If an environment created with the same arguments loads this checkpoint, its next episodes begin exactly as
        they would have in this environment. The current episode is not part of the checkpoint.

        Raises:
            QueryError: no task has been sampled yet.
        """
        if not self._sampler.seeded:
            raise QueryError("there is no state yet; reset the environment")
        annealing = None if self._annealing is None else self._annealing.state_dict()
        state = {"rng": dict(self.np_random.bit_generator.state), **self._sampler.state_dict(), "annealing": annealing}
        return with_checksum(state, self._spec)

    def load_state_dict(self, state: Mapping[str, Any]) -> None:
        """Continue from a checkpoint of an environment with the same arguments; pass no seed to the next reset.

        Raises:
            QueryError: the checkpoint belongs to another environment, or is damaged.
        """
        verify_checksum(state, self._spec)
        try:
            self.np_random.bit_generator.state = state["rng"]
            self._sampler.load_state_dict(state)
            if self._annealing is not None:
                self._annealing.load_state_dict(state["annealing"])
        except (AttributeError, KeyError, TypeError, ValueError) as error:
            text = f"the state belongs to another environment ({error!r:.60})"
            raise QueryError(f"{text}; make this one with the same arguments") from None
        self._sampler.seeded = True

    def close(self) -> None:
        """Close the simulators and release all resources. A reset opens them again."""
        self._arena = None
        if self._window is not None:
            self._window.close()
        self._viewer.forget()
        self._sampler.finder.forget()
        self._resources.close()

    @property
    def commanded_openings(self) -> Mapping[str, float]:
        """The commanded opening of each gripper in metres; outside episodes, this property raises a QueryError."""
        return self._begun_arena.commanded_openings

    @property
    def last(self) -> int:
        """The number of the last subgoal of the episode; outside episodes, this property raises a QueryError."""
        assert self._begun_arena
        return self._last

    @property
    def action(self) -> Atom:
        """The action of the current subgoal; outside episodes, this property raises a QueryError."""
        assert self._begun_arena
        return self.task.actions[self.stage]

    @property
    def _begun_arena(self) -> Arena:
        """The world of the episode.

        Raises:
            QueryError: no episode has begun.
        """
        if self._arena is None:
            raise QueryError("no episode has begun; reset the environment")
        return self._arena

    def __getstate__(self) -> dict[str, Any]:
        """Return the arguments, the state of the samplers, and the episode as its start and its actions."""
        return {
            "arguments": self._arguments,
            "sampler": self._sampler.state_dict() if self._sampler.seeded else None,
            "start": None if self._arena is None else replace(self._start, subgoals=()),
            "attributes": {name: value for name, value in self.__dict__.items() if name not in REBUILT},
        }

    def __setstate__(self, state: dict[str, Any]) -> None:
        TaskEnv.__init__(self, **state["arguments"])
        self.__dict__.update(state["attributes"])
        if state["sampler"] is not None:
            self._sampler.load_state_dict(state["sampler"])
            self._sampler.seeded = True
        if state["start"] is not None:
            self._resume(state["start"])

    def _resume(self, start: EpisodeStart) -> None:
        """Replay an episode up to its last action, after recomputing the subgoals of its task."""
        self._start = replace(start, subgoals=subgoals_of(start.assignment.task, self.scene))
        self._perform()

    def _perform(self) -> None:
        """Start the episode in the simulator, and replay its actions so far."""
        if self._arena is None:
            self._arena = Arena(self.scene, self.control, self._resources)
        self.situation = self._arena.start(self.witness, self._start.stage)
        for moves in self._moves:
            self.situation = self._arena.act(moves)

    def _goal(self, situation: Situation) -> tuple[list[float], NDArray[np.float32]]:
        """Return the signed distances of the facts at a moment, and the goal vector of the moment."""
        subgoal, last = self._start.subgoals[self.stage], self._measured
        measured = subgoal.measured(situation, last[1:] if last is not None and last[0] is subgoal else None)
        self._measured = subgoal, situation, measured
        return measured, np.array([self.stage, *subgoal.placed(measured)], dtype=np.float32)

    def _goals(self, here: NDArray[np.float32]) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Return the achieved and the desired goal at a moment."""
        desired = self._desired()
        return np.concatenate([here, self._before]), np.concatenate([desired, desired])

    def _desired(self) -> NDArray[np.float32]:
        """Return the goal vector of the end of the episode."""
        desired = np.zeros(PLACES, dtype=np.float32)
        desired[0] = self._last
        return desired

    def _observation(self, situation: Situation, here: NDArray[np.float32]) -> Observation:
        """Return the observation at a moment."""
        assert self._arena is not None
        seen = observe(
            self.layout, situation, self.action, self._arena.speeds, self._arena.commanded_openings, here[1:]
        )
        if isinstance(self.observation_space, spaces.Box):
            return seen
        goals = dict(zip(("achieved_goal", "desired_goal"), self._goals(here), strict=True)) if self.has_goals else {}
        return {"observation": seen, **goals, **self._viewer.images(situation)}

    def _info(self, measured: list[float], *, success: bool) -> dict[str, Any]:
        """Return the info for an observation."""
        info = self._episode_info | {
            "stage": self.stage,
            "action": str(self.action),
            "subgoal": self._start.texts.subgoals[self.stage],
            "reached": " ".join(self._start.subgoals[self.stage].reached(measured)),
            "is_success": success,
            "steps_left": self._left,
        }
        return info | ({"curriculum": dict(self._curriculum)} if self._curriculum else {})

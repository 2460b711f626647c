"""An environment in which an agent pursues the subgoals of tasks, by the interface of Gymnasium."""

from __future__ import annotations

import weakref
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from typing import TYPE_CHECKING, Any, Literal

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from prag_asp.atom import Atom, atom_of
from prag_asp.dataset.scenes import scene_of
from prag_asp.dataset.store.dataset import Dataset
from prag_asp.domain.load import Domain
from prag_asp.errors import QueryError
from prag_asp.physics import Budget, Witness, require_physics
from prag_asp.rl.arena import PERIOD, Arena
from prag_asp.rl.camera_views import Image, Viewer
from prag_asp.rl.control import SIZES, Control
from prag_asp.rl.environment_options import Until, check_episodes, check_figures, moves_of, options_of
from prag_asp.rl.goals import PLACES
from prag_asp.rl.observations import Layout, observe
from prag_asp.rl.reward_annealing import Fading
from prag_asp.rl.rewards import Reward, earned, reached
from prag_asp.rl.state_checksum import check_seal, sealed
from prag_asp.rl.tasks.episode_starts import Draws
from prag_asp.rl.tasks.source_options import Curricula, Origin
from prag_asp.rl.tasks.task_sources import Finder
from prag_asp.space.parts.ranked_tasks import RankedTasks
from prag_asp.space.task_space import TaskSpace
from prag_asp.task import Task

if TYPE_CHECKING:
    from prag_asp.physics.situation import Situation

Observation = dict[str, Any]
"""What an agent sees: arrays of 32-bit floats by their names."""

STEPS = 100
"""For how many steps a subgoal may be pursued, unless something else is asked for."""


class TaskEnv(gymnasium.Env[Observation, NDArray[np.float32]]):
    """One agent moves all arms of a scene; its tasks come from a `space`, a `dataset`, or are one `task` alone.

    An observation has what the agent sees (`layout.names` says what each number is), and, by the convention of goal
    environments, `achieved_goal` and `desired_goal` of the shape (2, `PLACES`): the moment, then that one step before;
    `prag_asp.rl.rewards` says what the vectors mean. The action has, of each robot in turn, a displacement of the tool
    along x, y, z, a turn about the vertical and one of the fingers (`control` "tool"), or seven joints and the fingers
    ("joints"), each between -1 and 1; it lasts 1/20 s.

    `stage` is the subgoal to begin with, from 0, from the state in which a witness has it begin (-1 is the last,
    "any" draws one); the episode lasts `until` that "subgoal" is reached, or the whole "task", and at most `steps` for
    each of them. Whether one is reached, the predicates decide alone. With `everything`, all bodies are seen, not those
    alone of which the action speaks. The dense part of a "faded" reward fades over so many steps, or with "success";
    `discount` is that of its potentials. Witnesses of tasks from a space are looked for within a `budget`.

    Only tasks of a `part` of the space are given, where there is one. A `curriculum` says which come next: `Lengths`,
    `Novelty`, `Adaptive` or `Bandit`, and `Backwards` of subgoals; or two of them, one of each kind. It learns from the
    ends of episodes of this environment alone. `info` has the exact `probability` of the draw of a task and of its
    `stage_probability`, and how many draws were `rejected` before it. What `cameras` see is in observations, too, as
    `camera_` and the name: 8-bit colours, of `size` width and height in pixels; and so is it with `render`.

    Raises:
        QueryError: it is asked for in a wrong way, or the task has no witness.
        SceneError: the domain has no scene, or a task speaks of something for which that has no shape.
        PhysicsMissingError: PyBullet or frankik is not installed.
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": round(1 / PERIOD)}

    def __init__(
        self,
        space: TaskSpace | None = None,
        *,
        part: RankedTasks | None = None,
        dataset: Dataset | None = None,
        task: Task | None = None,
        witness: Witness | None = None,
        domain: Domain | str | None = None,
        curriculum: Curricula = None,
        stage: int | Literal["any"] = 0,
        until: Until = "task",
        reward: Reward = "dense",
        fade: int | Literal["success"] = "success",
        discount: float = 1.0,
        control: Control = "tool",
        everything: bool = False,
        steps: int = STEPS,
        budget: Budget | None = None,
        cameras: Sequence[str] = (),
        size: int | tuple[int, int] | None = None,
        render_mode: Literal["rgb_array"] | None = None,
    ) -> None:
        origin = Origin(space, part, dataset, task, curriculum)
        check_episodes(until=until, reward=reward, control=control, stage=stage, steps=steps)
        modes = self.metadata["render_modes"]
        check_figures(discount=discount, budget=budget, render_mode=render_mode, modes=modes)
        require_physics()
        self.render_mode = render_mode
        self.domain = origin.domain(domain)
        self.scene = scene_of(self.domain)
        self._resources = ExitStack()
        # Who forgets to close it leaves nothing behind either, not even at the end of the process.
        weakref.finalize(self, self._resources.close)
        self._viewer = Viewer(self.scene, cameras, size, self._resources)
        self.layout = Layout.of(self.scene, map(atom_of, self.domain.facts.actions), everything=everything)
        self.control, self._until, self._steps, self._discount = control, until, int(steps), float(discount)
        fading = Fading(fade)
        self._share, self._fading = float(reward != "sparse"), fading if reward == "faded" else None
        self._made = f"{origin.title}, {fade if reward == 'faded' else 'no fading'}"
        finder = Finder(self.scene, self._resources, budget)
        self._draws = Draws(origin, witness, stage, finder, domain=self.domain, layout=self.layout)
        self._arena: Arena | None = None
        self._over = True
        self.action_space = spaces.Box(-1.0, 1.0, (SIZES[control] * len(self.layout.robots),), np.float32)
        goals = spaces.Box(-np.inf, np.inf, (2, PLACES), np.float32)
        seen = spaces.Box(-np.inf, np.inf, (len(self.layout.names),), np.float32)
        self.observation_space = spaces.Dict(
            {"observation": seen, "achieved_goal": goals, "desired_goal": goals, **self._viewer.spaces}
        )

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Begin an episode.

        `options` may have the `task` (and its `witness`) or the `rank` of a task (in a data set, its number), and the
        `stage` to begin with; what they leave out is drawn. With a `seed`, all that is drawn from then on depends on it
        alone; without any, on chance.

        Raises:
            QueryError: the options are wrong, or the task has no witness.
            NotFound: no feasible task is drawn in `PATIENCE` draws.
        """
        asked = options_of(options)
        super().reset(seed=seed)
        if seed is not None or not self._draws.seeded:
            self._draws.seed(self.np_random)
        begun = self._draws.begin(asked, self.np_random)
        # Until here the episode that goes on is untouched: after what is refused, its steps are still its own.
        self._begun, self.task, self.witness, self.stage = begun, begun.given.task, begun.given.witness, begun.stage
        self._over = False
        self._last = self.stage if self._until == "subgoal" else len(begun.subgoals) - 1
        self._left = self._steps * (self._last + 1 - self.stage)
        if self._arena is None:
            self._arena = Arena(self.scene, self._resources)
        if self._fading is not None:
            self._share = self._fading.share
        self.situation = self._arena.start(self.witness, self.stage)
        measured, here = self._goal(self.situation)
        self._before = here
        info, curriculum = begun.told() | self._told(measured, success=False), self._draws.told()
        return self._seen(self.situation, here), info | ({"curriculum": curriculum} if curriculum else {})

    def step(self, action: NDArray[np.float32]) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Let the agent act for 1/20 s; numbers of an action beyond -1 and 1 count as these.

        Raises:
            QueryError: the action is none, or no episode has begun.
        """
        arena, moves = self._begun_arena, moves_of(action, SIZES[self.control] * len(self.layout.robots))
        self.situation = situation = arena.act(moves, self.control)
        measured, here = self._goal(situation)
        if here[1:].max() <= 0.0 and self.stage < self._last:
            self.stage += 1
            measured, here = self._goal(situation)
        seen = self._seen(situation, here)
        gain, ended = self._earned(seen["achieved_goal"], seen["desired_goal"])
        self._before = here
        self._left -= 1
        done, late = bool(ended), self._left <= 0
        if self._fading is not None:
            self._fading.step()
        if (done or late) and not self._over:
            self._over = True
            if self._fading is not None:
                self._fading.end(done)
            self._draws.report(self._begun, self.stage, success=done)
        return seen, float(gain), done, late and not done, self._told(measured, success=done)

    def compute_reward(self, achieved_goal: NDArray[np.floating], desired_goal: NDArray[np.floating], info: Any) -> Any:
        """Return what steps earn that lead to `achieved_goal`, of the shape (..., 2, `PLACES`); `info` is not read."""
        gain, _ = self._earned(np.asarray(achieved_goal), np.asarray(desired_goal))
        return float(gain) if gain.ndim == 0 else gain

    def compute_terminated(
        self, achieved_goal: NDArray[np.floating], desired_goal: NDArray[np.floating], info: Any
    ) -> Any:
        """Return whether steps end at their goals that lead to `achieved_goal`; `info` is not read."""
        found = reached(np.asarray(achieved_goal)[..., 0, :], np.asarray(desired_goal)[..., 0, :])
        return bool(found) if found.ndim == 0 else found

    def render(self) -> Image | None:
        """Return what the first of the `cameras` sees now, of the scene's where there are none; None without a mode.

        Raises:
            QueryError: no episode has begun.
        """
        if self.render_mode is None:
            return None
        assert self._begun_arena
        return self._viewer.picture(self.situation)

    def state_dict(self) -> dict[str, Any]:
        """Return what the draws of tasks and subgoals, and the fading, have come to, of what JSON can write.

        An environment that is made alike, and loads it, begins the next episodes as this one does. The episode that
        goes on is no part of it.

        Raises:
            QueryError: nothing was drawn yet.
        """
        if not self._draws.seeded:
            raise QueryError("there is no state yet; reset the environment")
        state = {
            "rng": dict(self.np_random.bit_generator.state),
            **self._draws.state_dict(),
            "fading": None if self._fading is None else self._fading.state_dict(),
        }
        return sealed(state, self._made)

    def load_state_dict(self, state: Mapping[str, Any]) -> None:
        """Go on from what `state_dict` of an environment that is made alike returned; the next reset takes no seed.

        Raises:
            QueryError: it is the state of another environment, or damaged.
        """
        check_seal(state, self._made)
        try:
            self.np_random.bit_generator.state = state["rng"]
            self._draws.load_state_dict(state)
            if self._fading is not None:
                self._fading.load_state_dict(state["fading"])
        except (AttributeError, KeyError, TypeError, ValueError) as error:
            told = f"the state is of another environment ({error!r:.60})"
            raise QueryError(f"{told}; make this one with the same arguments") from None
        self._draws.seeded = True

    def close(self) -> None:
        """Close the simulators; nothing is left behind. A reset opens them again."""
        self._arena = None
        self._viewer.forget()
        self._draws.finder.forget()
        self._resources.close()

    @property
    def asked(self) -> Mapping[str, float]:
        """How far each gripper is told to open, in metres; without an episode this and the next raise QueryError."""
        return self._begun_arena.asked

    @property
    def last(self) -> int:
        """The number of the subgoal with which the episode ends."""
        assert self._begun_arena
        return self._last

    @property
    def action(self) -> Atom:
        """The action of the subgoal that is being pursued."""
        assert self._begun_arena
        return self.task.actions[self.stage]

    @property
    def _begun_arena(self) -> Arena:
        """The world of the episode.

        Raises:
            QueryError: none has begun.
        """
        if self._arena is None:
            raise QueryError("no episode has begun; reset the environment")
        return self._arena

    def _earned(self, achieved: NDArray[np.floating], desired: NDArray[np.floating]) -> tuple[Any, Any]:
        now, before, goal = achieved[..., 0, :], achieved[..., 1, :], desired[..., 0, :]
        return earned(before, now, goal, discount=self._discount, share=self._share)

    def _goal(self, situation: Situation) -> tuple[list[float], NDArray[np.float32]]:
        """Return the signed distances of a moment, and its vector."""
        subgoal = self._begun.subgoals[self.stage]
        measured = subgoal.measured(situation)
        return measured, np.array([self.stage, *subgoal.placed(measured)], dtype=np.float32)

    def _seen(self, situation: Situation, here: NDArray[np.float32]) -> Observation:
        """Return an observation."""
        assert self._arena is not None
        desired = np.zeros((2, PLACES), dtype=np.float32)
        desired[:, 0] = self._last
        seen = observe(self.layout, situation, self.action, self._arena.speeds, self._arena.asked)
        found = {"observation": seen, "achieved_goal": np.array([here, self._before]), "desired_goal": desired}
        return found | self._viewer.pictures(situation)

    def _told(self, measured: list[float], *, success: bool) -> dict[str, Any]:
        """Return what is told beside an observation."""
        reached = self._begun.subgoals[self.stage].reached(measured)
        return {"stage": self.stage, "action": str(self.action), "reached": reached, "is_success": success}

"""Skill chaining: a policy for each skill, chained along the plans of tasks, with success rates.

Only the predicates decide when a subgoal is reached and the next policy takes over. Rates are exact fractions, so the
success rate of whole tasks is the product of the rates of their stages.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from itertools import accumulate
from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from prag_asp.atom import Atom
from prag_asp.dataset.pass_rates import Rate
from prag_asp.errors import QueryError
from prag_asp.physics import Witness
from prag_asp.rl.environment import STEPS, TaskEnv
from prag_asp.rl.observations import skill
from prag_asp.space.task_space import TaskSpace
from prag_asp.task import Task
from prag_asp.wording import unknown

Policy = Callable[[Any], "NDArray[Any] | None"]
"""A function from an observation of the (wrapped) environment to an action, or to None to give up.

If it has a method `begin()`, this is called whenever the policy takes over, so that it can reset its memory.
"""

Tasks = int | Iterable[Task | tuple[Task, Witness]]


@dataclass(frozen=True)
class Rollout:
    """The rollout of a task: `tries` and `steps` for each pursued subgoal, and the number of subgoals `reached`.

    `first` is the initial stage; `actions` holds the actions from this stage to the end of the episode.
    """

    task: Task
    first: int
    actions: tuple[Atom, ...]
    tries: tuple[int, ...]
    steps: tuple[int, ...]
    reached: int

    @property
    def success(self) -> bool:
        """Whether all subgoals were reached."""
        return self.reached == len(self.actions)


@dataclass(frozen=True)
class Rollouts:
    """The rollouts of several tasks."""

    rollouts: tuple[Rollout, ...]

    def whole(self) -> Rate:
        """Return the success rate of whole tasks."""
        return Rate(sum(rollout.success for rollout in self.rollouts), len(self.rollouts))

    def by_stage(self) -> tuple[Rate, ...]:
        """Return the success rate of each stage among the rollouts that began this stage.

        If all rollouts have the same number of stages, the product of the shares is exactly the share of `whole`.
        """
        trials = Counter(stage for rollout in self.rollouts for stage in range(len(rollout.tries)))
        reached = Counter(stage for rollout in self.rollouts for stage in range(rollout.reached))
        return tuple(Rate(reached[stage], trials[stage]) for stage in sorted(trials))

    def by_length(self) -> tuple[Fraction, ...]:
        """Return, for each length from 1 on, the share of plans whose subgoals up to that length are all reached.

        The result is the product of the shares of the stages. It is exact for rollouts of one length; for several
        lengths, it is the estimate of Kaplan and Meier (1958), in which each rollout counts up to its length.
        """
        return tuple(accumulate((rate.share for rate in self.by_stage()), lambda one, other: one * other))

    def by_action(self) -> Mapping[str, Rate]:
        """Return the success rate of each action name."""
        trials: Counter[str] = Counter()
        reached: Counter[str] = Counter()
        for rollout in self.rollouts:
            for stage, action in enumerate(rollout.actions[: len(rollout.tries)]):
                trials[action.name] += 1
                reached[action.name] += stage < rollout.reached
        return {name: Rate(reached[name], trials[name]) for name in sorted(trials)}

    def table(self) -> str:
        """Return a table of the rates of each stage, each action, and whole tasks, as text."""
        rows = [(f"stage {number}", rate) for number, rate in enumerate(self.by_stage(), 1)]
        rows += [*self.by_action().items(), ("whole", self.whole())]
        wide = max(len(name) for name, _ in rows)
        return "\n".join(f"{name:<{wide}}  {rate}" for name, rate in rows)


def run(
    env: gymnasium.Env[Any, Any] | TaskSpace,
    policies: Policy | Mapping[str, Policy],
    tasks: Tasks,
    *,
    tries: int = 1,
    patience: int = STEPS,
    seed: int | None = None,
) -> Rollouts:
    """Pursue tasks with a policy for each skill, and return the rollouts.

    `policies` maps action names (``pick``) or skills (``place(panda,_,left_of,_)``), which have priority, to policies;
    a single policy is used for all skills. Each subgoal may be pursued for up to `patience` steps, up to `tries` times:
    after a failure, the policy for this subgoal takes over again from the current state. `tasks` are tasks, with or
    without witnesses, or the number of tasks to sample with a `seed`. The environment, which is a `TaskEnv`, possibly
    in wrappers, defines the subgoals and the observations; it remains open. An environment made for a space is closed.

    Raises:
        QueryError: the environment is not a `TaskEnv`, a number is below 1, a policy is missing, or a task has no
            witness.
    """
    if isinstance(env, TaskSpace):
        task_env = TaskEnv(env, reward="sparse")
        try:
            return run(task_env, policies, tasks, tries=tries, patience=patience, seed=seed)
        finally:
            task_env.close()
    if not isinstance(getattr(env, "unwrapped", None), TaskEnv):
        raise QueryError(f"plans are pursued in a TaskEnv, or in a task space; got {env!r:.80}")
    for number, what in ((tries, "tries"), (patience, "patience")):
        if type(number) is not int or number < 1:
            raise QueryError(f"{what} is a whole number from 1 on; got {number!r}")
    rollouts = []
    for options in _reset_options(tasks):
        observation, _ = env.reset(seed=seed, options=options | {"steps": tries * patience})
        seed = None
        rollouts.append(_pursued(env, policies, observation, tries, patience))
    return Rollouts(tuple(rollouts))


def _reset_options(tasks: Tasks) -> Iterator[dict[str, Any]]:
    """Yield the reset options of each rollout.

    Raises:
        QueryError: `tasks` is neither a positive number nor tasks of a space or a dataset.
    """
    if isinstance(tasks, int) and not isinstance(tasks, bool) and tasks > 0:
        yield from ({} for _ in range(tasks))
        return
    if not isinstance(tasks, Iterable):
        raise QueryError(f"tasks are tasks, or their number, at least 1; got {tasks!r}")
    for each in tasks:
        pair = (each, None) if isinstance(each, Task) else each
        if not isinstance(pair, tuple) or len(pair) != 2:
            raise QueryError(f"tasks are tasks, or pairs of a task and its witness; got {each!r:.80}")
        yield {"task": pair[0], "witness": pair[1]}


def _pursued(
    wrapped: gymnasium.Env[Any, Any],
    policies: Policy | Mapping[str, Policy],
    observation: Any,
    tries: int,
    patience: int,
) -> Rollout:
    """Pursue the subgoals of an episode that has begun until one fails."""
    env: TaskEnv = wrapped.unwrapped  # type: ignore[assignment]
    first, last = env.stage, env.last
    tried, steps = [], []
    ended = False
    for stage in range(first, last + 1):
        policy = _policy(policies, env)
        count = taken = 0
        while env.stage == stage and not ended and count < tries:
            count += 1
            observation, ended, more = _attempt(wrapped, policy, observation, patience)
            taken += more
        tried.append(count)
        steps.append(taken)
        if env.stage == stage:
            break
    actions = env.task.actions[first : last + 1]
    return Rollout(env.task, first, actions, tuple(tried), tuple(steps), env.stage - first + ended)


def _attempt(
    wrapped: gymnasium.Env[Any, Any], policy: Policy, observation: Any, patience: int
) -> tuple[Any, bool, int]:
    """Pursue a subgoal with a policy; return the last observation, whether it succeeded, and the number of steps."""
    env: TaskEnv = wrapped.unwrapped  # type: ignore[assignment]
    stage, begin = env.stage, getattr(policy, "begin", None)
    if begin is not None:
        begin()
    for taken in range(patience):
        action = policy(observation)
        if action is None:
            return observation, False, taken
        observation, _, ended, _, _ = wrapped.step(np.asarray(action))
        if ended or env.stage != stage:
            return observation, ended, taken + 1
    return observation, False, patience


def _policy(policies: Policy | Mapping[str, Policy], env: TaskEnv) -> Policy:
    """Return the policy for the current subgoal.

    Raises:
        QueryError: the action of the subgoal has no policy.
    """
    if not isinstance(policies, Mapping):
        return policies
    for name in (skill(env.action, env.scene), env.action.name):
        if name in policies:
            return policies[name]
    raise QueryError(unknown(env.action.name, policies, "policy"))

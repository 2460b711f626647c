"""Long plans by parts: a policy for each skill, chained along the plans of tasks, and how far that gets.

The predicates alone decide when a subgoal is reached and the policy of the next one takes over. What comes of it is
counted, so a success rate of whole tasks is the product of the rates of its stages, exactly.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from itertools import accumulate
from statistics import NormalDist
from typing import Any, NamedTuple

import gymnasium
import numpy as np
from numpy.typing import NDArray

from prag_asp.atom import Atom
from prag_asp.errors import QueryError
from prag_asp.physics import Witness
from prag_asp.rl.environment import STEPS, TaskEnv
from prag_asp.rl.observations import skill
from prag_asp.space.task_space import TaskSpace
from prag_asp.task import Task
from prag_asp.wording import unknown

Policy = Callable[[Any], "NDArray[Any] | None"]
"""Returns an action for an observation, as the environment and its wrappers show it, or None where it gives up.

Where it has a method `begin()`, that is called whenever it takes over, so it can forget what it remembers.
"""

Asked = int | Iterable[Task | tuple[Task, Witness]]


class Rate(NamedTuple):
    """How many of some trials have succeeded."""

    successes: int
    trials: int

    @property
    def share(self) -> Fraction:
        """The share of successes, exactly; 0 of no trials.

        The shares of the stages of tasks of one length multiply to that of the whole.
        """
        return Fraction(self.successes, self.trials) if self.trials else Fraction(0)

    def interval(self, confidence: float = 0.95) -> tuple[float, float]:
        """Return Wilson's score interval for the probability of success (Wilson, 1927).

        Raises:
            QueryError: the confidence is not between 0 and 1.
        """
        if not 0.0 < confidence < 1.0:
            raise QueryError(f"a confidence is above 0 and below 1, such as 0.95; got {confidence!r}")
        if self.trials == 0:
            return 0.0, 1.0
        z, n, p = NormalDist().inv_cdf(0.5 + confidence / 2), self.trials, self.successes / self.trials
        middle, spread = p + z * z / (2 * n), z * math.sqrt(p * (1 - p) / n + z * z / (4 * n * n))
        low, high = (middle - spread) / (1 + z * z / n), (middle + spread) / (1 + z * z / n)
        # Where all or none succeed the end is known, but not met by what floats make of it.
        return (0.0 if self.successes == 0 else low), (1.0 if self.successes == n else high)

    def __str__(self) -> str:
        """Tell the share in percent, with its interval of 95 % and the counts."""
        low, high = self.interval()
        return (
            f"{100 * float(self.share):.0f} % ({100 * low:.0f} to {100 * high:.0f}; {self.successes} of {self.trials})"
        )


@dataclass(frozen=True)
class Run:
    """What became of a task: the actions that were pursued, how often each was tried, and how many were reached.

    `first` is the stage with which it began; `actions` are all from there to the last that was asked for, `tries` and
    `steps` of those that were pursued.
    """

    task: Task
    first: int
    actions: tuple[Atom, ...]
    tries: tuple[int, ...]
    steps: tuple[int, ...]
    reached: int

    @property
    def success(self) -> bool:
        """Whether all were reached."""
        return self.reached == len(self.actions)


@dataclass(frozen=True)
class Runs:
    """What became of some tasks."""

    runs: tuple[Run, ...]

    def whole(self) -> Rate:
        """Return how many were done as a whole."""
        return Rate(sum(run.success for run in self.runs), len(self.runs))

    def by_stage(self) -> tuple[Rate, ...]:
        """Return for each stage how many of those that came to it, and have it, have reached it.

        Where all runs have the same number of stages, the product of the shares is that of `whole`, exactly.
        """
        trials = Counter(stage for run in self.runs for stage in range(len(run.tries)))
        reached = Counter(stage for run in self.runs for stage in range(run.reached))
        return tuple(Rate(reached[stage], trials[stage]) for stage in sorted(trials))

    def by_length(self) -> tuple[Fraction, ...]:
        """Return for each length, from 1, the share of plans of which all stages so far are reached.

        It is the product of the shares of the stages: among runs of one length the share that came so far, among runs
        of several lengths the estimate of Kaplan and Meier (1958), in which all count as far as they go.
        """
        return tuple(accumulate((rate.share for rate in self.by_stage()), lambda one, other: one * other))

    def by_action(self) -> Mapping[str, Rate]:
        """Return for each name of an action how often it was reached where it was pursued."""
        trials: Counter[str] = Counter()
        reached: Counter[str] = Counter()
        for run in self.runs:
            for stage, action in enumerate(run.actions[: len(run.tries)]):
                trials[action.name] += 1
                reached[action.name] += stage < run.reached
        return {name: Rate(reached[name], trials[name]) for name in sorted(trials)}

    def table(self) -> str:
        """Return a table as text: each stage, each action, and the whole."""
        rows = [(f"stage {number}", rate) for number, rate in enumerate(self.by_stage(), 1)]
        rows += [*self.by_action().items(), ("whole", self.whole())]
        wide = max(len(name) for name, _ in rows)
        return "\n".join(f"{name:<{wide}}  {rate}" for name, rate in rows)


def run(
    env: gymnasium.Env[Any, Any] | TaskSpace,
    policies: Policy | Mapping[str, Policy],
    tasks: Asked,
    *,
    tries: int = 1,
    patience: int = STEPS,
    seed: int | None = None,
) -> Runs:
    """Pursue tasks with a policy for each skill, and return what became of them.

    `policies` are by the names of actions (``pick``) or by skills (``place(panda,_,left_of,_)``), which go first; one
    alone is for all. Each subgoal may be pursued for `patience` steps, `tries` times: after a failure its policy takes
    over anew, from where everything stands by then. `tasks` are tasks, with their witnesses or without, or how many
    are drawn, from a `seed`. The environment, a `TaskEnv` in whatever wrappers, says which subgoals of a task are
    pursued and what policies see; it is left open. That which is made for a space is closed.

    Raises:
        QueryError: it is another environment, a number is below 1, a policy is missing, or a task has no witness.
    """
    if isinstance(env, TaskSpace):
        made = TaskEnv(env, reward="sparse")
        try:
            return run(made, policies, tasks, tries=tries, patience=patience, seed=seed)
        finally:
            made.close()
    if not isinstance(getattr(env, "unwrapped", None), TaskEnv):
        raise QueryError(f"plans are pursued in a TaskEnv, or in a task space; got {env!r:.80}")
    for number, what in ((tries, "tries"), (patience, "patience")):
        if type(number) is not int or number < 1:
            raise QueryError(f"{what} is a whole number from 1 on; got {number!r}")
    found = []
    for options in _asked(tasks):
        observation, _ = env.reset(seed=seed, options=options)
        seed = None
        found.append(_pursued(env, policies, observation, tries, patience))
    return Runs(tuple(found))


def _asked(tasks: Asked) -> Iterator[dict[str, Any]]:
    """Yield what the environment is told at the begin of each run.

    Raises:
        QueryError: these are no tasks.
    """
    if isinstance(tasks, int) and not isinstance(tasks, bool) and tasks > 0:
        yield from ({} for _ in range(tasks))
        return
    if not isinstance(tasks, Iterable):
        raise QueryError(f"tasks are tasks, or how many are drawn, at least 1; got {tasks!r}")
    for each in tasks:
        given = (each, None) if isinstance(each, Task) else each
        if not isinstance(given, tuple) or len(given) != 2:
            raise QueryError(f"tasks are tasks, or pairs of a task and its witness; got {each!r:.80}")
        yield {"task": given[0], "witness": given[1]}


def _pursued(
    wrapped: gymnasium.Env[Any, Any],
    policies: Policy | Mapping[str, Policy],
    observation: Any,
    tries: int,
    patience: int,
) -> Run:
    """Pursue the subgoals of an episode that has begun, until one fails."""
    env: TaskEnv = wrapped.unwrapped  # type: ignore[assignment]
    first, last = env.stage, env.last
    tried, steps = [], []
    ended = False
    for stage in range(first, last + 1):
        policy = _policy(policies, env)
        count = taken = 0
        while env.stage == stage and not ended and count < tries:
            count += 1
            observation, ended, more = _tried(wrapped, policy, observation, patience)
            taken += more
        tried.append(count)
        steps.append(taken)
        if env.stage == stage:
            break
    actions = env.task.actions[first : last + 1]
    return Run(env.task, first, actions, tuple(tried), tuple(steps), env.stage - first + ended)


def _tried(wrapped: gymnasium.Env[Any, Any], policy: Policy, observation: Any, patience: int) -> tuple[Any, bool, int]:
    """Let a policy pursue one subgoal; return what is seen then, whether the goal is reached, and after how many steps.

    An environment says that time is up, by its own count; here it goes on.
    """
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
    """Return the policy for the subgoal that is pursued.

    Raises:
        QueryError: there is none.
    """
    if not isinstance(policies, Mapping):
        return policies
    for name in (skill(env.action, env.scene), env.action.name):
        if name in policies:
            return policies[name]
    raise QueryError(unknown(env.action.name, policies, "policy"))

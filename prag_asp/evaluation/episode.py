"""Episodes in an evaluation: their scenarios, their results, and the rollout of a policy."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from hashlib import blake2b
from typing import TYPE_CHECKING, Any, NamedTuple

import gymnasium
import msgspec

from prag_asp.dataset.scenario import Scenario
from prag_asp.dataset.scenarios import Scenarios, verdict_of
from prag_asp.dataset.store.instructions import TaskTexts
from prag_asp.dataset.validation_jobs import initial_state_key
from prag_asp.errors import PragError, QueryError
from prag_asp.evaluation.policies.policy import Policy, PolicyMaker
from prag_asp.physics import open_validator
from prag_asp.rl.environment import TaskEnv
from prag_asp.space.task_space import TaskSpace
from prag_asp.tables.json_fields import Whole

if TYPE_CHECKING:
    from prag_asp.domain.load import Domain
    from prag_asp.physics import Validator, Witness
    from prag_asp.task import Task

SUCCESS, LIMIT, GAVE_UP = "success", "step limit", "gave up"
"""The reasons why an episode ends: success, the step limit, or a policy that returns no action."""

SEED_BYTES = 6
"""The size of the seed of an episode in bytes, which every generator accepts."""


class SubgoalResult(msgspec.Struct, frozen=True):
    """A subgoal that a policy pursued: its action, whether it was reached, and the number of steps."""

    action: str
    success: bool
    steps: Whole


class EvaluatedEpisode(msgspec.Struct, frozen=True):
    """The result of an episode.

    `part` is the part of a dataset or a suite, the stratum of a stratified sample, or "". `initial` is a digest of the
    initial state, and `classes` holds the classes of the entities in the actions. `reached` counts the subgoals that
    were reached; `subgoals` holds a result for each subgoal that was pursued. `cause` is one of `SUCCESS`, `LIMIT` and
    `GAVE_UP`; `seconds` is the simulated time. `weight` is the exact weight of the episode in a stratified sample, as
    text, and `weight_value` is the nearest float; without strata, these are "" and 0.
    """

    scenario: str
    part: str
    initial: str
    length: Whole
    task: list[str]
    classes: list[str]
    instruction: str
    success: bool
    reached: Whole
    subgoals: list[SubgoalResult]
    steps: Whole
    cause: str
    seconds: float
    weight: str = ""
    weight_value: float = 0.0


class EpisodeJob(NamedTuple):
    """An episode to run: its part, its scenario, and its task with a witness, or None to search for one.

    `texts` holds the instructions of the task from a dataset.
    """

    part: str
    scenario: Scenario
    given: tuple[Task, Witness] | None = None
    texts: TaskTexts | None = None


class JobGroup(NamedTuple):
    """The numbered jobs for a stratum or for all scenarios; they run until `requested` of them have a witness.

    `size` is the number of tasks from which the jobs are sampled, or `requested` if the scenarios are given.
    """

    name: str
    size: int
    requested: int
    jobs: Iterable[tuple[int, EpisodeJob]]


@dataclass(frozen=True)
class EpisodeSetup:
    """The common setup of all episodes in an evaluation; `options` are arguments of the environment."""

    domain: Domain
    lengths: tuple[int, ...]
    options: dict[str, Any]
    maker: PolicyMaker
    wrapper: Callable[[Any], gymnasium.Env[Any, Any]] | None
    seed: int
    name: str


Watch = Callable[[gymnasium.Env[Any, Any]], None]
"""A callback that receives the environment after its reset and after each step."""


class EpisodeRunner:
    """A runner of episodes in one environment with one policy."""

    def __init__(self, setup: EpisodeSetup, env: gymnasium.Env[Any, Any], policy: Policy, validator: Validator) -> None:
        self._setup, self._env, self._policy, self._validator = setup, env, policy, validator
        self._scenarios = Scenarios(setup.domain)

    @property
    def frame_rate(self) -> int:
        """The number of steps per second."""
        return int(self._env.unwrapped.metadata["render_fps"])

    def run(self, job: EpisodeJob, watch: Watch = lambda env: None) -> EvaluatedEpisode | None:
        """Return the result of an episode, or None if the search finds no witness for its task.

        The result depends only on the scenario, the policy and the seed.

        Raises:
            QueryError: the scenario does not belong to the domain, or the policy fails.
        """
        task, witness = job.given or self._searched(job.scenario)
        if witness is None:
            return None
        texts = None if "language" in self._setup.options else job.texts
        observation, info = self._env.reset(seed=0, options={"task": task, "witness": witness, "texts": texts})
        watch(self._env)
        steps, reached, stage, cause, ended = [0] * len(task), 0, 0, LIMIT, False
        with self._errors(job.scenario):
            self._policy.begin(episode_seed(self._setup.seed, job.scenario))
        while not ended:
            with self._errors(job.scenario):
                action = self._policy(observation, info)
                if action is None:
                    cause = GAVE_UP
                    break
                observation, _, done, late, info = self._env.step(action)
            watch(self._env)
            steps[stage] += 1
            stage, ended = int(info["stage"]), bool(done or late)
            reached = stage + bool(info["is_success"])
            if info["is_success"]:
                cause = SUCCESS
        subgoals = [SubgoalResult(str(task.actions[i]), i < reached, steps[i]) for i in range(stage + 1)]
        return EvaluatedEpisode(
            str(job.scenario), job.part, initial_digest(witness), len(task), [str(each) for each in task.actions],
            classes_of(task), info["instruction"], cause == SUCCESS, reached, subgoals, sum(steps),
            cause, sum(steps) / self.frame_rate,
        )  # fmt: skip

    def _searched(self, scenario: Scenario) -> tuple[Task, Witness | None]:
        """Return the task of a scenario, and the witness that its search finds."""
        task, start = self._scenarios.task(scenario), scenario.start
        if start is None:
            raise QueryError(f"scenario {scenario}: has no initial state; give one that physics found feasible")
        return task, verdict_of(task, start, self._validator).witness

    @contextmanager
    def _errors(self, scenario: Scenario) -> Iterator[None]:
        """Name the policy and the scenario in an error that the policy raises."""
        try:
            yield
        except (Exception, SystemExit) as error:  # a policy may raise anything
            reason = str(error) if isinstance(error, PragError) else _in_one_line(error)
            raise QueryError(f"policy {self._setup.name}, scenario {scenario}: {reason:.500}") from error


@contextmanager
def open_runner(setup: EpisodeSetup, **options: Any) -> Iterator[EpisodeRunner]:
    """Open an environment with further `options`, and make the policy.

    Raises:
        PragError: the options are wrong, or the policy cannot be made.
    """
    task_env = TaskEnv(TaskSpace(setup.domain, setup.lengths), **setup.options, **options)
    try:
        env: gymnasium.Env[Any, Any] = task_env
        if setup.wrapper is not None:
            with _constructing("the wrapper"):
                env = setup.wrapper(task_env)
        if not isinstance(getattr(env, "unwrapped", None), TaskEnv):
            raise QueryError(f"the wrapper returns {env!r:.80}, which is not a wrapped environment")
        with open_validator(task_env.scene) as validator:
            with _constructing(f"policy {setup.name}"):
                policy = setup.maker(env)
            try:
                yield EpisodeRunner(setup, env, policy, validator)
            finally:
                getattr(policy, "close", lambda: None)()
    finally:
        task_env.close()


@contextmanager
def _constructing(what: str) -> Iterator[None]:
    """Name the policy or the wrapper in an error from its constructor, unless the error is a `PragError`."""
    try:
        yield
    except PragError:
        raise
    except (Exception, SystemExit) as error:  # a constructor may raise anything
        raise QueryError(f"{what} cannot be created: {_in_one_line(error):.500}") from error


def _in_one_line(error: BaseException) -> str:
    """Return the type and the message of an error in one line."""
    return " ".join(f"{type(error).__name__}: {error}".split())


@contextmanager
def open_episodes(setup: EpisodeSetup) -> Iterator[Callable[[int, EpisodeJob], EvaluatedEpisode | None]]:
    """Yield a function that runs a numbered episode, for use in a worker."""
    with open_runner(setup) as runner:

        def run(_: int, job: EpisodeJob) -> EvaluatedEpisode | None:
            return runner.run(job)

        yield run


def classes_of(task: Task) -> list[str]:
    """Return the classes of the entities in the actions of a task."""
    return sorted(
        {task.entities[name] for action in task.actions for name in action.arguments if name in task.entities}
    )


def episode_seed(seed: int, scenario: Scenario) -> int:
    """Return the seed for a policy's random choices in a scenario; it does not depend on other scenarios."""
    return int.from_bytes(blake2b(f"{seed} {scenario}".encode(), digest_size=SEED_BYTES).digest(), "big")


def initial_digest(witness: Witness) -> str:
    """Return a digest of the initial state of a witness."""
    return blake2b(initial_state_key(witness).encode(), digest_size=8).hexdigest()

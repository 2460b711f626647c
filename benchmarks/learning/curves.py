"""Learning curves of a skill for each kind of reward: soft actor-critic that begins in states of witnesses.

    python benchmarks/learning/curves.py approach --steps 5000
    python benchmarks/learning/curves.py grasp --steps 4000 --rewards dense
    python benchmarks/learning/curves.py grasp --begin task --rewards dense

Each policy is trained on subgoals of one set of witnesses and tested on another; with `--unseen box_1`, tested on an
object that no training task names. With `--begin`, whole tasks that end with the skill are learned: episodes begin at
the home pose (`task`), at a uniformly sampled subgoal (`any`), at a subgoal that moves back towards home (`backwards`),
or at the skill itself (`last`). These policies are tested on the last subgoal and on whole tasks.

Appends to SKILL.parquet in the folder --output and draws SKILL.png; seeds in the file are not trained again. Requires
the extra `learning`; takes about a minute for each seed.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq
import torch
from matplotlib.figure import Figure
from normed import Normed
from rich.console import Console
from rich.table import Table
from stable_baselines3 import SAC
from starts import (
    DOMAINS,
    HELD_OUT,
    TRAINING,
    FromStarts,
    ScaledActions,
    SkillObservations,
    Start,
    require_apart,
    starts,
)

from prag_asp.rl import Rate, ReverseCurriculum, TaskEnv
from prag_asp.rl.rewards import REWARDS

COLOURS = {"dense": "#2e86ab", "faded": "#3a9d5d", "sparse": "#e4572e"}

SETTINGS: dict[str, Any] = {
    "policy": "MlpPolicy", "learning_rate": 1e-3, "gamma": 0.95, "batch_size": 128, "learning_starts": 300,
    "gradient_steps": 2, "policy_kwargs": {"net_arch": [64, 64]}, "device": "cpu",
}  # fmt: skip
"""The parameters of soft actor-critic; others have the default values of Stable-Baselines3."""

OWN: dict[str, dict[str, Any]] = {"grasp": {"policy": Normed, "ent_coef": "auto_0.02"}}
"""The parameters that differ for a skill. Closing the fingers earns little and ends the episode.

With the default initial entropy coefficient, the agent first learns to postpone it; without normalised critics, it
unlearns the grasp again because their estimates keep growing.
"""

AT_MOST = 100
"""The time limit of a subgoal in steps, in tests and by default."""

STEPS = {"grasp": 25}
"""The time limit of a skill in training episodes, in steps, if it differs from the default."""

BEGUN: dict[str, dict[str, Any]] = {
    "last": {"stage": -1}, "task": {"stage": 0}, "any": {"stage": "any"},
    "backwards": {"curriculum": ReverseCurriculum()},
}  # fmt: skip
"""The arguments of the environment for the stage at which training episodes begin."""

PURSUED = 50
"""The time limit of each subgoal of whole tasks in training episodes, in steps."""


def main() -> None:
    """Train the missing policies, write the curves, print the table and draw the figure."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("skill", choices=sorted(DOMAINS), help="the action that is learned")
    parser.add_argument("--rewards", nargs="*", choices=REWARDS, default=list(REWARDS))
    parser.add_argument("--steps", type=int, default=5000, help="training steps of a policy")
    parser.add_argument("--every", type=int, default=1000, help="steps between two tests")
    parser.add_argument("--seeds", type=int, default=3, help="policies for each reward")
    parser.add_argument("--training", type=int, default=100, help="training witnesses")
    parser.add_argument("--held-out", type=int, default=30, help="test witnesses")
    parser.add_argument("--unseen", help="an object that occurs only in tests, such as box_1")
    parser.add_argument(
        "--begin", choices=BEGUN, help="train on whole tasks that end with the skill; where episodes begin"
    )
    parser.add_argument("--output", type=Path, default=Path("learned"), help="the folder of the curves and figures")
    parser.add_argument(
        "--models", type=Path, help="a folder for the trained policies, in the format of Stable-Baselines3"
    )
    options = parser.parse_args()
    torch.set_num_threads(1)
    options.output.mkdir(parents=True, exist_ok=True)
    name = options.skill if options.unseen is None else f"{options.skill}_unseen_{options.unseen}"
    name = name if options.begin is None else f"{name}_from_{options.begin}"
    path = options.output / f"{name}.parquet"
    rows = pq.read_table(path).to_pylist() if path.exists() else []
    learned = {(row["reward"], row["seed"]) for row in rows}
    requests = [(reward, seed) for reward in options.rewards for seed in range(options.seeds)]
    if missing := [each for each in requests if each not in learned]:
        last = options.begin is not None
        given = starts(options.skill, options.training, seed=TRAINING, without=options.unseen, last=last)
        others = starts(options.skill, options.held_out, seed=HELD_OUT, only=options.unseen, last=last)
        require_apart(given, others, tasks=options.unseen is not None)
        for reward, seed in missing:
            rows += curve(given, others, reward, seed, options, name)
            pq.write_table(pa.Table.from_pylist(rows), path)
    Console().print(_table(rows))
    draw(rows, name.replace("_", " ")).savefig(options.output / f"{name}.png", dpi=110)


def curve(
    given: Sequence[Start], others: Sequence[Start], reward: str, seed: int, options: argparse.Namespace, name: str
) -> Iterator[dict[str, Any]]:
    """Train a policy and yield its success on held-out witnesses over time."""
    console = Console(stderr=True)
    env, test = begun(given, reward, seed=seed, begin=options.begin), begun(others, "sparse")
    wholes = begun(others, "sparse", begin="task") if options.begin is not None else None
    model = SAC(env=env, seed=seed, **SETTINGS | OWN.get(options.skill, {}))
    seconds = 0.0
    for step in range(options.every, options.steps + 1, options.every):
        before = time.process_time()
        model.learn(options.every, reset_num_timesteps=step == options.every)
        seconds += time.process_time() - before
        rate = Rate(sum([reaches(model, test) for _ in others]), len(others))
        whole = None if wholes is None else Rate(sum([reaches(model, wholes) for _ in others]), len(others))
        console.print(
            f"{name.replace('_', ' ')}, {reward}, seed {seed}, {step} steps, {seconds:.0f} s: {rate}"
            + (f", whole tasks {whole}" if whole is not None else "")
        )
        yield {
            "skill": options.skill,
            "reward": reward,
            "seed": seed,
            "step": step,
            "successes": rate.successes,
            "trials": rate.trials,
            "processor_seconds": round(seconds, 1),
            **({"whole": whole.successes} if whole is not None else {}),
        }
    if options.models is not None:
        model.save(options.models / f"{name}_{reward}_{seed}")
    for each in (env, test, wholes):
        if each is not None:
            each.close()


def begun(given: Sequence[Start], reward: Any, *, seed: int | None = None, begin: str | None = None) -> FromStarts:
    """Return an environment whose episodes begin with given subgoals: sampled if there is a seed, else in turn.

    With `begin`, an episode lasts until the whole task ends, and begins as `BEGUN` says.
    """
    task, witness, stage = given[0]
    least = STEPS.get(task.actions[stage].name, AT_MOST) if begin is None else PURSUED
    options: dict[str, Any] = {"until": "subgoal"} if begin is None else BEGUN[begin]
    steps = AT_MOST if seed is None else least
    env = TaskEnv(task=task, witness=witness, reward=reward, steps=steps, **options)
    return FromStarts(ScaledActions(SkillObservations(env)), given, seed=seed, at_stage=begin is None)


def reaches(model: SAC, env: FromStarts) -> bool:
    """Return whether a policy reaches the next subgoal of an environment."""
    seen, _ = env.reset()
    done = late = False
    while not done and not late:
        seen, _, done, late, _ = env.step(model.predict(seen, deterministic=True)[0])
    return done


def _pooled(rows: Sequence[dict[str, Any]]) -> dict[str, dict[int, Rate]]:
    """Return the rates of all seeds together, by reward and step."""
    rates: dict[str, dict[int, Rate]] = {}
    for row in rows:
        steps = rates.setdefault(row["reward"], {})
        successes, trials = steps.get(row["step"], (0, 0))
        steps[row["step"]] = Rate(successes + row["successes"], trials + row["trials"])
    return rates


def _table(rows: Sequence[dict[str, Any]]) -> Table:
    """Return the table of the final tests."""
    wholes = "whole" in rows[0]
    table = Table("reward", "steps", "seeds", "all", *["whole tasks"] * wholes, "processor seconds of a seed")
    for reward, steps in _pooled(rows).items():
        step = max(steps)
        last = [row for row in rows if row["reward"] == reward and row["step"] == step]
        seeds = ", ".join(f"{row['successes'] / row['trials']:.2f}" for row in last)
        seconds = sum(row["processor_seconds"] for row in last) / len(last)
        whole = [str(Rate(sum(row["whole"] for row in last), steps[step].trials))] if wholes else []
        table.add_row(reward, f"{step:,}", seeds, str(steps[step]), *whole, f"{seconds:.0f}")
    return table


def draw(rows: Sequence[dict[str, Any]], title: str) -> Figure:
    """Return a figure of the curves: each seed, and the pooled rate with 95 % intervals."""
    figure = Figure(figsize=(6.4, 3.8), layout="constrained")
    axes = figure.add_subplot()
    for reward, steps in _pooled(rows).items():
        colour = COLOURS[reward]
        for seed in sorted({row["seed"] for row in rows if row["reward"] == reward}):
            own = [row for row in rows if (row["reward"], row["seed"]) == (reward, seed)]
            shares = [row["successes"] / row["trials"] for row in own]
            axes.plot([row["step"] for row in own], shares, color=colour, alpha=0.35, linewidth=0.8)
        low, high = zip(*(rate.interval() for rate in steps.values()), strict=True)
        axes.plot(list(steps), [float(rate.share) for rate in steps.values()], "o-", color=colour, label=reward)
        axes.fill_between(list(steps), low, high, color=colour, alpha=0.15, linewidth=0)
    axes.set(xlabel="steps", ylabel="success with held-out witnesses", ylim=(-0.03, 1.03), title=title)
    axes.grid(alpha=0.3)
    axes.legend(loc="best", frameon=False)
    return figure


if __name__ == "__main__":
    main()

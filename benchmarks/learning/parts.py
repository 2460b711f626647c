"""A whole pick from the home pose, learned in parts: an approach, and a grasp that begins where the approach ends.

    python benchmarks/learning/parts.py

Soft actor-critic learns each part of the tasks of `prag` that approach an object and grasp it. The grasp is learned
twice: from states of witnesses, and from the final states of the learned approach. Both are chained from the home pose
on held-out witnesses; the predicates decide when the grasp takes over.

Writes parts.parquet and parts.png into the folder --output; seeds in the file are not trained again. Requires the extra
`learning`; takes about three minutes of processor time for each seed.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import gymnasium
import pyarrow as pa
import pyarrow.parquet as pq
import torch
from curves import AT_MOST, OWN, SETTINGS, STEPS, begun
from matplotlib.figure import Figure
from rich.console import Console
from rich.table import Table
from stable_baselines3 import SAC
from starts import HELD_OUT, TRAINING, FromStarts, Start, require_apart, wholly

from prag_asp.rl import Rate, run
from prag_asp.rl.skill_chains import Policy

SKILLS = ("approach", "grasp")
LEARNED_FROM = ("witnesses", "where the approach ends")
COLOURS = dict(zip(LEARNED_FROM, ("#0072b2", "#d55e00"), strict=True))

IN_VAIN = 5
"""The number of failed approaches in a row after which an episode begins in the state of a witness."""


def main() -> None:
    """Train the missing policies, write the curves, print the table and draw the figure."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--approach", type=int, default=6000, help="training steps of an approach")
    parser.add_argument("--grasp", type=int, default=2000, help="training steps of a grasp")
    parser.add_argument("--every", type=int, default=1000, help="steps between two tests")
    parser.add_argument("--seeds", type=int, default=3, help="policies of each kind")
    parser.add_argument("--training", type=int, default=100, help="training witnesses")
    parser.add_argument("--held-out", type=int, default=30, help="test witnesses")
    parser.add_argument("--output", type=Path, default=Path("learned"), help="the folder of the curves and the figure")
    parser.add_argument(
        "--models", type=Path, help="a folder for the trained policies, in the format of Stable-Baselines3"
    )
    options = parser.parse_args()
    torch.set_num_threads(1)
    options.output.mkdir(parents=True, exist_ok=True)
    path = options.output / "parts.parquet"
    rows = pq.read_table(path).to_pylist() if path.exists() else []
    if missing := sorted(set(range(options.seeds)) - {row["seed"] for row in rows}):
        given = wholly(SKILLS, options.training, seed=TRAINING)
        others = wholly(SKILLS, options.held_out, seed=HELD_OUT)
        require_apart(given, others, tasks=False)
        for seed in missing:
            rows += learned(given, others, seed, options)
            pq.write_table(pa.Table.from_pylist(rows), path)
    Console().print(table(rows))
    draw(rows).savefig(options.output / "parts.png", dpi=110)


def learned(
    given: Sequence[Start], others: Sequence[Start], seed: int, options: argparse.Namespace
) -> Iterator[dict[str, Any]]:
    """Train the approach and then each of two grasps; yield the success of chained policies from home over time."""
    first = begun(given, "dense", seed=seed)
    approach = SAC(env=first, seed=seed, **SETTINGS)
    yield from _curve("approach", "witnesses", approach, {"approach": approach}, others, seed, options)
    for whence in LEARNED_FROM:
        env: gymnasium.Env[Any, Any]
        if whence == "witnesses":
            env = begun([start._replace(stage=1) for start in given], "dense", seed=seed)
        else:
            env = After(begun(given, "dense", seed=seed, begin="task"), approach, limit=STEPS["grasp"])
        grasp = SAC(env=env, seed=seed, **SETTINGS | OWN["grasp"])
        yield from _curve("grasp", whence, grasp, {"approach": approach, "grasp": grasp}, others, seed, options)
        env.close()
    first.close()


def _curve(
    skill: str,
    whence: str,
    model: SAC,
    models: Mapping[str, SAC],
    others: Sequence[Start],
    seed: int,
    options: argparse.Namespace,
) -> Iterator[dict[str, Any]]:
    """Train a model for a skill; yield at intervals how many stages the chained models reach from home."""
    console, seconds = Console(stderr=True), 0.0
    test = begun(others, "sparse", begin="task")
    policies = {name: _policy(each) for name, each in models.items()}
    policies.setdefault("grasp", lambda _: None)
    for step in range(options.every, getattr(options, skill) + 1, options.every):
        before = time.process_time()
        model.learn(options.every, reset_num_timesteps=step == options.every)
        seconds += time.process_time() - before
        runs = run(test.env, policies, [(start.task, start.witness) for start in others], patience=AT_MOST).rollouts
        came = [sum(each.reached > stage for each in runs) for stage in range(len(SKILLS))]
        rate = Rate(came[list(models).index(skill)], len(runs))
        console.print(f"{skill}, learned from {whence}, seed {seed}, {step} steps, {seconds:.0f} s: {rate} from home")
        yield {
            "skill": skill,
            "learned_from": whence,
            "seed": seed,
            "step": step,
            **dict(zip(SKILLS, came, strict=True)),
            "trials": len(runs),
            "processor_seconds": round(seconds, 1),
        }
    if options.models is not None:
        model.save(options.models / f"parts_{skill}_{whence.replace(' ', '_')}_{seed}")
    test.close()


def _policy(model: SAC) -> Policy:
    """Return the deterministic policy of a model."""
    return lambda seen: model.predict(seen, deterministic=True)[0]


class After(gymnasium.Wrapper):
    """Begins each episode where a policy has reached the first subgoal of a task; an episode lasts `limit` steps.

    After `IN_VAIN` failures in a row, it begins in the state of a witness instead.
    """

    def __init__(self, env: FromStarts, model: SAC, *, limit: int):
        super().__init__(env)
        self._policy, self._limit, self._left = _policy(model), limit, limit

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> Any:
        """Run the policy to the subgoal, from one start after another."""
        self._left = self._limit
        for _ in range(IN_VAIN):
            seen, info = self.env.reset(seed=seed)
            seed = None
            for _ in range(AT_MOST):
                seen, _, done, late, info = self.env.step(self._policy(seen))
                if self.unwrapped.stage == 1 and not done and not late:
                    return seen, info
                if done or late:
                    break
        return self.env.reset(options={"stage": 1})

    def step(self, action: Any) -> Any:
        """Act; the time limit counts the steps of this episode alone."""
        seen, gain, done, late, info = self.env.step(action)
        self._left -= 1
        return seen, gain, done, late or (self._left <= 0 and not done), info


def _last(rows: Sequence[dict[str, Any]], skill: str, whence: str) -> list[dict[str, Any]]:
    """Return the last row of each seed."""
    own = [row for row in rows if (row["skill"], row["learned_from"]) == (skill, whence)]
    return [row for row in own if row["step"] == max(each["step"] for each in own)]


def table(rows: Sequence[dict[str, Any]]) -> Table:
    """Return the table of the final tests: success of whole picks, and of each part."""
    result = Table("grasp learned from", "approach", "grasp, once there", "whole pick, seeds", "whole pick", "seconds")
    before = _last(rows, "approach", "witnesses")
    for whence in LEARNED_FROM:
        last = _last(rows, "grasp", whence)
        approached, held, trials = (sum(row[name] for row in last) for name in (*SKILLS, "trials"))
        seeds = ", ".join(f"{row['grasp'] / row['trials']:.2f}" for row in last)
        seconds = sum(row["processor_seconds"] for row in (*before, *last)) / len(last)
        parts = Rate(approached, trials), Rate(held, approached)
        result.add_row(whence, *map(str, parts), seeds, str(Rate(held, trials)), f"{seconds:.0f}")
    return result


def draw(rows: Sequence[dict[str, Any]]) -> Figure:
    """Return a figure of whole picks over training steps: each seed, and the pooled rate with 95 % intervals."""
    figure = Figure(figsize=(6.4, 3.8), layout="constrained")
    axes = figure.add_subplot()
    learned_before = max(row["step"] for row in rows if row["skill"] == "approach")
    for whence in LEARNED_FROM:
        own = [row for row in rows if (row["skill"], row["learned_from"]) == ("grasp", whence)]
        steps = sorted({row["step"] for row in own})
        at = [learned_before + step for step in steps]
        for seed in sorted({row["seed"] for row in own}):
            shares = [row["grasp"] / row["trials"] for row in own if row["seed"] == seed]
            axes.plot(at, shares, color=COLOURS[whence], alpha=0.35, linewidth=0.8)
        there = [[row for row in own if row["step"] == step] for step in steps]
        rates = [Rate(*(sum(row[name] for row in each) for name in ("grasp", "trials"))) for each in there]
        low, high = zip(*(rate.interval() for rate in rates), strict=True)
        label = f"grasp learned from {whence}"
        axes.plot(at, [float(rate.share) for rate in rates], "o-", color=COLOURS[whence], label=label)
        axes.fill_between(at, low, high, color=COLOURS[whence], alpha=0.15, linewidth=0)
    axes.set(xlabel="steps of the approach and the grasp", ylabel="whole picks from home", ylim=(-0.03, 1.03))
    axes.grid(alpha=0.3)
    axes.legend(loc="lower right", frameon=False)
    return figure


if __name__ == "__main__":
    main()

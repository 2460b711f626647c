"""Success over plan length: policies chained along held-out plans of six actions, each continuing from the last state.

    python benchmarks/learning/chained.py --learned MODELS

Compares the oracle; behaviour cloning from 200 successful demonstrations, one network for each of three seeds; and,
with `--learned`, policies for approach and grasp trained by plain.py (`--models MODELS`), with the oracle for other
actions. Writes chained.parquet and chained.png into the folder --output. Requires the extra `learning`.
"""

from __future__ import annotations

import argparse
import itertools
import time
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq
import torch
from cloning import Clone, Demonstration, cloned, demonstrations
from matplotlib.figure import Figure
from rich.console import Console
from rich.table import Table
from stable_baselines3 import SAC
from starts import HELD_OUT, TRAINING, witnessed

from prag_asp.rl import OraclePolicy, Rate, TaskEnv, run
from prag_asp.rl.skill_chains import Policy

DOMAIN = "prag"
LEARNED = {"approach": "SAC_PragApproach", "grasp": "SAC_PragGrasp"}
WEIGHTS = {"approach": 6, "withdraw": 6, "grasp": 6, "drop": 6}
"""Uniformly sampled tasks consist mostly of carrying, because there are many more ways to carry an object."""

COLOURS = {"oracle": "#777777", "cloned": "#0072b2", "learned": "#d55e00"}
LABELS = {"oracle": "oracle", "cloned": "cloned", "learned": "approach and grasp learned, the rest oracle"}

Policies = Policy | Mapping[str, Policy]


def main() -> None:
    """Clone and chain policies, write the results of each run, print the tables and draw the figure."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--demonstrations", type=int, default=200, help="successful demonstrations to learn from")
    parser.add_argument("--epochs", type=int, default=60, help="training epochs of a clone")
    parser.add_argument("--count", type=int, default=30, help="held-out tasks")
    parser.add_argument("--length", type=int, default=6, help="actions of each task")
    parser.add_argument("--seeds", type=int, default=3, help="policies of each kind")
    parser.add_argument("--learned", type=Path, help="a folder of policies trained by plain.py")
    parser.add_argument("--output", type=Path, default=Path("learned"), help="the folder of the runs and the figure")
    options = parser.parse_args()
    torch.set_num_threads(1)
    console, rows = Console(), []
    drawn = witnessed(DOMAIN, options.length, seed=HELD_OUT, weights=WEIGHTS)
    given = list(itertools.islice(drawn, options.count))
    drawn.close()
    env = TaskEnv(task=given[0][0], witness=given[0][1], reward="sparse")
    for kind, seed, policies in _policies(env, options):
        before = time.process_time()
        runs = run(env, policies, given, patience=150)
        seconds = time.process_time() - before
        console.print(f"{kind}, seed {seed}, {seconds:.0f} s\n{runs.table()}\n", highlight=False)
        rows += [
            {"policy": kind, "seed": seed, "task": str(each.task), "reached": each.reached, "steps": list(each.steps)}
            for each in runs.rollouts
        ]
    env.close()
    options.output.mkdir(parents=True, exist_ok=True)
    pq.write_table(pa.Table.from_pylist(rows), options.output / "chained.parquet")
    console.print(so_far(rows, options.length))
    draw(rows, options.length).savefig(options.output / "chained.png", dpi=110)


def _policies(env: TaskEnv, options: argparse.Namespace) -> Iterator[tuple[str, int, Policies]]:
    """Yield each kind of policies with its seed and the policies."""
    expert = OraclePolicy(env)
    yield "oracle", 0, expert
    rest = {skill.partition("(")[0]: expert for skill in env.layout.skills}
    for seed in range(options.seeds if options.learned is not None else 0):
        own = {name: _learned(options.learned / f"{model}_{seed}") for name, model in LEARNED.items()}
        yield "learned", seed, {**rest, **own}
    examples = _collect(options.demonstrations)
    for seed in range(options.seeds):
        yield "cloned", seed, Clone(cloned(examples, epochs=options.epochs, seed=seed))


def _collect(count: int) -> list[Demonstration]:
    """Return `count` successful demonstrations, and print the number of tasks that were tried."""
    before = time.process_time()
    drawn = witnessed(DOMAIN, 4, seed=TRAINING, weights=WEIGHTS)
    examples, tried = demonstrations(drawn, count, seed=TRAINING)
    drawn.close()
    steps, seconds = sum(len(each.actions) for each in examples), time.process_time() - before
    Console().print(f"{count} of {tried} demonstrations succeed: {steps:,} steps, {seconds:.0f} s\n", highlight=False)
    return examples


def _learned(path: Path) -> Policy:
    """Return a policy that plain.py has trained."""
    model = SAC.load(path, device="cpu")
    return lambda observation: model.predict(observation, deterministic=True)[0]


def so_far(rows: Sequence[dict[str, Any]], length: int) -> Table:
    """Return the table of the plans that reached each length, of all and of those that reached the previous one."""
    table = Table("policy", "actions", "plans done so far", "of those of one action less")
    for kind in dict.fromkeys(row["policy"] for row in rows):
        reached = [sum(row["reached"] >= count for row in rows if row["policy"] == kind) for count in range(length + 1)]
        for count in range(1, length + 1):
            parts = Rate(reached[count], reached[0]), Rate(reached[count], reached[count - 1])
            table.add_row(LABELS[kind], str(count), *map(str, parts))
    return table


def draw(rows: Sequence[dict[str, Any]], length: int) -> Figure:
    """Return a figure of the share of plans that reached each length, with 95 % intervals."""
    figure = Figure(figsize=(6.4, 3.8), layout="constrained")
    axes = figure.add_subplot()
    lengths = range(1, length + 1)
    for kind in dict.fromkeys(row["policy"] for row in rows):
        reached = [row["reached"] for row in rows if row["policy"] == kind]
        rates = [Rate(sum(each >= count for each in reached), len(reached)) for count in lengths]
        low, high = zip(*(rate.interval() for rate in rates), strict=True)
        axes.plot(lengths, [float(rate.share) for rate in rates], "o-", color=COLOURS[kind], label=LABELS[kind])
        axes.fill_between(lengths, low, high, color=COLOURS[kind], alpha=0.15, linewidth=0)
    axes.set(xlabel="actions", ylabel="share of plans done so far", ylim=(-0.03, 1.03), title=DOMAIN)
    axes.grid(alpha=0.3)
    axes.legend(loc="lower left", frameon=False)
    return figure


if __name__ == "__main__":
    main()

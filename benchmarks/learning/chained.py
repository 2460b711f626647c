"""Success against length: policies chained along held-out plans of six actions, each from where the last left all.

    python benchmarks/learning/chained.py --learned MODELS

Three are compared: the oracle; clones of its behaviour in 200 demonstrations that end well, one network for each of
three seeds; and, with `--learned`, what curves.py has learned of approach and grasp (`--models MODELS`), where the
oracle does the rest.
Writes chained.parquet and chained.png into the folder of --output. It needs the extra `learning`.
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
from starts import HELD_OUT, TRAINING, moved, shown, witnessed

from prag_asp.rl import Layout, OraclePolicy, Rate, TaskEnv, run
from prag_asp.rl.skill_chains import Policy

DOMAIN, LEARNED = "prag", ("approach", "grasp")
WEIGHTS = {"approach": 6, "withdraw": 6, "grasp": 6, "drop": 6}
"""Tasks drawn uniformly carry something nearly all the time, for there are so many ways to do that."""

COLOURS = {"oracle": "#777777", "cloned": "#0072b2", "learned": "#d55e00"}
LABELS = {"oracle": "oracle", "cloned": "cloned", "learned": "approach and grasp learned, the rest oracle"}

Policies = Policy | Mapping[str, Policy]


def main() -> None:
    """Clone, chain, write what became of each run, print the tables and draw the figure."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--demonstrations", type=int, default=200, help="how many that end well are learned from")
    parser.add_argument("--epochs", type=int, default=60, help="how often a clone goes through them")
    parser.add_argument("--count", type=int, default=30, help="how many held-out tasks are pursued")
    parser.add_argument("--length", type=int, default=6, help="how many actions they have")
    parser.add_argument("--seeds", type=int, default=3, help="how many policies of a kind are chained")
    parser.add_argument("--learned", type=Path, help="a folder of policies that curves.py has learned")
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
    """Yield each kind of policies, its seed, and the policies."""
    expert = OraclePolicy(env)
    yield "oracle", 0, expert
    rest = {skill.partition("(")[0]: expert for skill in env.layout.skills}
    for seed in range(options.seeds if options.learned is not None else 0):
        own = {name: _learned(options.learned, name, seed, env.layout) for name in LEARNED}
        yield "learned", seed, {**rest, **own}
    demonstrated = _demonstrated(options.demonstrations)
    for seed in range(options.seeds):
        yield "cloned", seed, Clone(cloned(demonstrated, epochs=options.epochs, seed=seed), env.layout)


def _demonstrated(count: int) -> list[Demonstration]:
    """Return so many demonstrations that end well, and tell of how many tasks they came."""
    before = time.process_time()
    drawn = witnessed(DOMAIN, 4, seed=TRAINING, weights=WEIGHTS)
    found, asked = demonstrations(drawn, count, seed=TRAINING)
    drawn.close()
    steps, seconds = sum(len(each.actions) for each in found), time.process_time() - before
    Console().print(f"{count} of {asked} demonstrations end well: {steps:,} steps, {seconds:.0f} s\n", highlight=False)
    return found


def _learned(folder: Path, name: str, seed: int, layout: Layout) -> Policy:
    """Return a policy for a skill that curves.py has learned."""
    model, show, times = SAC.load(folder / f"{name}_dense_{seed}", device="cpu"), shown(layout), moved(name)
    return lambda observation: model.predict(show(observation), deterministic=True)[0] * times


def so_far(rows: Sequence[dict[str, Any]], length: int) -> Table:
    """Return the table of how many plans came to each length, of all and of those that came to the one before."""
    found = Table("policy", "actions", "plans done so far", "of those of one action less")
    for kind in dict.fromkeys(row["policy"] for row in rows):
        came = [sum(row["reached"] >= count for row in rows if row["policy"] == kind) for count in range(length + 1)]
        for count in range(1, length + 1):
            parts = Rate(came[count], came[0]), Rate(came[count], came[count - 1])
            found.add_row(LABELS[kind], str(count), *map(str, parts))
    return found


def draw(rows: Sequence[dict[str, Any]], length: int) -> Figure:
    """Return a figure of the share of plans of which so many actions were done, with intervals of 95 %."""
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

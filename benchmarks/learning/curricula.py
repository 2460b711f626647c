"""Whether curricula help: python benchmarks/learning/curricula.py.

Trains an agent (soft_actor_critic.py) with each curriculum and seed, for equal numbers of steps, on tasks of `prag` of
one to four actions, and tests it on tasks whose skeletons do not occur in training. Settings were chosen with a third
part, `--part validation`, and other seeds.

Writes the test episodes to curricula.parquet and the training episodes to curricula_training.parquet in the folder
--output; runs that are in the files are not repeated. The table compares each curriculum with uniform sampling: the
difference of the means over seeds with Welch's 95 % interval, and the p-value of the exact permutation test over seeds,
corrected for the number of curricula as by Holm.
"""

from __future__ import annotations

import itertools
import time
import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from statistics import mean
from typing import Any

import click
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from rich.console import Console
from rich.table import Table
from scipy import stats
from soft_actor_critic import Agent, Memory

from prag_asp import Task, TaskSpace, load_domain
from prag_asp.dataset.scenes import scene_of
from prag_asp.physics import Witness, open_validator
from prag_asp.rl import (
    AdaptiveCurriculum,
    BanditCurriculum,
    LengthCurriculum,
    NoveltyCurriculum,
    ReverseCurriculum,
    TaskEnv,
    run,
)
from prag_asp.space.conditions.whole_skeletons import SharesWarning

DOMAIN, LENGTHS = "prag", (1, 2, 3, 4)
WHERE = tuple(f"lacks {name}" for name in ("move", "follow", "rotate", "transform"))
"""Four skills remain: agents of all nine would not learn enough in a short training."""

SHARES = {"train": "0.6", "validation": "0.2", "test": "0.2"}
UNIFORM = "uniform"

CURRICULA: Mapping[str, Any] = {
    UNIFORM: None,
    "Length": LengthCurriculum(threshold="0.7", window=20),
    "Bandit": BanditCurriculum(lot=10),
    "Adaptive": AdaptiveCurriculum(lot=20, window=20),
    "Reverse": ReverseCurriculum(threshold="0.7", window=20),
    "Novelty": NoveltyCurriculum("skeletons"),
}
"""The curricula; runs are short, so they adapt after fewer episodes than by default."""

SUBGOAL_STEPS = 50
ENVIRONMENT: Mapping[str, Any] = {"action_scale": 0.5, "steps": SUBGOAL_STEPS}
RATE, BATCH, EVERY, RANDOM = 1e-3, 128, 2, 100
"""The learning rate, the transitions of a batch, the steps between updates, and the first steps, which are random."""

TESTED = 10_000
"""The seed of the test tasks and their initial states, the same for all runs."""

Given = Sequence[tuple[Task, Witness]]
Row = dict[str, Any]


@click.command()
@click.option("--curriculum", "names", type=click.Choice([*CURRICULA]), multiple=True, default=[*CURRICULA])
@click.option("--seeds", type=int, default=5, show_default=True, help="Agents for each curriculum.")
@click.option("--first-seed", type=int, default=0, show_default=True, help="The first of these seeds.")
@click.option("--steps", type=int, default=3000, show_default=True, help="Training steps.")
@click.option("--tests", type=int, default=40, show_default=True, help="Test tasks, as many of each length.")
@click.option("--part", type=click.Choice(["validation", "test"]), default="test", show_default=True)
@click.option("--output", type=Path, default=Path("learned"), help="The folder of the results.")
def main(
    names: Sequence[str],
    seeds: int,
    first_seed: int,
    steps: int,
    tests: int,
    part: str,
    output: Path,
) -> None:
    """Run what is missing, seed by seed, and print the table."""
    # Spaces with few skeletons cannot be divided exactly.
    warnings.filterwarnings("ignore", category=SharesWarning)
    output.mkdir(parents=True, exist_ok=True)
    paths = [output / "curricula.parquet", output / "curricula_training.parquet"]
    rows: list[list[Row]] = [pq.read_table(path).to_pylist() if path.exists() else [] for path in paths]
    given: Given | None = None
    for seed, name in itertools.product(range(first_seed, first_seed + seeds), names):
        key = {"curriculum": name, "seed": seed, "steps": steps, "part": part}
        if any(key.items() <= row.items() for row in rows[0]):
            continue
        given = given or held_out(part, tests)
        before = time.process_time()
        tested, trained = trial(name, seed, steps, given)
        seconds = time.process_time() - before
        rates = by_seed([{**key, **row} for row in tested], name)
        found = ", ".join(f"{what} {100 * each[0]:.0f} %" for what, each in rates.items())
        Console(stderr=True).print(f"{name}, seed {seed}, {seconds:.0f} s: {found}")
        rows[0] += [{**key, **row} for row in tested]
        rows[1] += [{**key, "seconds": round(seconds, 1), **row} for row in trained]
        for path, each in zip(paths, rows, strict=True):
            pq.write_table(pa.Table.from_pylist(each), path)
    Console().print(table([row for row in rows[0] if row["part"] == part and row["steps"] == steps]))


def held_out(part: str, count: int) -> Given:
    """Return tasks of a part with their witnesses, as many of each length."""
    domain, result = load_domain(DOMAIN), list[tuple[Task, Witness]]()
    with open_validator(scene_of(domain)) as validator:
        for length in LENGTHS:
            own = TaskSpace(domain, length).where(*WHERE).split_skeletons(SHARES, seed=0)[part]
            found = (
                (task, validator.validate(task, seed=TESTED, index=index).witness)
                for index, task in enumerate(own.stream(seed=TESTED))
            )
            feasible = ((task, witness) for task, witness in found if witness is not None)
            result += itertools.islice(feasible, count // len(LENGTHS))
    return result


def trial(name: str, seed: int, steps: int, given: Given) -> tuple[list[Row], list[Row]]:
    """Train an agent with a curriculum, and return its test episodes and its training episodes."""
    env = TaskEnv(
        domain=DOMAIN, length=LENGTHS, where=WHERE, split="train", shares=SHARES, skeletons=True,
        curriculum=CURRICULA[name], **ENVIRONMENT,
    )  # fmt: skip
    sizes = len(env.layout.names), len(env.control.low)
    agent, memory, trained = Agent(*sizes, seed=seed, rate=RATE), Memory(steps, *sizes), list[Row]()
    seen, _ = env.reset(seed=seed)
    for step in range(1, steps + 1):
        action = agent.rng.uniform(-1.0, 1.0, sizes[1]) if step <= RANDOM else agent.act(np.asarray(seen), sampled=True)
        following, reward, done, late, info = env.step(action.astype(np.float32))
        memory.add(seen, action, reward, following, done)
        seen = following
        if done or late:
            reached = info["stage"] + int(done)
            trained.append({"step": step, "task": info["task"], "length": info["subgoals"], "reached": reached})
            seen, _ = env.reset()
        if step > RANDOM and step % EVERY == 0:
            agent.update(memory.sample(agent.rng, BATCH))
    env.close()
    env = TaskEnv(task=given[0][0], witness=given[0][1], reward="sparse", **ENVIRONMENT)
    rollouts = run(env, agent.act, given, patience=SUBGOAL_STEPS).rollouts
    env.close()
    tested = [{"task": str(each.task), "length": len(each.actions), "reached": each.reached} for each in rollouts]
    return tested, trained


def by_seed(rows: Sequence[Row], name: str) -> dict[str, list[float]]:
    """Return the success rates of one curriculum for each seed: of whole tasks, and of the actions of tasks."""
    runs = [
        [row for row in rows if (row["curriculum"], row["seed"]) == (name, seed)]
        for seed in sorted({row["seed"] for row in rows if row["curriculum"] == name})
    ]
    return {
        "whole tasks": [mean(row["length"] == row["reached"] for row in own) for own in runs],
        "actions": [sum(row["reached"] for row in own) / sum(row["length"] for row in own) for own in runs],
    }


def permuted(first: Sequence[float], second: Sequence[float]) -> float:
    """Return the p-value of the exact two-sided permutation test of equal means."""
    test = stats.permutation_test(
        (first, second), lambda a, b: np.mean(a) - np.mean(b), permutation_type="independent", n_resamples=np.inf
    )
    return float(test.pvalue)


def holm(values: Sequence[float]) -> list[float]:
    """Return p-values corrected for their number by Holm's method (1979)."""
    result, largest = [0.0] * len(values), 0.0
    for rank, place in enumerate(sorted(range(len(values)), key=values.__getitem__)):
        largest = max(largest, min(1.0, (len(values) - rank) * values[place]))
        result[place] = largest
    return result


def interval(values: Sequence[float]) -> tuple[float, float]:
    """Return Student's 95 % interval of a mean."""
    half = stats.sem(values) * stats.t.ppf(0.975, len(values) - 1)
    return mean(values) - half, mean(values) + half


def table(rows: Sequence[Row]) -> Table:
    """Return the table of all curricula in percent."""
    result = Table("success rate", "curriculum", "seeds", "mean", "difference", "p", "p, Holm")
    rates = {name: by_seed(rows, name) for name in CURRICULA if any(row["curriculum"] == name for row in rows)}
    for what in ("whole tasks", "actions"):
        base = rates.get(UNIFORM, {}).get(what, [])
        others = [name for name in rates if name != UNIFORM and min(len(base), len(rates[name][what])) > 1]
        values = [permuted(rates[name][what], base) for name in others]
        corrected = dict(zip(others, zip(values, holm(values), strict=True), strict=True))
        for name, each in rates.items():
            own, compared = each[what], ["", "", ""]
            if name in corrected:
                welch = stats.ttest_ind(own, base, equal_var=False).confidence_interval()
                difference = mean(own) - mean(base)
                compared = [
                    f"{100 * difference:+.1f} ({100 * welch.low:+.1f} to {100 * welch.high:+.1f})",
                    *(f"{value:.3f}" for value in corrected[name]),
                ]
            bounds = "" if len(own) < 2 else " ({:.1f} to {:.1f})".format(*(100 * each for each in interval(own)))
            seeds = ", ".join(f"{100 * value:.0f}" for value in own)
            result.add_row(what, name, seeds, f"{100 * mean(own):.1f}{bounds}", *compared)
    return result


if __name__ == "__main__":
    main()

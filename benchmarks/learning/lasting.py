"""Check that the resident memory of a learning process stays flat over a million steps of an environment.

    python benchmarks/learning/lasting.py

One environment takes random actions, with everything that keeps state between episodes: tasks of two actions of
`tabletop` that are sampled and validated lazily, an adaptive curriculum, a backwards curriculum over subgoals, and a
reward that is annealed with success. It takes about a quarter of an hour of processor time, and exits with code 1 if
the memory has grown by 20 MB or more after the first measurement.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import click
from rich.console import Console

from prag_asp import TaskSpace, load_domain
from prag_asp.rl import AdaptiveCurriculum, ReverseCurriculum, TaskEnv

sys.path.insert(0, str(Path(__file__).parents[1]))

from memory import LIMIT, megabytes


@click.command()
@click.option("--steps", type=click.IntRange(min=1), default=1_000_000, show_default=True)
@click.option("--every", type=click.IntRange(min=1), default=100_000, show_default=True, help="Steps of a measurement.")
@click.option("--seed", type=int, default=0, show_default=True, help="The seed of tasks and actions.")
def main(steps: int, every: int, seed: int) -> None:
    """Act, print the memory over time, and check its growth."""
    space = TaskSpace(load_domain("tabletop"), length=2)
    env = TaskEnv(space, curriculum=(AdaptiveCurriculum(), ReverseCurriculum()), reward="faded")
    env.action_space.seed(seed)
    env.reset(seed=seed)
    console, sizes, episodes = Console(), list[float](), 1
    for step in range(1, steps + 1):
        *_, done, late, _ = env.step(env.action_space.sample())
        if done or late:
            env.reset()
            episodes += 1
        if step % every == 0 or step == steps:
            sizes.append(megabytes())
            line = f"{step:,} steps, {episodes:,} episodes, {time.process_time():.0f} s: {sizes[-1]:.1f} MB"
            console.print(line, highlight=False)
    env.close()
    grown = sizes[-1] - sizes[0]
    line = f"growth since step {min(every, steps):,}: {grown:.1f} MB; limit: {LIMIT:.0f} MB"
    console.print(line, highlight=False)
    sys.exit(int(grown >= LIMIT))


if __name__ == "__main__":
    main()

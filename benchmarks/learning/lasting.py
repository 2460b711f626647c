"""Whether the memory of a process that learns stays flat: its resident set over a million steps of an environment.

    python benchmarks/learning/lasting.py

One environment takes random actions, with all that it can be asked to keep between its episodes: tasks of two actions
of `tabletop`, drawn from the space and validated as they come, an adaptive curriculum, subgoals walked back from the
last one, and a reward that fades with success. It takes about a quarter of an hour of processor time, and ends with
code 1 where the process has grown by 20 MB or more after the first measurement.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import click
from rich.console import Console

from prag_asp import TaskSpace, load_domain
from prag_asp.rl import Adaptive, Backwards, TaskEnv

sys.path.insert(0, str(Path(__file__).parents[1]))

from memory import LIMIT, megabytes


@click.command()
@click.option("--steps", type=click.IntRange(min=1), default=1_000_000, show_default=True)
@click.option("--every", type=click.IntRange(min=1), default=100_000, show_default=True, help="Steps of a measurement.")
@click.option("--seed", type=int, default=0, show_default=True, help="The seed of tasks and actions.")
def main(steps: int, every: int, seed: int) -> None:
    """Act, print the memory as it goes, and judge its growth."""
    space = TaskSpace(load_domain("tabletop"), length=2)
    env = TaskEnv(space, curriculum=(Adaptive(), Backwards()), reward="faded")
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
            told = f"{step:,} steps, {episodes:,} episodes, {time.process_time():.0f} s: {sizes[-1]:.1f} MB"
            console.print(told, highlight=False)
    env.close()
    grown = sizes[-1] - sizes[0]
    told = f"grown by {grown:.1f} MB since step {min(every, steps):,}; less than {LIMIT:.0f} MB are allowed"
    console.print(told, highlight=False)
    sys.exit(int(grown >= LIMIT))


if __name__ == "__main__":
    main()

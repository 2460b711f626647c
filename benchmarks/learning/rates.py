"""Compare control steps and resets per second with other environments: python benchmarks/learning/rates.py --blocks 12.

Install the others with: pip install panda-gym gymnasium-robotics 'mujoco<3.12' (with later versions Fetch fails to
start). One that is missing or fails is shown as '-'. The environments alternate, each with random actions for a block
of steps, so that other load affects all alike; the table shows the median and the fastest block. One more block of each
PyBullet environment measures the milliseconds of a step within `stepSimulation`, and of the rest. Seconds are processor
time. Exits with code 1 if our median rate is below 1.3 times that of panda-gym's PickAndPlace, or if the parallel
speed-up measured by beside.py, which runs at the end, is too low.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from contextlib import redirect_stdout, suppress
from io import StringIO
from statistics import median
from typing import Any

import beside
import click
import gymnasium
import pybullet
from rich.console import Console
from rich.table import Table

from prag_asp.rl import TaskEnv

OURS, PICK = "prag_asp tabletop, 20 Hz", "panda-gym PickAndPlace, 25 Hz"
LEAST_TIMES = 1.3


def panda(name: str) -> Callable[[], gymnasium.Env[Any, Any]]:
    """Return a factory of an environment of panda-gym, which prints a message on import."""

    def make() -> gymnasium.Env[Any, Any]:
        with redirect_stdout(StringIO()):
            import panda_gym  # noqa: F401, PLC0415

            return gymnasium.make(name)

    return make


def fetch() -> gymnasium.Env[Any, Any]:
    """Return the environment of a Fetch robot in MuJoCo."""
    import gymnasium_robotics  # noqa: PLC0415

    gymnasium.register_envs(gymnasium_robotics)
    return gymnasium.make("FetchPickAndPlace-v4")


ENVIRONMENTS: dict[str, Callable[[], gymnasium.Env[Any, Any]]] = {
    OURS: beside.ours,
    PICK: panda("PandaPickAndPlace-v3"),
    "panda-gym Stack, 25 Hz": panda("PandaStack-v3"),
    "Fetch PickAndPlace, 25 Hz": fetch,
}


def block(env: gymnasium.Env[Any, Any], steps: int) -> tuple[float, float]:
    """Return the processor seconds of a step and of a reset."""
    stepping = resetting = 0.0
    resets = 1
    env.reset()
    for _ in range(steps):
        action = env.action_space.sample()
        begun = time.process_time()
        *_, terminated, truncated, _ = env.step(action)
        stepping += time.process_time() - begun
        if terminated or truncated:
            begun = time.process_time()
            env.reset()
            resetting, resets = resetting + time.process_time() - begun, resets + 1
    return stepping / steps, resetting / resets


def simulation(env: gymnasium.Env[Any, Any], steps: int) -> tuple[float, float] | None:
    """Return the processor seconds of a step within and outside `stepSimulation`, or None without PyBullet."""
    client = getattr(getattr(env.unwrapped, "sim", None), "physics_client", None)
    if not isinstance(env.unwrapped, TaskEnv) and client is None:
        return None
    simulate, spent = pybullet.stepSimulation if client is None else client.stepSimulation, 0.0

    def timed(**options: Any) -> None:
        nonlocal spent
        begun = time.process_time()
        simulate(**options)
        spent += time.process_time() - begun

    holder = pybullet if client is None else client
    holder.stepSimulation = timed
    stepping, _ = block(env, steps)
    if client is None:
        pybullet.stepSimulation = simulate
    else:
        del client.stepSimulation
    return spent / steps, stepping - spent / steps


@click.command()
@click.option("--blocks", type=click.IntRange(min=1), default=12, show_default=True)
@click.option("--steps", type=click.IntRange(min=100), default=500, show_default=True, help="Steps of a block.")
@click.option(
    "--rounds", type=click.IntRange(min=1), default=5, show_default=True, help="Rounds of one and two processes."
)
@click.option("--seconds", type=click.FloatRange(min=0.1), default=4.0, show_default=True, help="Duration of each.")
def main(blocks: int, steps: int, rounds: int, seconds: float) -> None:
    """Measure all environments in turn."""
    envs, missing = {}, []
    for name, make in ENVIRONMENTS.items():
        try:
            envs[name] = make()
        except (ImportError, AssertionError, gymnasium.error.Error) as error:  # MuJoCo is too new
            missing.append(f"{name}: {error!r}")
    taken: dict[str, list[tuple[float, float]]] = {name: [] for name in envs}
    for env in envs.values():
        env.reset(seed=0)
        env.action_space.seed(0)
        block(env, steps)
    for _ in range(blocks):
        for name, env in envs.items():
            taken[name].append(block(env, steps))
    rates = {name: 1 / median(step for step, _ in each) for name, each in taken.items()}
    heads = ("environment", "steps/s", "fastest block", "times ours", "reset, ms", "simulation, ms", "rest, ms")
    table = Table(*heads, title=f"{blocks} x {steps} steps")
    for name in ENVIRONMENTS:
        if name not in rates:
            table.add_row(name, *["-"] * 6)
            continue
        spent = simulation(envs[name], steps)
        parts = ("-", "-") if spent is None else (f"{1e3 * each:.2f}" for each in spent)
        fastest, reset = 1 / min(step for step, _ in taken[name]), 1e3 * median(reset for _, reset in taken[name])
        table.add_row(
            name, f"{rates[name]:.0f}", f"{fastest:.0f}", f"{rates[name] / rates[OURS]:.2f}", f"{reset:.2f}", *parts
        )
    for env in envs.values():
        with suppress(Exception):
            env.close()
    console = Console()
    console.print(table)
    for line in missing:
        console.print(line, markup=False)
    side_by_side = beside.measured(rounds, seconds)
    enough, message = beside.verdict(
        *(beside.ratio(side_by_side[kind]) for kind in (beside.ENVIRONMENT, beside.PHYSICS))
    )
    console.print(beside.table(side_by_side))
    console.print(message, highlight=False)
    slow = PICK in rates and rates[OURS] < LEAST_TIMES * rates[PICK]
    sys.exit(int(slow or not enough))


if __name__ == "__main__":
    main()

"""Control steps and resets a second beside other environments: python benchmarks/learning/rates.py --blocks 12.

The peers are installed by: pip install panda-gym gymnasium-robotics 'mujoco<3.12', for with later ones Fetch fails to
begin. One that is missing, or fails so, is shown as '-'. Each environment takes random actions for a block of steps,
the environments by turns, so that a busy machine is as busy for all; of each, the middle block and the fastest count.
Seconds are of processor time. It ends with code 1 where the middle of our blocks is below 1.3 times that of panda-gym's
PickAndPlace, or two processes together do less than 1.8 times what one does.
"""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import redirect_stdout, suppress
from io import StringIO
from statistics import median
from typing import Any

import click
import gymnasium
from rich.console import Console
from rich.table import Table

from prag_asp import TaskSpace, load_domain

OURS, PICK = "prag_asp tabletop, 20 Hz", "panda-gym PickAndPlace, 25 Hz"
LEAST_TIMES, LEAST_TOGETHER = 1.3, 1.8


def ours() -> gymnasium.Env[Any, Any]:
    """Return our environment: seven objects and a tray on a table, tasks of two actions."""
    space = TaskSpace(load_domain("tabletop"), length=2)
    return gymnasium.make("prag_asp.rl:prag_asp/Task-v0", space=space)


def panda(name: str) -> Callable[[], gymnasium.Env[Any, Any]]:
    """Return what makes an environment of panda-gym, which says something as it is loaded."""

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
    OURS: ours,
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


def together(processes: int, steps: int) -> float:
    """Return the steps a second of several processes that run side by side; after all have begun."""
    code = f"import sys; sys.path.insert(0, {sys.path[0]!r}); import rates; rates.alone({steps})"
    running = [
        subprocess.Popen([sys.executable, "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        for _ in range(processes)
    ]
    for each in running:
        assert each.stdout is not None
        each.stdout.readline()
    begun = time.perf_counter()
    for each in running:
        assert each.stdin is not None
        each.stdin.write("go\n")
        each.stdin.flush()
    for each in running:
        each.communicate()
    return processes * steps / (time.perf_counter() - begun)


def alone(steps: int) -> None:
    """Say when all is there, wait for a word, and take steps."""
    env = ours()
    block(env, 200)
    print("there", flush=True)  # noqa: T201
    sys.stdin.readline()
    block(env, steps)


@click.command()
@click.option("--blocks", type=click.IntRange(min=1), default=12, show_default=True)
@click.option("--steps", type=click.IntRange(min=100), default=500, show_default=True, help="Steps of a block.")
def main(blocks: int, steps: int) -> None:
    """Measure all environments by turns."""
    found, missing = {}, []
    for name, make in ENVIRONMENTS.items():
        try:
            found[name] = make()
        except (ImportError, AssertionError, gymnasium.error.Error) as error:  # MuJoCo is too new
            missing.append(f"{name}: {error!r}")
    taken: dict[str, list[tuple[float, float]]] = {name: [] for name in found}
    for env in found.values():
        env.reset(seed=0)
        env.action_space.seed(0)
        block(env, steps)
    for _ in range(blocks):
        for name, env in found.items():
            taken[name].append(block(env, steps))
    rates = {name: 1 / median(step for step, _ in each) for name, each in taken.items()}
    heads = ("environment", "steps/s", "fastest block", "times ours", "reset, ms")
    table = Table(*heads, title=f"{blocks} x {steps} steps")
    for name in ENVIRONMENTS:
        if name not in rates:
            table.add_row(name, "-", "-", "-", "-")
            continue
        fastest, reset = 1 / min(step for step, _ in taken[name]), 1e3 * median(reset for _, reset in taken[name])
        table.add_row(name, f"{rates[name]:.0f}", f"{fastest:.0f}", f"{rates[name] / rates[OURS]:.2f}", f"{reset:.2f}")
    for env in found.values():
        with suppress(Exception):
            env.close()
    one, two = together(1, 4 * steps), together(2, 4 * steps)
    console = Console()
    console.print(table)
    for line in missing:
        console.print(line, markup=False)
    console.print(f"two processes do {two / one:.2f} times what one does ({one:.0f} and {two:.0f} steps/s)")
    slow = PICK in rates and rates[OURS] < LEAST_TIMES * rates[PICK]
    sys.exit(int(slow or two < LEAST_TOGETHER * one))


if __name__ == "__main__":
    main()

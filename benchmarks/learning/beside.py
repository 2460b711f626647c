"""The speed-up of two processes over one: of environments, and of other programs as a reference for this machine.

    python benchmarks/learning/beside.py --rounds 5

Two processes slow each other down if they share clock rate, caches or other load. So the same is measured for a loop
in Python and for a PyBullet simulation of a robot and seven cubes, both without our code: they bound the speed-up of an
environment. `in step` are two environments of one `AsyncVectorEnv` compared with one: there, Gymnasium waits for the
slower one at each step and copies the observations of both.

The kinds alternate. Each process works for a fixed time after a common start signal and counts its steps. The table
shows the medians of the rounds and the range of the ratio. Processor time measures the slow-down of the work itself;
wall-clock time also includes other load. Exits with code 1 if the speed-up of environments is below 1.8 or, if that of
PyBullet alone is below 2, below nine tenths of that.
"""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from statistics import mean, median
from typing import Any, NamedTuple

import click
import gymnasium
from rich.console import Console
from rich.progress import track
from rich.table import Table

from prag_asp import TaskSpace, load_domain

LEAST_TOGETHER = 1.8
"""The required speed-up of two processes."""

SEED = 0
"""The seed of tasks and actions, so that all processes do the same work."""


def ours() -> gymnasium.Env[Any, Any]:
    """Return our environment: seven objects and a tray on a table, tasks of two actions."""
    space = TaskSpace(load_domain("tabletop"), length=2)
    return gymnasium.make("prag_asp.rl:prag_asp/Task-v0", space=space)


def acting(env: gymnasium.Env[Any, Any]) -> Callable[[], int]:
    """Return a function that takes a step, after a reset if the episode is over."""
    env.action_space.seed(SEED)
    env.reset(seed=SEED)
    over = False

    def act() -> int:
        nonlocal over
        if over:
            env.reset()
        *_, terminated, truncated, _ = env.step(env.action_space.sample())
        over = terminated or truncated
        return 1

    return act


def in_step(count: int) -> Callable[[], int]:
    """Return a function that takes a step of `count` environments, each in a separate process."""
    envs = gymnasium.vector.AsyncVectorEnv([ours] * count, context="spawn")
    envs.action_space.seed(SEED)
    envs.reset(seed=[SEED] * count)

    def act() -> int:
        envs.step(envs.action_space.sample())
        return count

    return act


def falling() -> Callable[[], int]:
    """Return a function that takes as many simulation steps as one of our control steps has."""
    import pybullet  # noqa: PLC0415
    import pybullet_data  # noqa: PLC0415

    client = pybullet.connect(pybullet.DIRECT)
    pybullet.setAdditionalSearchPath(pybullet_data.getDataPath(), physicsClientId=client)
    pybullet.setGravity(0.0, 0.0, -9.81, physicsClientId=client)
    pybullet.loadURDF("plane.urdf", physicsClientId=client)
    pybullet.loadURDF("franka_panda/panda.urdf", useFixedBase=True, physicsClientId=client)
    for number in range(7):
        pybullet.loadURDF("cube_small.urdf", [0.4, 0.1 * number - 0.3, 0.03], physicsClientId=client)

    def fall() -> int:
        for _ in range(6):
            pybullet.stepSimulation(physicsClientId=client)
        return 1

    return fall


def adding() -> int:
    """Compute for about the duration of a step."""
    return int(sum(number * number for number in range(10_000)) > 0)


ENVIRONMENT, PHYSICS = "environment, tabletop", "PyBullet alone"
ALONE: dict[str, Callable[[], Callable[[], int]]] = {
    ENVIRONMENT: lambda: acting(ours()),
    PHYSICS: falling,
    "Python alone": lambda: adding,
}
IN_STEP = "environments in step"
KINDS = (*ALONE, IN_STEP)


class Done(NamedTuple):
    """The steps per second of wall-clock time, and per second of processor time."""

    rate: float
    efficiency: float


def work(kind: str, count: int, seconds: float) -> None:
    """Print a line when ready, wait for the start signal, work, and print the rates by both kinds of time."""
    act = in_step(count) if kind == IN_STEP else ALONE[kind]()
    begun = time.perf_counter()
    while time.perf_counter() < begun + 0.2:
        act()
    print("there", flush=True)  # noqa: T201
    sys.stdin.readline()
    begun, computed = time.perf_counter(), time.process_time()
    done = act()
    while time.perf_counter() < begun + seconds:
        done += act()
    taken = time.perf_counter() - begun
    print(done / taken, done / (time.process_time() - computed), flush=True)  # noqa: T201


def together(kind: str, count: int, seconds: float) -> Done:
    """Return the results of `count` processes of a kind that run in parallel."""
    processes = 1 if kind == IN_STEP else count
    here = str(Path(__file__).resolve().parent)
    code = f"import sys; sys.path.insert(0, {here!r}); import beside; beside.work({kind!r}, {count}, {seconds})"
    environment = {**os.environ, "OMP_NUM_THREADS": "1"}
    start = partial(subprocess.Popen, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=environment)
    running = [start([sys.executable, "-c", code]) for _ in range(processes)]
    for each in running:
        assert each.stdout is not None
        while (line := each.stdout.readline()) != "there\n":  # a package may print on import
            if not line:
                sys.exit(
                    f"the process for {kind} ended before it was ready, with code {each.wait()}; see its error above"
                )
    for each in running:
        assert each.stdin is not None
        each.stdin.write("go\n")
        each.stdin.flush()
    outputs = [each.communicate()[0].split()[-2:] for each in running]
    return Done(sum(float(rate) for rate, _ in outputs), mean(float(each) for _, each in outputs))


def measured(rounds: int, seconds: float) -> dict[str, list[tuple[Done, Done]]]:
    """Return the results of one and of two processes of each kind, in each round."""
    results: dict[str, list[tuple[Done, Done]]] = {kind: [] for kind in KINDS}
    for _ in track(range(rounds), "one and two processes", console=Console(stderr=True), transient=True):
        for kind, done in results.items():
            done.append((together(kind, 1, seconds), together(kind, 2, seconds)))
    return results


def ratio(done: list[tuple[Done, Done]]) -> float:
    """Return the median speed-up of two processes by wall-clock time."""
    return median(two.rate / one.rate for one, two in done)


def table(results: dict[str, list[tuple[Done, Done]]]) -> Table:
    """Return the table of all kinds."""
    heads = ("kind", "one, /s", "two, /s", "speed-up", "min, max", "by processor time")
    result = Table(*heads)
    for kind, done in results.items():
        times = [two.rate / one.rate for one, two in done]
        one, two = (median(each.rate for each in side) for side in zip(*done, strict=True))
        # The processor time of `AsyncVectorEnv` workers is not measured by the process that waits for them.
        own = "-" if kind == IN_STEP else f"{2 * median(two.efficiency / one.efficiency for one, two in done):.2f}"
        row = (f"{one:,.0f}", f"{two:,.0f}", f"{ratio(done):.2f}", f"{min(times):.2f}, {max(times):.2f}", own)
        result.add_row(kind, *row)
    return result


def verdict(times: float, most: float) -> tuple[bool, str]:
    """Return whether the speed-up `times` of environments suffices, and a message; `most` is that of PyBullet alone.

    The required speed-up is nine tenths of 2, or of `most` if that is less.
    """
    message = f"speed-up of two processes: {times:.2f}; of PyBullet alone: {most:.2f}"
    if most < LEAST_TOGETHER:
        message += f"; on this machine, in its present state, no speed-up of {LEAST_TOGETHER} is possible"
    return times >= LEAST_TOGETHER / 2 * min(2.0, most), message


@click.command()
@click.option("--rounds", type=click.IntRange(min=1), default=5, show_default=True)
@click.option(
    "--seconds", type=click.FloatRange(min=0.1), default=4.0, show_default=True, help="Duration of each measurement."
)
def main(rounds: int, seconds: float) -> None:
    """Measure all kinds in turn."""
    results = measured(rounds, seconds)
    enough, message = verdict(ratio(results[ENVIRONMENT]), ratio(results[PHYSICS]))
    console = Console()
    console.print(table(results))
    console.print(message, highlight=False)
    sys.exit(int(not enough))


if __name__ == "__main__":
    main()

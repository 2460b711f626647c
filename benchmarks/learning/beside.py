"""How much more two processes do than one: environments, and beside them what this machine lets any two processes do.

    python benchmarks/learning/beside.py --rounds 5

Two processes of anything slow each other down where they share a clock, a cache or a machine with others. So the same
is measured of Python that adds, and of PyBullet that lets a robot and seven cubes be, neither with a word of ours: no
environment can do better than these. `in step` are two environments of one `AsyncVectorEnv`, beside one of it: there, a
process of Gymnasium waits for the slower one at each step, and has the observations of both copied.

All take turns. A process works for so many seconds, from a word on that both are told, and counts what it has done; so
nothing waits for another one's end. Printed are the medians of the rounds, and the lowest and the highest ratio.
Seconds of processor time tell what the work itself costs more beside another one, seconds on the clock also who else
was busy. It ends with code 1 where two environments do less than 1.8 times what one does, and less than nine tenths of
that where the machine lets PyBullet itself do less than twice as much: then it says so.
"""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Callable
from functools import partial
from statistics import mean, median
from typing import Any, NamedTuple

import click
import gymnasium
from rich.console import Console
from rich.progress import track
from rich.table import Table

from prag_asp import TaskSpace, load_domain

LEAST_TOGETHER = 1.8
"""How many times as much as one two processes shall do."""

SEED = 0
"""The seed of tasks and actions: all processes do the same work, so none has more of it by chance."""


def ours() -> gymnasium.Env[Any, Any]:
    """Return our environment: seven objects and a tray on a table, tasks of two actions."""
    space = TaskSpace(load_domain("tabletop"), length=2)
    return gymnasium.make("prag_asp.rl:prag_asp/Task-v0", space=space)


def acting(env: gymnasium.Env[Any, Any]) -> Callable[[], int]:
    """Return what takes a step, or begins an episode where one is over."""
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
    """Return what takes a step of so many environments, each in a process of its own."""
    envs = gymnasium.vector.AsyncVectorEnv([ours] * count, context="spawn")
    envs.action_space.seed(SEED)
    envs.reset(seed=[SEED] * count)

    def act() -> int:
        envs.step(envs.action_space.sample())
        return count

    return act


def falling() -> Callable[[], int]:
    """Return what lets PyBullet take as many steps as a control step of ours has."""
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
    """Add for about as long as a step takes."""
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
    """How much was done in a second on the clock, and in one of processor time."""

    rate: float
    efficiency: float


def work(kind: str, count: int, seconds: float) -> None:
    """Say when all is there, wait for a word, work, and say how much was done and in how much processor time."""
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
    """Return what so many of a kind do side by side, from when all are there."""
    processes = 1 if kind == IN_STEP else count
    code = f"import sys; sys.path.insert(0, {sys.path[0]!r}); import beside; beside.work({kind!r}, {count}, {seconds})"
    environment = {**os.environ, "OMP_NUM_THREADS": "1"}
    start = partial(subprocess.Popen, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=environment)
    running = [start([sys.executable, "-c", code]) for _ in range(processes)]
    for each in running:
        assert each.stdout is not None
        each.stdout.readline()
    for each in running:
        assert each.stdin is not None
        each.stdin.write("go\n")
        each.stdin.flush()
    told = [each.communicate()[0].split() for each in running]
    return Done(sum(float(rate) for rate, _ in told), mean(float(each) for _, each in told))


def measured(rounds: int, seconds: float) -> dict[str, list[tuple[Done, Done]]]:
    """Return what one and two of each kind do, in each round."""
    found: dict[str, list[tuple[Done, Done]]] = {kind: [] for kind in KINDS}
    for _ in track(range(rounds), "one and two processes", console=Console(stderr=True), transient=True):
        for kind, done in found.items():
            done.append((together(kind, 1, seconds), together(kind, 2, seconds)))
    return found


def ratio(done: list[tuple[Done, Done]]) -> float:
    """Return how many times as much as one two do, on the clock, in the middle of the rounds."""
    return median(two.rate / one.rate for one, two in done)


def table(found: dict[str, list[tuple[Done, Done]]]) -> Table:
    """Return the table of all kinds."""
    heads = ("two beside one", "one, /s", "two, /s", "times one", "lowest, highest", "times, by processor time")
    told = Table(*heads)
    for kind, done in found.items():
        times = [two.rate / one.rate for one, two in done]
        one, two = (median(each.rate for each in side) for side in zip(*done, strict=True))
        # Those in step compute in processes of their own, whose time the one that waits for them does not see.
        own = "-" if kind == IN_STEP else f"{2 * median(two.efficiency / one.efficiency for one, two in done):.2f}"
        row = (f"{one:,.0f}", f"{two:,.0f}", f"{ratio(done):.2f}", f"{min(times):.2f}, {max(times):.2f}", own)
        told.add_row(kind, *row)
    return told


def verdict(times: float, most: float) -> tuple[bool, str]:
    """Return whether two environments do enough, and say it beside what the machine lets PyBullet do at `most`.

    Enough are nine tenths of twice as much, or of what PyBullet does where that is less.
    """
    told = f"two processes do {times:.2f} times what one does, PyBullet alone {most:.2f} times"
    if most < LEAST_TOGETHER:
        told += f"; as this machine is now, no two processes do {LEAST_TOGETHER} times what one does"
    return times >= LEAST_TOGETHER / 2 * min(2.0, most), told


@click.command()
@click.option("--rounds", type=click.IntRange(min=1), default=5, show_default=True)
@click.option("--seconds", type=click.FloatRange(min=0.1), default=4.0, show_default=True, help="How long each works.")
def main(rounds: int, seconds: float) -> None:
    """Measure all kinds by turns."""
    found = measured(rounds, seconds)
    enough, told = verdict(ratio(found[ENVIRONMENT]), ratio(found[PHYSICS]))
    console = Console()
    console.print(table(found))
    console.print(told, highlight=False)
    sys.exit(int(not enough))


if __name__ == "__main__":
    main()

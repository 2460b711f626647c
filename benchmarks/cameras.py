"""The cost of a camera image with depth and segmentation, compared with rendering the full robot meshes.

    python benchmarks/cameras.py tabletop --size 128 --blocks 12

Both run in alternating blocks; the table shows the minimum and the median processor time on one core in milliseconds.
"""

from __future__ import annotations

import argparse
import statistics
import time
from collections.abc import Callable
from contextlib import ExitStack

import numpy as np
from rich.console import Console
from rich.table import Table

from prag_asp import TaskSpace, load_domain, load_scene
from prag_asp.physics import Budget, Demonstration, Staging, Tier, open_validator, render_cameras
from prag_asp.physics.bullet import pybullet
from prag_asp.physics.filming.camera_rendering import moment_of
from prag_asp.physics.filming.studio import matrices, open_studio
from prag_asp.physics.world.simulator import open_simulator
from prag_asp.scene.cameras import Camera
from prag_asp.scene.scene import Scene

PICTURES = 8
"""The number of images in a block, evenly spaced over the episode."""


def main() -> None:
    """Demonstrate a task, render it in several ways, and print a table."""
    options = _options()
    scene = load_scene(load_domain(options.domain))
    shown = _demonstrated(options.domain, scene, options.seed)
    cameras = Staging(tuple(scene.cameras), (options.size, options.size)).cameras_of(scene)
    moments = [moment_of(shown, int(k)) for k in np.linspace(0, len(shown.times) - 1, PICTURES)]
    ways: dict[tuple[str, str], Callable[[], None]] = {}
    with ExitStack() as resources:
        studio = resources.enter_context(open_studio(shown.sized_scene(scene), shown.objects))
        whole = resources.enter_context(open_simulator(shown.sized_scene(scene), visual=True))

        def simplified(camera: Camera) -> None:
            for moment in moments:
                studio.show(moment)
                studio.take(camera)

        def meshes(camera: Camera) -> None:
            for moment in moments:
                whole.show(moment)
                studio.show(moment)  # gives the pose of the wrist camera
                view = matrices(camera, studio.pose(camera))
                tiny = {"renderer": pybullet.ER_TINY_RENDERER, "shadow": 0, "physicsClientId": whole.client}
                pybullet.getCameraImage(*camera.size, *view, **tiny)

        for name, camera in cameras.items():
            ways[name, "simplified meshes, ray-cast table"] = lambda camera=camera: simplified(camera)
            ways[name, "full meshes"] = lambda camera=camera: meshes(camera)
        blocks: dict[tuple[str, str], list[float]] = {way: [] for way in ways}
        for _ in range(options.blocks):
            for way, run in ways.items():
                blocks[way].append(_timed(run, PICTURES))
    staging = Staging(tuple(cameras), (options.size, options.size), rate=20)
    pictures = len(shown.times) * len(cameras)
    filmed = [_timed(lambda: render_cameras(shown, scene, staging), pictures) for _ in range(3)]
    table = Table("camera", "how", "min, ms", "median, ms", "full : ours")
    for (name, how), times in blocks.items():
        ratio = statistics.median(blocks[name, "full meshes"]) / statistics.median(times)
        table.add_row(name, how, f"{min(times):.2f}", f"{statistics.median(times):.2f}", f"{ratio:.1f}")
    table.add_row(
        "all", "film of all cameras, compressed", f"{min(filmed):.2f}", f"{statistics.median(filmed):.2f}", ""
    )
    Console().print(table)


def _timed(run: Callable[[], object], count: int) -> float:
    """Return the milliseconds of processor time for each of `count` images."""
    begun = time.process_time()
    run()
    return (time.process_time() - begun) / count * 1000


def _demonstrated(name: str, scene: Scene, seed: int) -> Demonstration:
    """Return the demonstration of the first task that has one."""
    with open_validator(scene) as validator:
        for index, task in enumerate(TaskSpace(load_domain(name), 3).stream(seed=seed)):
            verdict = validator.validate(task, seed=seed, index=index, budget=Budget(tier=Tier.DEMONSTRATION))
            if verdict.demonstration is not None:
                return verdict.demonstration
    raise AssertionError("a stream of tasks never ends")


def _options() -> argparse.Namespace:
    """Return the options of the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("domain", nargs="?", default="tabletop")
    parser.add_argument("--size", type=int, default=128)
    parser.add_argument("--blocks", type=int, default=12)
    parser.add_argument("--seed", type=int, default=7)
    return parser.parse_args()


if __name__ == "__main__":
    main()

"""Options of commands that validate tasks by physics simulation: effort, number of processes, and cameras."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import click

from prag_asp.cli import shell_completion
from prag_asp.cli.options import grouped, whole
from prag_asp.errors import QueryError

if TYPE_CHECKING:
    from prag_asp.physics import Budget, Staging
    from prag_asp.scene.scene import Scene

BUDGET, TIER = "10x10", "kinematics"

LONGEST_SIZE = 20
"""The maximum number of characters of WxH; larger numbers are not image sizes, and are slow to parse."""

OPTIONS = (
    click.option(
        "--workers", type=whole(1, 4096), default=1, show_default=True, help="Number of processes for physics."
    ),
    click.option(
        "--budget", metavar="RxS", default=BUDGET, show_default=True,
        help="Search effort: initial states to try for a task x attempts at each action.",
    ),
    click.option(
        "--tier", type=click.Choice(["kinematics", "settling", "transit", "demonstration"]), default=TIER,
        show_default=True,
        help="Most expensive check to run: kinematics (placements and reach) < settling (objects stay in place in "
        "simulation) < transit (collision-free paths of the arm) < demonstration (the robot executes the task).",
    ),
    click.option(
        "--demonstrate", metavar="DIR", shell_complete=shell_completion.files,
        help="Let the robot execute each task in simulation, and write the episodes (.npz) into DIR.",
    ),
)  # fmt: skip


@dataclass(frozen=True)
class PhysicsOptions:
    """The options for validation by physics simulation."""

    workers: int
    budget: str
    tier: str
    demonstrate: str | None = None

    def refuse_without_physics(self, others: Mapping[str, bool]) -> None:
        """Refuse physics options if physics is off; `others` maps other options to whether they are given.

        Raises:
            QueryError: a physics option is given although physics is off.
        """
        options = {
            "--demonstrate": self.demonstrate is not None,
            "--tier": self.tier != TIER,
            "--budget": self.budget != BUDGET,
            **others,
        }
        for option, is_given in options.items():
            if is_given:
                raise QueryError(f"{option} needs physics; leave it out, or use a domain with a [scene]")

    def parse_budget(self) -> Budget:
        """Return the budget; with --demonstrate, the most expensive tier of the budget is demonstration.

        Raises:
            QueryError: --budget is not of the form RxS with positive numbers.
        """
        from prag_asp.physics import TIERS, Budget

        tier = "demonstration" if self.demonstrate is not None else self.tier
        try:
            return Budget.parse(self.budget, TIERS[TIERS.index(tier)])
        except QueryError as error:
            raise QueryError(f"--{error}") from None

    def arguments(self) -> dict[str, Any]:
        """Return the options as arguments for functions that validate tasks."""
        return {"workers": self.workers, "budget": self.parse_budget(), "demonstrate": self.demonstrate}


physics_options = grouped("validation", PhysicsOptions, OPTIONS)
"""The decorator that gives a command the options for physics, as a single value `validation`."""

physics_options_without_folder = grouped("validation", PhysicsOptions, OPTIONS[:-1])
"""The decorator that gives a command the same options, except --demonstrate DIR."""

ray = click.option(
    "--on", type=click.Choice(["ray"]),
    help="Validate tasks on the nodes of a Ray cluster: the cluster at RAY_ADDRESS, or this machine alone.",
)  # fmt: skip
max_draws = click.option(
    "--max-draws",
    type=whole(1),
    metavar="K",
    help="Stop a part after K samples, feasible or not.  [default: 1000 per task]",
)


@dataclass(frozen=True)
class CameraOptions:
    """The options for demonstrations: the cameras that record them, and the properties that are randomized."""

    cameras: str | None = None
    size: str | None = None
    rate: int | None = None
    vary: str | None = None

    @property
    def any(self) -> bool:
        """Whether anything is to be recorded or randomized."""
        return self.cameras is not None or self.vary is not None

    def check(self, demonstrate: str | None) -> None:
        """Check that the options are consistent, before anything is loaded.

        Raises:
            QueryError: an option is given without another one that it requires.
        """
        for option, value in (("--size", self.size), ("--rate", self.rate)):
            if value is not None and self.cameras is None:
                raise QueryError(f"{option} {value} is for --cameras; name some, such as --cameras front")
        for option, value in (("--cameras", self.cameras), ("--vary", self.vary)):
            if value is not None and demonstrate is None:
                raise QueryError(f"{option} {value} is for demonstrations; add --demonstrate")

    def staging(self, *scenes: Scene) -> Staging | None:
        """Return the staging of demonstrations in the given scenes, or None if nothing is recorded or randomized.

        Raises:
            QueryError: there is no such camera, size, rate, or property to randomize.
        """
        from prag_asp.physics import Staging

        if not self.any:
            return None
        cameras, vary = _parse_names("cameras", self.cameras), _parse_names("vary", self.vary)
        rate = {} if self.rate is None else {"rate": self.rate}
        staging = Staging(cameras, None if self.size is None else parse_pixels(self.size), vary=vary, **rate)
        for scene in scenes:
            staging.cameras_of(scene)
        return staging


camera_options = grouped(
    "filming", CameraOptions,
    (
        click.option(
            "--cameras", metavar="A,B,...", shell_complete=shell_completion.cameras,
            help="Cameras of the scene that record each demonstration, in colour, depth and segmentation.",
        ),
        click.option(
            "--size", metavar="WxH", help="Size of the camera images in pixels.  [default: the size of each camera]"
        ),
        click.option("--rate", type=int, metavar="N", help="Camera images per second.  [default: 10]"),
        click.option(
            "--vary", metavar="A,B,...", shell_complete=shell_completion.kinds_that_vary,
            help="What to randomize in each demonstration, within the scene's ranges: friction, mass, light, camera, "
            "colour.",
        ),
    ),
)  # fmt: skip
"""The decorator that gives a command the options for cameras, as a single value `filming`."""


def _parse_names(option: str, text: str | None) -> tuple[str, ...]:
    """Return the names listed in an option's value.

    Raises:
        QueryError: the list is empty, or a name is empty.
    """
    names = () if text is None else tuple(name.strip() for name in text.split(","))
    if not all(names):
        raise QueryError(f"--{option} {text}: write names with commas between them")
    return names


def parse_pixels(text: str) -> tuple[int, int]:
    """Return the width and height in an option's value.

    Raises:
        QueryError: the text does not have the form WxH.
    """
    width, _, height = text.partition("x")
    if not (width.isdecimal() and height.isdecimal() and len(text) <= LONGEST_SIZE):
        raise QueryError(f"--size {text}: write WIDTHxHEIGHT in pixels, such as 480x420")
    return int(width), int(height)

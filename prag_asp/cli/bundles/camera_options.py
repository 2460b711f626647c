"""Options of cameras, and of what varies from recording to recording."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import click

from prag_asp.cli import shell_completion
from prag_asp.cli.arguments import pixels
from prag_asp.cli.options import Function, bundled
from prag_asp.errors import QueryError

if TYPE_CHECKING:
    from prag_asp.physics import Staging
    from prag_asp.scene.scene import Scene

FILMS = (
    click.option(
        "--cameras", metavar="A,B,...", shell_complete=shell_completion.cameras,
        help="Let these cameras of the scene film each demonstration: colours, depth and which entity is where.",
    ),
    click.option("--size", metavar="WxH", help="Pixels of a picture of --cameras.  [default: as each camera says]"),
    click.option("--rate", type=int, metavar="N", help="Pictures of --cameras a second.  [default: 10]"),
    click.option(
        "--vary", metavar="A,B,...", shell_complete=shell_completion.kinds_that_vary,
        help="Draw for each demonstration: friction, mass, light, camera, colour; the ranges are the scene's.",
    ),
)  # fmt: skip


@dataclass(frozen=True)
class Filming:
    """How a command line wants demonstrations filmed, and what varies in them."""

    cameras: str | None = None
    size: str | None = None
    rate: int | None = None
    vary: str | None = None

    @property
    def asked(self) -> bool:
        """Whether anything is."""
        return self.cameras is not None or self.vary is not None

    def refuse_at_odds(self, demonstrate: str | None) -> None:
        """Refuse options that lack the one that they go with, before anything is loaded.

        Raises:
            QueryError: there is one.
        """
        for option, value in (("--size", self.size), ("--rate", self.rate)):
            if value is not None and self.cameras is None:
                raise QueryError(f"{option} {value} is for --cameras; name some, such as --cameras front")
        for option, value in (("--cameras", self.cameras), ("--vary", self.vary)):
            if value is not None and demonstrate is None:
                raise QueryError(f"{option} {value} is for demonstrations; add --demonstrate")

    def staging(self, *scenes: Scene) -> Staging | None:
        """Return what is asked of demonstrations in some scenes, None where nothing is.

        Raises:
            QueryError: there is no such camera, size, rate, or thing to vary.
        """
        from prag_asp.physics import Staging

        if not self.asked:
            return None
        cameras, vary = (_listed(option, text) for option, text in (("cameras", self.cameras), ("vary", self.vary)))
        rate = {} if self.rate is None else {"rate": self.rate}
        staging = Staging(cameras, None if self.size is None else pixels(self.size), vary=vary, **rate)
        for scene in scenes:
            staging.cameras_of(scene)
        return staging


def _listed(option: str, text: str | None) -> tuple[str, ...]:
    """Return the words of an option that are separated by commas.

    Raises:
        QueryError: there are none, or one is empty.
    """
    words = () if text is None else tuple(word.strip() for word in text.split(","))
    if not all(words):
        raise QueryError(f"--{option} {text}: write names with commas between them")
    return words


def films(function: Function) -> Function:
    """Give a command the options of cameras and of what varies, as one value `filming`."""
    return bundled(function, "filming", Filming, FILMS)

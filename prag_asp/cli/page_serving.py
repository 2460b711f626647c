"""Serve a page until Ctrl-C, and print its link."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import click

from prag_asp.cli.terminal import say, tell_line

if TYPE_CHECKING:
    from prag_asp.explore.page_server import View
    from prag_asp.explore.turns import Turns


def serve_page(views: Mapping[str, View], turns: Turns, page: str, *, port: int, opens: bool) -> None:
    """Serve views, and print the link of a page, given by its file and query; with `opens`, open it in the browser."""
    from prag_asp.explore.page_server import PageServer
    from prag_asp.explore.space_pages import PAGE

    with PageServer(PAGE, views, turns, port=port, report=tell_line) as server:
        link = f"{server.link}{page}"
        say(link)
        tell_line("open this link in a browser on this machine; Ctrl-C ends")
        if opens:
            click.launch(link)
        server.serve_forever()

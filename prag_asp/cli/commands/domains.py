"""``prag-asp domains`` and ``prag-asp new``: the shipped domains, and a new domain."""

from __future__ import annotations

from pathlib import Path

import click

from prag_asp.cli import shell_completion
from prag_asp.cli.terminal import say, tell_line


@click.command()
def domains() -> None:
    """List the shipped domains."""
    from prag_asp.program.paths import shipped_domains
    from prag_asp.program.settings import read_table

    folders = shipped_domains()
    width = max(map(len, folders), default=0)
    for name, folder in folders.items():
        say(f"{name:<{width}}  {read_table(folder / 'domain.toml').get('description', '')}")


@click.command()
@click.argument("name", metavar="NAME")
@click.option("--plain", is_flag=True, help="Write a domain without a robot.")
@click.option(
    "--from", "like", metavar="DOMAIN", shell_complete=shell_completion.domains,
    help="Copy a shipped domain instead, such as tabletop.",
)  # fmt: skip
def new(name: str, plain: bool, like: str | None) -> None:
    """Create the folder NAME with a small, commented domain that has a robot."""
    from prag_asp.domain.scaffold import write_new_domain

    folder = write_new_domain(name, Path(), plain=plain, like=like)
    tell_line(f"wrote {folder}; try: prag-asp check {folder}")

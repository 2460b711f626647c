"""The command ``prag-asp``."""

from __future__ import annotations

import sys

from prag_asp.cli.registry import cli

__all__ = ["cli", "main"]


def main() -> None:
    """Run the command and exit."""
    sys.exit(cli.main())

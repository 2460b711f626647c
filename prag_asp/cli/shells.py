"""How bash and fish are given what they are offered: actions have parentheses and commas."""

from __future__ import annotations

import os
import re
from typing import Any

from click.shell_completion import BashComplete, CompletionItem, FishComplete, add_completion_class

PLAIN = re.compile(r"[\w./:=+@%^-]*")
"""What bash reads as one word."""


class Bash(BashComplete):
    """Puts into quotes what bash would not read as one word."""

    def format_completion(self, item: CompletionItem[Any]) -> str:
        """Return an item as the script reads it; where the user has opened a quote, it stays as it is."""
        words = os.environ["COMP_WORDS"].split("\n")
        number = int(os.environ["COMP_CWORD"])
        quoted = number < len(words) and words[number][:1] in ("'", '"')
        if item.type == "plain" and not quoted and not PLAIN.fullmatch(item.value):
            return f"{item.type},'{item.value}'"
        return super().format_completion(item)


class Fish(FishComplete):
    """Splits an item from its type alone, for its value has commas."""

    source_template = FishComplete.source_template.replace('split ","', 'split --max 1 ","')


def add_shells() -> None:
    """Let click speak to these shells so."""
    add_completion_class(Bash)
    add_completion_class(Fish)

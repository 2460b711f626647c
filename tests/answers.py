"""The module that workers run in their tests."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Iterator
from typing import Any


class Stubborn(Exception):
    """An error that cannot be read again once it has been written."""

    def __init__(self, what: str, why: str) -> None:
        super().__init__(f"{what} {why}")


def answers(messages: Iterator[Any]) -> Iterator[Any]:
    for wish, *of in messages:
        if wish == "echo":
            yield of[0]
        elif wish == "streams":
            sys.stdout.write("on stdout\n")
            sys.stdout.flush()
            yield sys.stdin.read()
        elif wish == "length":
            yield len(of[0])
        elif wish == "sleep":
            time.sleep(of[0])
            yield "slept"
        elif wish == "die":
            os.kill(os.getpid(), of[0])
        elif wish == "exit":
            sys.exit(of[0])
        elif wish == "stubborn":
            raise Stubborn("it", "cannot travel")
        else:
            raise ValueError(f"no answer to {wish}")

"""What a process that checks witnesses does: open the cascade once, and answer witnesses with how far they come."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from prag_asp.physics.tier_cascade import Passage, open_cascade


def answers(messages: Iterator[Any]) -> Iterator[list[Passage]]:
    """Yield how far numbered witnesses come, many together; first of all come a scene and the other settings.

    Raises:
        SceneError: the scene cannot be built.
    """
    scene, settings = next(messages)
    with open_cascade(scene, **settings) as passage:
        for witnesses in messages:
            yield [passage(task, witness, index) for index, (task, witness) in witnesses]

"""What a process that validates tasks does: build one validator, and answer tasks with verdicts."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack
from typing import Any

from prag_asp.errors import PragError, SceneError
from prag_asp.physics.validator import Validator, open_validator
from prag_asp.physics.verdict import Verdict
from prag_asp.scene.scene import Scene


def answers(messages: Iterator[Any]) -> Iterator[list[Verdict]]:
    """Yield the verdicts on numbered tasks, many together; first of all come a scene and the other settings.

    Raises:
        SceneError: the scene cannot be built, or a task speaks about something for which it has no shape.
    """
    scene, settings = next(messages)
    with ExitStack() as resources:
        validator = opened_validator(scene, resources)
        for tasks in messages:
            yield [validator.validate(task, index=index, **settings) for index, task in tasks]


def opened_validator(scene: Scene, resources: ExitStack) -> Validator:
    """Return a validator of a scene.

    Raises:
        SceneError: the scene cannot be built, whatever the reason.
    """
    try:
        return resources.enter_context(open_validator(scene))
    except PragError:
        raise
    except Exception as error:
        raise SceneError(f"the scene cannot be built: {type(error).__name__}: {error}") from error

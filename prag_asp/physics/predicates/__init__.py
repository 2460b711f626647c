"""The registry of spatial predicates, and the predicates that a domain adds.

In `PREDICATES`, each module of this package, like a Python file of a domain, maps the names of one or more predicates
to their definitions. A new predicate needs a module, and a row in `prag_asp.scene.predicate_names`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from importlib import import_module

from prag_asp.errors import SceneError
from prag_asp.physics.predicates.box_predicates import box_predicate
from prag_asp.physics.predicates.predicate import Direction, Gripper, Predicate, states
from prag_asp.physics.predicates.python_file import load_predicate
from prag_asp.physics.predicates.volume import Ring, Side, Volume, Yaws
from prag_asp.scene.predicate_names import VOCABULARY
from prag_asp.scene.scene import Own, Scene

PREDICATES: Mapping[str, Predicate] = {
    name: import_module(f"{__name__}.{word.file}").PREDICATES[name] for name, word in VOCABULARY.items()
}
"""The spatial predicates that every scene has, by name."""

NAMED: Mapping[str, Predicate] = {
    name: replace(predicate, sentence=predicate.robot_sentence)
    for name, predicate in PREDICATES.items()
    if predicate.robot_sentence is not None
}
"""The same predicates with sentences that name the gripper, for scenes with several robots."""


def predicate_of(scene: Scene, name: str) -> Predicate:
    """Return the spatial predicate of a scene with a given name; the same name always returns the same object.

    In scenes with several robots, the sentence of the predicate names the gripper.

    Raises:
        SceneError: the scene has no such predicate, or its Python file is not trusted or fails.
    """
    shared = NAMED.get(name) if scene.shared else None
    shared = shared or PREDICATES.get(name)
    if shared is not None:
        return shared
    own = scene.own.get(name)
    if own is None:
        raise SceneError(f"there is no spatial predicate {name}; known are {', '.join((*PREDICATES, *scene.own))}")
    if own.file and not scene.trusted:
        raise SceneError(
            f"{own.file}:1: defines {name} in Python, which runs only if you trust the domain; "
            "read the file, then add --trust (in Python: load_domain(..., trust=True))"
        )
    return _own(own)


@cache
def _own(own: Own) -> Predicate:
    """Return a user-defined predicate."""
    return load_predicate(own) if own.file else box_predicate(own)


def own_predicates(scene: Scene) -> Mapping[str, Predicate]:
    """Return the user-defined predicates of a scene, by name.

    Raises:
        SceneError: the Python file of a predicate is not trusted or fails.
    """
    return {name: predicate_of(scene, name) for name in scene.own}


__all__ = [
    "PREDICATES",
    "Direction",
    "Gripper",
    "Predicate",
    "Ring",
    "Side",
    "Volume",
    "Yaws",
    "own_predicates",
    "predicate_of",
    "states",
]

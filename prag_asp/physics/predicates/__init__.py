"""The spatial predicates, each defined once, and those that a domain adds."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache

from prag_asp.errors import SceneError
from prag_asp.physics.predicates.aligned import ALIGNED
from prag_asp.physics.predicates.beside import BESIDE
from prag_asp.physics.predicates.between import BETWEEN
from prag_asp.physics.predicates.boxes import composed
from prag_asp.physics.predicates.gripper import AT, GRIPPER_OPEN, HOLDING, NAMED, OVER, REACHABLE
from prag_asp.physics.predicates.inside import INSIDE, LOCATED
from prag_asp.physics.predicates.near import FAR_FROM, NEAR_TO
from prag_asp.physics.predicates.on_top import ON_TOP
from prag_asp.physics.predicates.opening import IS_CLOSED, IS_OPEN
from prag_asp.physics.predicates.predicate import Predicate, states
from prag_asp.physics.predicates.python_file import defined
from prag_asp.physics.predicates.rotated import ROTATED
from prag_asp.physics.predicates.upright import UPRIGHT
from prag_asp.physics.predicates.volume import Ring, Side, Volume, Yaws
from prag_asp.scene.model import Own, Scene

PREDICATES: Mapping[str, Predicate] = {
    predicate.name: predicate
    for predicate in (
        ON_TOP, INSIDE, *BESIDE, REACHABLE, HOLDING, AT, GRIPPER_OPEN, OVER, LOCATED, ROTATED, NEAR_TO, FAR_FROM,
        BETWEEN, ALIGNED, UPRIGHT, IS_OPEN, IS_CLOSED,
    )
}  # fmt: skip
"""Every spatial predicate that all scenes have, by its name."""


def predicate_of(scene: Scene, name: str) -> Predicate:
    """Return a spatial predicate of a scene by its name, always the same value; it names the gripper if there are more.

    Raises:
        SceneError: there is none; or a Python file defines it that is not trusted, or fails.
    """
    known = NAMED.get(name) if scene.shared else None
    known = known or PREDICATES.get(name)
    if known is not None:
        return known
    own = scene.own.get(name)
    if own is None:
        raise SceneError(f"there is no spatial predicate {name}; known are {', '.join((*PREDICATES, *scene.own))}")
    if own.file and not scene.trusted:
        raise SceneError(
            f"{own.file}:1: defines {name} in Python, which is run only where you trust it; "
            "read the file, then add --trust (in Python: load_domain(..., trust=True))"
        )
    return _own(own)


@cache
def _own(own: Own) -> Predicate:
    """Return a predicate that a domain adds."""
    return defined(own) if own.file else composed(own)


def own_predicates(scene: Scene) -> Mapping[str, Predicate]:
    """Return the spatial predicates that a scene adds, by their names.

    Raises:
        SceneError: a Python file defines one that is not trusted, or fails.
    """
    return {name: predicate_of(scene, name) for name in scene.own}


__all__ = ["PREDICATES", "Predicate", "Ring", "Side", "Volume", "Yaws", "own_predicates", "predicate_of", "states"]

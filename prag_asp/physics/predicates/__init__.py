"""The spatial predicates, each defined once."""

from __future__ import annotations

from collections.abc import Mapping

from prag_asp.physics.predicates.beside import BESIDE
from prag_asp.physics.predicates.gripper import AT, GRIPPER_OPEN, HOLDING, OVER, REACHABLE
from prag_asp.physics.predicates.inside import INSIDE, LOCATED
from prag_asp.physics.predicates.on_top import ON_TOP
from prag_asp.physics.predicates.predicate import Predicate
from prag_asp.physics.predicates.rotated import ROTATED
from prag_asp.physics.predicates.volume import Volume

PREDICATES: Mapping[str, Predicate] = {
    predicate.name: predicate
    for predicate in (ON_TOP, INSIDE, *BESIDE, REACHABLE, HOLDING, AT, GRIPPER_OPEN, OVER, LOCATED, ROTATED)
}
"""Every spatial predicate by its name."""

__all__ = ["PREDICATES", "Predicate", "Volume"]

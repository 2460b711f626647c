"""Whether a robot can do a task: spatial predicates, witnesses, and the search for them in PyBullet."""

from __future__ import annotations

from prag_asp.physics.cascade import open_cascade
from prag_asp.physics.checks.check import check_witness, open_witness_check
from prag_asp.physics.checks.settling import open_settling, settle
from prag_asp.physics.demonstration.check import check_demonstration
from prag_asp.physics.demonstration.demonstration import Demonstration
from prag_asp.physics.demonstration.perform import demonstrate
from prag_asp.physics.facts import physical_task
from prag_asp.physics.motion.transit import travel
from prag_asp.physics.pictures.camera import PicturesMissingError
from prag_asp.physics.pictures.render import animate, film_strip, still
from prag_asp.physics.pool import WorkerError, validate_numbered, validate_tasks
from prag_asp.physics.predicates import PREDICATES, Predicate
from prag_asp.physics.search.attempt import CAUSES
from prag_asp.physics.validator import Validator, open_validator, validate_task
from prag_asp.physics.verdict import TIERS, Budget, Verdict
from prag_asp.physics.witness import Moment, Waypoint, Witness

__all__ = [
    "CAUSES",
    "PREDICATES",
    "TIERS",
    "Budget",
    "Demonstration",
    "Moment",
    "PicturesMissingError",
    "Predicate",
    "Validator",
    "Verdict",
    "Waypoint",
    "Witness",
    "WorkerError",
    "animate",
    "check_demonstration",
    "check_witness",
    "demonstrate",
    "film_strip",
    "open_cascade",
    "open_settling",
    "open_validator",
    "open_witness_check",
    "physical_task",
    "settle",
    "still",
    "travel",
    "validate_numbered",
    "validate_task",
    "validate_tasks",
]

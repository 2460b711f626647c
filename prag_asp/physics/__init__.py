"""Physical feasibility of tasks: spatial predicates, witnesses, and the search for them in PyBullet.

The names below are loaded on first use. Names that compute no motion need neither PyBullet nor frankik; the others
raise `PhysicsMissingError` if these packages are not installed.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from prag_asp.lazy import names_from

if TYPE_CHECKING:
    from prag_asp.errors import PhysicsMissingError, PicturesMissingError, WorkerError
    from prag_asp.physics.checks.settling import open_settling, settle
    from prag_asp.physics.checks.witness_check import check_witness, open_witness_check
    from prag_asp.physics.control.control import Control
    from prag_asp.physics.control.names import CONTROLS
    from prag_asp.physics.control.recorded_actions import recorded_actions
    from prag_asp.physics.demonstration.demonstration import Demonstration
    from prag_asp.physics.demonstration.demonstration_check import check_demonstration
    from prag_asp.physics.demonstration.footage import CameraImage, CameraVideo, Footage
    from prag_asp.physics.demonstration.performance import demonstrate
    from prag_asp.physics.filming.camera_rendering import render_cameras
    from prag_asp.physics.filming.episode_options import Staging
    from prag_asp.physics.filming.footage_check import check_footage
    from prag_asp.physics.motion.transit import plan_transit
    from prag_asp.physics.pictures.animation import animate
    from prag_asp.physics.pictures.rendering import film_strip, still
    from prag_asp.physics.playback.episode_scene import episode_glb, episode_page
    from prag_asp.physics.predicates import PREDICATES, Predicate, Side, Volume, states
    from prag_asp.physics.search.attempt import CAUSES
    from prag_asp.physics.situation import Situation
    from prag_asp.physics.symbolic_facts import physical_task
    from prag_asp.physics.tiers import open_tier_check
    from prag_asp.physics.validation import validate_numbered, validate_tasks
    from prag_asp.physics.validator import Validator, open_validator, validate_task
    from prag_asp.physics.verdict import TIERS, Budget, Tier, Verdict
    from prag_asp.physics.witness import Arm, Moment, Waypoint, Witness
    from prag_asp.scene.geometry import Quaternion, yaw_of
    from prag_asp.scene.variation import Variation

__all__ = [
    "CAUSES",
    "CONTROLS",
    "PREDICATES",
    "TIERS",
    "Arm",
    "Budget",
    "CameraImage",
    "CameraVideo",
    "Control",
    "Demonstration",
    "Footage",
    "Moment",
    "PhysicsMissingError",
    "PicturesMissingError",
    "Predicate",
    "Quaternion",
    "Side",
    "Situation",
    "Staging",
    "Tier",
    "Validator",
    "Variation",
    "Verdict",
    "Volume",
    "Waypoint",
    "Witness",
    "WorkerError",
    "animate",
    "check_demonstration",
    "check_footage",
    "check_witness",
    "demonstrate",
    "episode_glb",
    "episode_page",
    "film_strip",
    "open_settling",
    "open_tier_check",
    "open_validator",
    "open_witness_check",
    "physical_task",
    "plan_transit",
    "recorded_actions",
    "render_cameras",
    "require_physics",
    "settle",
    "states",
    "still",
    "validate_numbered",
    "validate_task",
    "validate_tasks",
    "yaw_of",
]

_HOMES = {
    "prag_asp.errors": ("PhysicsMissingError", "PicturesMissingError", "WorkerError"),
    "prag_asp.physics.tiers": ("open_tier_check",),
    "prag_asp.physics.checks.witness_check": ("check_witness", "open_witness_check"),
    "prag_asp.physics.checks.settling": ("open_settling", "settle"),
    "prag_asp.physics.control.control": ("Control",),
    "prag_asp.physics.control.names": ("CONTROLS",),
    "prag_asp.physics.control.recorded_actions": ("recorded_actions",),
    "prag_asp.physics.demonstration.demonstration_check": ("check_demonstration",),
    "prag_asp.physics.demonstration.demonstration": ("Demonstration",),
    "prag_asp.physics.demonstration.footage": ("CameraVideo", "Footage", "CameraImage"),
    "prag_asp.physics.demonstration.performance": ("demonstrate",),
    "prag_asp.physics.symbolic_facts": ("physical_task",),
    "prag_asp.physics.filming.footage_check": ("check_footage",),
    "prag_asp.physics.filming.camera_rendering": ("render_cameras",),
    "prag_asp.physics.filming.episode_options": ("Staging",),
    "prag_asp.physics.motion.transit": ("plan_transit",),
    "prag_asp.physics.pictures.animation": ("animate",),
    "prag_asp.physics.playback.episode_scene": ("episode_glb", "episode_page"),
    "prag_asp.physics.pictures.rendering": ("film_strip", "still"),
    "prag_asp.physics.validation": ("validate_numbered", "validate_tasks"),
    "prag_asp.physics.predicates": ("PREDICATES", "Predicate", "Side", "Volume", "states"),
    "prag_asp.physics.situation": ("Situation",),
    "prag_asp.scene.geometry": ("Quaternion", "yaw_of"),
    "prag_asp.scene.variation": ("Variation",),
    "prag_asp.physics.search.attempt": ("CAUSES",),
    "prag_asp.physics.validator": ("Validator", "open_validator", "validate_task"),
    "prag_asp.physics.verdict": ("TIERS", "Budget", "Tier", "Verdict"),
    "prag_asp.physics.witness": ("Arm", "Moment", "Waypoint", "Witness"),
}

__getattr__ = names_from(__name__, _HOMES)


def require_physics(reason: str = "") -> None:
    """Load PyBullet before work that needs it starts; `reason` tells the user what needs it.

    Raises:
        PhysicsMissingError: PyBullet is not installed, or cannot be loaded.
    """
    from prag_asp.errors import PhysicsMissingError  # noqa: PLC0415 - names are loaded when they are used

    try:
        import prag_asp.physics.bullet  # noqa: F401, PLC0415 - heavy, and needed here only
    except PhysicsMissingError as error:
        raise PhysicsMissingError(f"{reason}, and {error}" if reason else str(error)) from None


def __dir__() -> list[str]:
    return __all__

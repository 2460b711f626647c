"""PyBullet, required before any work is done that would be for nothing without it."""

from __future__ import annotations

from prag_asp.errors import PhysicsMissingError


def require_physics(reason: str = "") -> None:
    """Load PyBullet; `reason` says what asks for it.

    Raises:
        PhysicsMissingError: it is not installed, or cannot be loaded.
    """
    try:
        import prag_asp.physics.bullet  # noqa: F401, PLC0415 - heavy, and asked for here
    except PhysicsMissingError as error:
        raise PhysicsMissingError(f"{reason}, and {error}" if reason else str(error)) from None

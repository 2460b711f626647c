"""Check that PyBullet is installed before starting work that needs it."""

from __future__ import annotations

from prag_asp.errors import PhysicsMissingError


def require_physics(reason: str = "") -> None:
    """Load PyBullet; `reason` says what needs it, for the message.

    Raises:
        PhysicsMissingError: it is not installed, or cannot be loaded.
    """
    try:
        import prag_asp.physics.bullet  # noqa: F401, PLC0415 - heavy, and needed here only
    except PhysicsMissingError as error:
        raise PhysicsMissingError(f"{reason}, and {error}" if reason else str(error)) from None

"""The versions of this package and of its main dependencies, found without importing them."""

from __future__ import annotations

from importlib.metadata import PackageNotFoundError, version

UNKNOWN = "0+unknown"
"""The version given for a copy that is not installed."""

PYBULLET = ("pybullet", "pybullet-arm64")
"""The distributions that contain the simulator."""


def own_version() -> str:
    """Return the version of this package."""
    return _version("prag_asp") or UNKNOWN


def versions() -> str:
    """Return the versions on one line, such as ``prag_asp 0.1.0, clingo 5.8.0, PyBullet 3.2.7``."""
    bullet = next(filter(None, map(_version, PYBULLET)), None)
    simulator = f"PyBullet {bullet}" if bullet else "no PyBullet"
    return f"prag_asp {own_version()}, clingo {_version('clingo')}, {simulator}"


def _version(distribution: str) -> str | None:
    try:
        return version(distribution)
    except PackageNotFoundError:
        return None


__version__ = own_version()

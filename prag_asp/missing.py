"""PyBullet and frankik, or what to do where they are missing: a new Python comes long before their wheels."""

from __future__ import annotations

import shlex
import sys
from importlib import import_module
from types import ModuleType
from urllib.parse import urlsplit
from urllib.request import url2pathname

from prag_asp.errors import PhysicsMissingError

NEWEST = (3, 13)
"""The newest Python that both have wheels for; pyproject.toml says so, too."""


def needed(module: str) -> ModuleType:
    """Import a module that physics needs.

    Raises:
        PhysicsMissingError: it is not installed, or cannot be loaded.
    """
    try:
        return import_module(module)
    except ImportError as error:
        raise PhysicsMissingError(_told(error, module)) from None


def require_physics(reason: str = "") -> None:
    """Load PyBullet; `reason` says what asks for it.

    Raises:
        PhysicsMissingError: it is not installed, or cannot be loaded.
    """
    try:
        needed("prag_asp.physics.bullet")
    except PhysicsMissingError as error:
        raise PhysicsMissingError(f"{reason}, and {error}" if reason else str(error)) from None


def _told(error: ImportError, module: str) -> str:
    """Return what is wrong with a module, and what to do."""
    version = ".".join(map(str, sys.version_info[:2]))
    if error.name != module:
        return f"physics needs {module}, which cannot be loaded: {' '.join(str(error).split())}; install it anew"
    if sys.version_info[:2] <= NEWEST:
        fork = sys.platform != "linux" or sys.version_info >= (3, 12)
        return f"physics needs PyBullet and frankik: pip install {'pybullet-arm64' if fork else 'pybullet'} frankik"
    newest = ".".join(map(str, NEWEST))
    return (
        f"physics needs PyBullet and frankik, which have no wheels for Python {version}; take an older Python, "
        f"for instance by: uv tool install --python {newest} {_origin()}; or build both from source"
    )


def _origin() -> str:
    """Return what prag_asp is installed from: a folder or a file, otherwise its name."""
    import json  # noqa: PLC0415 - only what goes wrong needs these
    from importlib.metadata import PackageNotFoundError, distribution  # noqa: PLC0415

    try:
        url = json.loads(distribution("prag_asp").read_text("direct_url.json") or "{}").get("url", "")
    except PackageNotFoundError:
        url = ""
    return shlex.quote(url2pathname(urlsplit(url).path)) if url.startswith("file:") else "prag_asp"

"""Optional packages: import them, or raise an error that says how to install them.

PyBullet and frankik may be missing because their wheels appear long after a new version of Python is released; pyarrow,
Gymnasium and the packages for dataset formats may be missing because few users need them.
"""

from __future__ import annotations

import shlex
import sys
from collections.abc import Iterable
from importlib import import_module
from importlib.util import find_spec
from types import ModuleType

from prag_asp.errors import (
    DatasetsMissingError,
    LearningMissingError,
    PhysicsMissingError,
    RayMissingError,
)

NEWEST = (3, 13)
"""The newest version of Python for which PyBullet and frankik have wheels; pyproject.toml states it too."""


def needed(module: str) -> ModuleType:
    """Import a module that physics needs.

    Raises:
        PhysicsMissingError: the module is not installed, or cannot be loaded.
    """
    try:
        return import_module(module)
    except ImportError as error:
        if error.name == module:
            message = f"physics needs PyBullet and frankik; {advice(sys.version_info[:2])}"
        else:
            message = f"physics needs {module}, which cannot be loaded: {_reason(error)}; install it again"
        raise PhysicsMissingError(message) from None


def require_pyarrow() -> None:
    """Check that the package for writing and reading datasets is installed.

    Raises:
        DatasetsMissingError: pyarrow is not installed, or cannot be loaded.
    """
    try:
        import_module("pyarrow.parquet")
    except ImportError as error:
        missing = (error.name or "").startswith("pyarrow")
        message = "datasets need pyarrow" if missing else f"pyarrow cannot be loaded: {_reason(error)}"
        raise DatasetsMissingError(f'{message}; install it: pip install "prag_asp[datasets]"') from None


def require_gymnasium() -> ModuleType:
    """Import Gymnasium.

    Raises:
        LearningMissingError: Gymnasium is not installed, or cannot be loaded.
    """
    try:
        return import_module("gymnasium")
    except ImportError as error:
        missing = error.name == "gymnasium"
        message = "environments need Gymnasium" if missing else f"Gymnasium cannot be loaded: {_reason(error)}"
        raise LearningMissingError(f'{message}; install it: pip install "prag_asp[rl]"') from None


def require_packages(form: str, packages: Iterable[str], extra: str = "formats") -> None:
    """Check that the packages for a dataset format are installed.

    Raises:
        DatasetsMissingError: a package is not installed, or cannot be loaded.
    """
    for package in packages:
        try:
            import_module(package)
        except ImportError as error:
            missing = (error.name or "").partition(".")[0] == package
            reason = "" if missing else f", which cannot be loaded: {_reason(error)}"
            message = f"the format {form} needs {package}{reason}; install it"
            raise DatasetsMissingError(f'{message}: pip install "prag_asp[{extra}]"') from None


def require_ray() -> None:
    """Check that Ray is installed; a separate process imports it.

    Raises:
        RayMissingError: Ray is not installed.
    """
    if find_spec("ray") is None:
        raise RayMissingError('a cluster needs Ray; install it on every node: pip install "prag_asp[ray]"')


def _reason(error: ImportError) -> str:
    """Return the message of an error as one line."""
    return " ".join(str(error).split())


def advice(version: tuple[int, int]) -> str:
    """Return advice on installing PyBullet and frankik for a version of Python."""
    if version <= NEWEST:
        fork = version >= (3, 12) or sys.platform != "linux"
        return f"install them: pip install {'pybullet-arm64' if fork else 'pybullet'} frankik"
    (major, minor), newest = version, ".".join(map(str, NEWEST))
    return (
        f"there are no wheels for Python {major}.{minor}: use Python {newest}, for instance by "
        f"uv tool install --python {newest} {_origin()}; or build both from source"
    )


def _origin() -> str:
    """Return the folder or file from which prag_asp was installed, or the package name if it is unknown."""
    import json  # noqa: PLC0415 - only errors need these
    from importlib.metadata import PackageNotFoundError, distribution  # noqa: PLC0415
    from urllib.parse import urlsplit  # noqa: PLC0415
    from urllib.request import url2pathname  # noqa: PLC0415

    try:
        origin = distribution("prag_asp").read_text("direct_url.json")
    except PackageNotFoundError:
        origin = None
    url = urlsplit(json.loads(origin)["url"] if origin else "")
    return shlex.quote(url2pathname(url.path)) if url.scheme == "file" else "prag_asp"

"""What to do where a package is missing.

PyBullet and frankik may be, because a new Python comes long before their wheels; pyarrow, Gymnasium, and what other
forms of datasets are written with, because few need them.
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
    PddlMissingError,
    PhysicsMissingError,
    RayMissingError,
)

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
        if error.name == module:
            told = f"physics needs PyBullet and frankik; {advice(sys.version_info[:2])}"
        else:
            told = f"physics needs {module}, which cannot be loaded: {' '.join(str(error).split())}; install it anew"
        raise PhysicsMissingError(told) from None


def require_pyarrow() -> None:
    """Check that datasets can be written and read.

    Raises:
        DatasetsMissingError: pyarrow is not installed, or cannot be loaded.
    """
    try:
        import_module("pyarrow.parquet")
    except ImportError as error:
        missing = (error.name or "").startswith("pyarrow")
        told = "datasets need pyarrow" if missing else f"pyarrow cannot be loaded: {' '.join(str(error).split())}"
        raise DatasetsMissingError(f'{told}; install it: pip install "prag_asp[datasets]"') from None


def require_gymnasium() -> ModuleType:
    """Import Gymnasium.

    Raises:
        LearningMissingError: it is not installed, or cannot be loaded.
    """
    try:
        return import_module("gymnasium")
    except ImportError as error:
        told = "environments need Gymnasium"
        if error.name != "gymnasium":
            told = f"Gymnasium cannot be loaded: {' '.join(str(error).split())}"
        raise LearningMissingError(f'{told}; install it: pip install "prag_asp[rl]"') from None


def require_packages(form: str, packages: Iterable[str]) -> None:
    """Check that the packages are there that a form of datasets is written with.

    Raises:
        DatasetsMissingError: one is not installed, or cannot be loaded.
    """
    for package in packages:
        try:
            import_module(package)
        except ImportError as error:
            missing = (error.name or "").partition(".")[0] == package
            why = "" if missing else f", which cannot be loaded: {' '.join(str(error).split())}"
            told = f"the form {form} needs {package}{why}; install it"
            raise DatasetsMissingError(f'{told}: pip install "prag_asp[formats]"') from None


def require_ray() -> None:
    """Check that there is Ray; it is imported by a process of its own.

    Raises:
        RayMissingError: it is not installed.
    """
    if find_spec("ray") is None:
        raise RayMissingError('a cluster needs Ray; install it on every node: pip install "prag_asp[ray]"')


def require_pddl() -> None:
    """Check that files of PDDL can be read.

    Raises:
        PddlMissingError: the package pddl is not installed, or cannot be loaded.
    """
    try:
        import_module("pddl.parser")
    except ImportError as error:
        missing = (error.name or "").partition(".")[0] in ("pddl", "lark")
        told = "PDDL needs the package pddl" if missing else f"pddl cannot be loaded: {' '.join(str(error).split())}"
        raise PddlMissingError(f'{told}; install it: pip install "prag_asp[pddl]"') from None


def advice(version: tuple[int, int]) -> str:
    """Return how a Python of some version gets what is missing."""
    if version <= NEWEST:
        fork = version >= (3, 12) or sys.platform != "linux"
        return f"install them: pip install {'pybullet-arm64' if fork else 'pybullet'} frankik"
    (major, minor), newest = version, ".".join(map(str, NEWEST))
    return (
        f"there are no wheels for Python {major}.{minor}: take Python {newest}, for instance by "
        f"uv tool install --python {newest} {_origin()}; or build both from source"
    )


def _origin() -> str:
    """Return what prag_asp was installed from: a folder or a file, otherwise its name."""
    import json  # noqa: PLC0415 - only what goes wrong needs these
    from importlib.metadata import PackageNotFoundError, distribution  # noqa: PLC0415
    from urllib.parse import urlsplit  # noqa: PLC0415
    from urllib.request import url2pathname  # noqa: PLC0415

    try:
        told = distribution("prag_asp").read_text("direct_url.json")
    except PackageNotFoundError:
        told = None
    url = urlsplit(json.loads(told)["url"] if told else "")
    return shlex.quote(url2pathname(url.path)) if url.scheme == "file" else "prag_asp"

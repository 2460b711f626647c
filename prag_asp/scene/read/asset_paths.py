"""Find the files to which a model refers, by the path conventions of PyBullet, ROS and model folders.

As in PyBullet, a path is relative to the folder of the model or to a folder above it, nearest first. In
``package://NAME/PATH`` and ``model://NAME/PATH``, NAME is either the first folder of such a path, or the package that
contains the model; the folder of that package may have a different name. Files outside the folder of the domain are not
found.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from prag_asp.errors import SceneError
from prag_asp.safe_reading import is_inside

SCHEMES = ("package://", "model://")
"""The prefixes of paths that begin with the name of a package."""

FILE = "file://"


def find_asset(name: str, model: Path, folder: Path) -> Path:
    """Return the path of the file to which a model in the folder of a domain refers.

    Raises:
        SceneError: the folder has no such file.
    """
    candidates = list(_candidates(name, model, folder))
    for path in candidates:
        if is_inside(path, folder) and path.is_file():
            return path
    first = candidates[0]
    require_inside(first, folder)
    return first


def require_inside(path: Path, folder: Path) -> None:
    """Check that a file exists inside a folder.

    Raises:
        SceneError: the file does not exist, or is outside the folder.
    """
    if not is_inside(path, folder):
        raise SceneError(f"{path}: lies outside the domain; copy it into {folder}")
    if path.is_dir():
        raise SceneError(f"{path}: is a folder; give the path of a file in it")
    if not path.is_file():
        raise SceneError(f"{path}: there is no such file; give the path from the folder of the domain")


def _candidates(name: str, model: Path, folder: Path) -> Iterator[Path]:
    """Yield the possible paths for a name, likeliest first."""
    scheme = next((scheme for scheme in SCHEMES if name.startswith(scheme)), "")
    plain = name.removeprefix(scheme).removeprefix(FILE)
    names = [plain] if not scheme else [plain, plain.partition("/")[2].lstrip("/")]
    above = [parent for parent in (model.parent, *model.parent.parents) if is_inside(parent, folder)]
    for each in filter(None, names):
        yield from (parent / each for parent in above)
    if not any(names):
        yield model.parent

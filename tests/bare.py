"""An environment like that of a new Python: it has this package, and what pip would install with it there, no more."""

from __future__ import annotations

import subprocess
import sys
import sysconfig
from collections.abc import Iterable, Mapping
from importlib.metadata import Distribution, distribution
from pathlib import Path

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from tests.toml import tomllib

ROOT = Path(__file__).parent.parent
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
LINUX = {"sys_platform": "linux", "platform_machine": "x86_64"}


def required(version: str, platform: Mapping[str, str] = LINUX) -> list[str]:
    """Return the names of the packages that this one requires of a version of Python, such as 3.14, on a platform."""
    environment = {"python_version": version, **platform}
    requirements = map(Requirement, PROJECT["dependencies"])
    return [each.name for each in requirements if each.marker is None or each.marker.evaluate(environment)]


def bare_python(folder: Path, *others: str) -> Path:
    """Make an environment in a new folder with what Python 3.14 would get and with other packages; return its Python.

    The packages are linked: nothing is downloaded, and what is not linked is missing.
    """
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", str(folder)], check=True)
    own = ["tomli"] if sys.version_info < (3, 11) else []
    link(folder, *required("3.14"), *own, *others)
    (packages(folder) / "checkout.pth").write_text(f"{ROOT}\n")
    return folder / "bin" / "python"


def link(environment: Path, *requirements: str) -> None:
    """Link packages that are installed here, one by one, and all that they need, unless the environment has them."""
    site = packages(environment)
    for package in _with_what_they_need(requirements):
        for name in {path.parts[0] for path in package.files or ()} - {"..", "__pycache__"}:
            if not (site / name).exists():
                (site / name).symlink_to(Path(str(package.locate_file(name))))


def packages(environment: Path) -> Path:
    """Return where an environment has its packages."""
    return Path(sysconfig.get_path("purelib", "posix_prefix", {"base": str(environment)}))


def _with_what_they_need(requirements: Iterable[str]) -> list[Distribution]:
    """Return packages, and all that they and their extras require here."""
    found: dict[tuple[str, str], Distribution] = {}
    waiting = list(map(Requirement, requirements))
    while waiting:
        asked = waiting.pop()
        for part in {"", *asked.extras} - {part for name, part in found if name == canonicalize_name(asked.name)}:
            package = found[canonicalize_name(asked.name), part] = distribution(asked.name)
            for each in map(Requirement, package.requires or ()):
                if each.marker is None or each.marker.evaluate({"extra": part}):
                    waiting.append(each)
    return list(found.values())

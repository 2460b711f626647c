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

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

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

    The packages are those installed here, linked one by one: nothing is downloaded, and what is not linked is missing.
    """
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", str(folder)], check=True)
    python = folder / "bin" / "python"
    site = Path(sysconfig.get_path("purelib", "posix_prefix", {"base": str(folder)}))
    own = ["tomli"] if sys.version_info < (3, 11) else []
    for package in _with_what_they_need([*required("3.14"), *own, *others]):
        for name in {path.parts[0] for path in package.files or ()} - {"..", "__pycache__"}:
            if not (site / name).exists():
                (site / name).symlink_to(Path(str(package.locate_file(name))))
    (site / "checkout.pth").write_text(f"{ROOT}\n")
    return python


def _with_what_they_need(names: Iterable[str]) -> list[Distribution]:
    """Return packages by name, and all that they require here."""
    found: dict[str, Distribution] = {}
    waiting = list(names)
    while waiting:
        name = canonicalize_name(waiting.pop())
        if name not in found:
            found[name] = distribution(name)
            for each in map(Requirement, found[name].requires or ()):
                if each.marker is None or each.marker.evaluate({"extra": ""}):
                    waiting.append(each.name)
    return list(found.values())

"""Policies to evaluate, with one module for each kind, and `load_policy`, which finds the kind of a policy."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any

from prag_asp.errors import QueryError
from prag_asp.evaluation.policies.policy import Environment, Policy, PolicyMaker
from prag_asp.output.digests import files_digest

BASELINES = ("oracle", "random", "zeros")
"""The built-in policies."""

KINDS: Mapping[str, tuple[Callable[[str], bool], str]] = {
    "a baseline": (BASELINES.__contains__, "baselines"),
    "a policy server": (lambda text: text.startswith(("ws://", "wss://")), "server"),
    "a checkpoint of LeRobot": (lambda text: Path(text).is_dir(), "lerobot_policy"),
    "a Stable-Baselines3 zip": (lambda text: Path(text).suffix == ".zip", "stable_baselines"),
    "module:callable": (lambda text: ":" in text, "python_callable"),
}
"""Each kind of policy: a test of the text, and the module in this package whose function `maker` accepts the text.

A module may also have a function `environment`, which returns the environment options that a policy determines, and a
function `files`, which returns the files that define a policy.
"""


def load_policy(text: str) -> PolicyMaker:
    """Return the maker of a policy.

    The text is the name of a baseline, ``module:callable``, the path of a Stable-Baselines3 zip or of a LeRobot
    checkpoint, or ``ws://host:port``. Makers can be pickled, so that each worker process makes its own policy.

    Raises:
        QueryError: the text matches no kind of policy, or there is no such policy.
    """
    file = _file_of(text)
    import_module(f"{__name__}.{file}").maker(text)  # reports a wrong name before anything runs
    return partial(_made, file, text)


def environment_of(text: str) -> dict[str, Any]:
    """Return the environment options that a policy determines, such as its control; often there are none.

    Raises:
        QueryError: the text matches no kind of policy, or there is no such policy.
    """
    options: Callable[[str], dict[str, Any]] | None = getattr(
        import_module(f"{__name__}.{_file_of(text)}"), "environment", None
    )
    return {} if options is None else options(text)


def content_of(text: str) -> str:
    """Return a digest of the files that define a policy, or "" if there are none.

    For ``module:callable``, this is the file that defines the callable, without the files that the callable reads.

    Raises:
        QueryError: the text matches no kind of policy, or there is no such policy.
    """
    files: Callable[[str], list[Path]] | None = getattr(import_module(f"{__name__}.{_file_of(text)}"), "files", None)
    return "" if files is None else contents_digest(files(text))


def contents_digest(files: Sequence[Path]) -> str:
    """Return a digest of the names and contents of files in one folder, or "" if there are none.

    Raises:
        QueryError: a file cannot be read.
    """
    try:
        return files_digest(files, files[0].parent) if files else ""
    except OSError as error:
        raise QueryError(f"{error.filename}: cannot be read: {error.strerror}") from None


def _file_of(text: str) -> str:
    """Return the name of the module for a policy.

    Raises:
        QueryError: the text matches no kind of policy.
    """
    for is_kind, file in KINDS.values():
        if is_kind(text):
            return file
    kinds = ", ".join(
        [*BASELINES, "module:callable", "a Stable-Baselines3 .zip", "a folder of LeRobot", "ws://HOST:PORT"]
    )
    raise QueryError(f"policy {text!r:.200}: give one of {kinds}")


def _made(file: str, text: str, env: Environment) -> Policy:
    """Make a policy of a given kind in this process."""
    maker: PolicyMaker = import_module(f"{__name__}.{file}").maker(text)
    return maker(env)

"""A policy given as a Python callable, ``module:callable``, which is a function or a class."""

from __future__ import annotations

import inspect
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any

from prag_asp.errors import QueryError
from prag_asp.evaluation.policies.policy import Environment, PolicyMaker, seed_everything


class CallablePolicy:
    """A policy that calls a function of the observation, and of `info` if the function has such a parameter.

    If the callable has a method `begin`, it is called before each episode. A class is instantiated once, with the
    environment if its constructor has a parameter `env`.
    """

    def __init__(self, function: Callable[..., Any], env: Environment) -> None:
        if isinstance(function, type):
            function = function(env=env) if _takes(function, "env") else function()
        self._function, self._begin = function, getattr(function, "begin", None)
        self._informed = _takes(function, "info")

    def begin(self, seed: int) -> None:
        """Seed the global generators, and begin an episode."""
        seed_everything(seed)
        if self._begin is not None:
            self._begin()

    def __call__(self, observation: Any, info: Mapping[str, Any]) -> Any:
        """Return the next action."""
        return self._function(observation, info=info) if self._informed else self._function(observation)


def maker(text: str) -> PolicyMaker:
    """Return the maker of the policy ``module:callable``; the module may be in the current folder.

    Raises:
        QueryError: the module cannot be imported, or has no such callable.
    """
    return partial(CallablePolicy, imported(text, "policy"))


def files(text: str) -> list[Path]:
    """Return the file that defines the callable ``module:callable``, if there is one.

    Raises:
        QueryError: the module cannot be imported, or has no such callable.
    """
    return source_files(imported(text, "policy"))


def source_files(function: Callable[..., Any]) -> list[Path]:
    """Return the file that defines a function or a class, if there is one."""
    try:
        file = inspect.getsourcefile(inspect.unwrap(function))
    except TypeError:  # a builtin, or an object with a method `__call__`
        file = inspect.getsourcefile(type(function)) if type(function).__module__ != "builtins" else None
    return [Path(file)] if file is not None and Path(file).is_file() else []


def imported(text: str, what: str) -> Callable[..., Any]:
    """Return the callable ``module:callable``; the module may be in the current folder.

    Raises:
        QueryError: the module cannot be imported, or has no such callable; `what` states its purpose.
    """
    module, _, name = text.partition(":")
    with _current_folder():
        try:
            found: Any = import_module(module)
        except (Exception, SystemExit) as error:  # the module may raise anything
            reason = " ".join(f"{type(error).__name__}: {error}".split())
            raise QueryError(f"{what} {text}: {module} cannot be imported: {reason}; give MODULE:CALLABLE") from None
    for each in name.split("."):
        found = getattr(found, each, None)
    if not callable(found):
        raise QueryError(f"{what} {text}: {module} has no callable {name!r}; give MODULE:CALLABLE")
    function: Callable[..., Any] = found
    return function


def _takes(function: Callable[..., Any], name: str) -> bool:
    """Return whether a function has a parameter with a given name."""
    try:
        return name in inspect.signature(function).parameters
    except (TypeError, ValueError):
        return False


@contextmanager
def _current_folder() -> Iterator[None]:
    """Make modules in the current folder importable as well."""
    sys.path.insert(0, str(Path.cwd()))
    try:
        yield
    finally:
        sys.path.pop(0)

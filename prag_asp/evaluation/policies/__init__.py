"""Policies to evaluate, one module for each kind, and `load_policy`, which selects the kind by a text."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from importlib import import_module
from pathlib import Path

from prag_asp.errors import QueryError
from prag_asp.evaluation.policies.policy import Environment, Policy, PolicyMaker

BASELINES = ("oracle", "random", "zeros")
"""The built-in policies."""

KINDS: Mapping[str, tuple[Callable[[str], bool], str]] = {
    "a baseline": (BASELINES.__contains__, "baselines"),
    "a policy server": (lambda text: text.startswith(("ws://", "wss://")), "server"),
    "a Stable-Baselines3 zip": (lambda text: Path(text).suffix == ".zip", "stable_baselines"),
    "module:callable": (lambda text: ":" in text, "python_callable"),
}
"""Each kind of policy: a test of the text, and the module of this package whose function `maker` accepts the text."""


def load_policy(text: str) -> PolicyMaker:
    """Return the maker of a policy: a baseline, ``module:callable``, a Stable-Baselines3 zip, or ``ws://host:port``.

    Makers can be pickled: each worker process makes its own policy.

    Raises:
        QueryError: the text matches no kind of policy, or there is no such policy.
    """
    for is_kind, file in KINDS.values():
        if is_kind(text):
            maker = import_module(f"{__name__}.{file}").maker
            maker(text)  # report a wrong name before anything runs
            return partial(_made, file, text)
    kinds = ", ".join([*BASELINES, "module:callable", "a Stable-Baselines3 .zip", "ws://HOST:PORT"])
    raise QueryError(f"policy {text!r:.200}: give one of {kinds}")


def _made(file: str, text: str, env: Environment) -> Policy:
    """Make a policy of a kind in this process."""
    maker: PolicyMaker = import_module(f"{__name__}.{file}").maker(text)
    return maker(env)

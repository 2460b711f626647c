"""The checks that must pass before a change is merged, each in a separate environment."""

from __future__ import annotations

import nox

nox.options.sessions = ["lint", "docs", "tests"]
nox.options.error_on_missing_interpreters = False

LOGIC = ("program", "lint", "domain", "logic", "space")
"""The folders of tests that need neither physics nor documentation."""


@nox.session(python=["3.10", "3.11", "3.12", "3.13"])
def tests(session: nox.Session) -> None:
    """Run the whole suite."""
    session.install("-e", ".[test]")
    session.run("pytest", *session.posargs)


@nox.session
def logic(session: nox.Session) -> None:
    """Run the tests of logic and of task spaces."""
    session.install("-e", ".[test]")
    session.run("pytest", *(f"tests/{folder}" for folder in LOGIC), *session.posargs)


@nox.session
def fresh(session: nox.Session) -> None:
    """Run the random tests with fresh seeds and ten times the examples."""
    session.install("-e", ".[test]")
    session.run("pytest", "--fresh", *session.posargs)


@nox.session
def learning(session: nox.Session) -> None:
    """Run the tests of RL environments, including those that train policies and need PyTorch."""
    session.install("-e", ".[test,learning]")
    session.run("pytest", "tests/rl", *session.posargs)


@nox.session
def lint(session: nox.Session) -> None:
    """Check style and types."""
    session.install("-e", ".[test]")
    session.run("ruff", "check", ".")
    session.run("mypy")


@nox.session
def docs(session: nox.Session) -> None:
    """Build the documentation into site/, with warnings as errors."""
    session.install("-e", ".[docs]")
    session.run("mkdocs", "build", "--strict", env={"NO_MKDOCS_2_WARNING": "1"})

"""Load domains for the tests of pruning, with and without it."""

from __future__ import annotations

from dataclasses import replace

from prag_asp import Domain, DomainError, load_domain


def loaded(text: str, *rules: str) -> Domain | None:
    """Return the domain of a text, or None if it is refused."""
    try:
        return load_domain(text=text, rules=rules)
    except DomainError:
        return None


def unpruned(domain: Domain) -> Domain:
    """Return a domain whose steps try all actions and all values of fluents."""
    return replace(domain, facts=replace(domain.facts, unreachable=(), static=()))

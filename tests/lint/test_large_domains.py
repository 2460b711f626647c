"""What the user is told of domains that take long to prepare."""

from __future__ import annotations

import pytest

from prag_asp import load_domain
from prag_asp.lint import stages
from prag_asp.processes import progress_events


def test_many_fluents_and_actions_are_noted_with_their_rule(monkeypatch: pytest.MonkeyPatch) -> None:
    heard: list[str] = []
    monkeypatch.setattr(progress_events, "_listeners", [heard.append])
    text = "fluent(f(1..3)). action(a(1..4)).\npostcondition(a(X),f(1),true) :- action(a(X))."
    load_domain(text=text)
    assert not any("the domain has" in each for each in heard)
    monkeypatch.setattr(stages, "MANY", 3)
    load_domain(text=text)
    notes = [each for each in heard if "the domain has" in each]
    assert len(notes) == 1
    assert notes[0].startswith("note: <text>:1: the domain has 4 actions; the preparation of 3 actions takes")

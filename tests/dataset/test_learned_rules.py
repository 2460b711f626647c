"""What physics proves impossible, for Python users as for the command."""

from __future__ import annotations

from pathlib import Path

import pytest

from prag_asp import SceneError, TaskSpace, load_domain
from prag_asp.dataset import learn
from tests.commands import ok

WAREHOUSE = Path(__file__).parents[2] / "examples" / "warehouse"


def test_the_rules_are_those_that_the_command_prints_and_are_learned_again() -> None:
    learned = learn(load_domain(WAREHOUSE))
    told = ok("learn", str(WAREHOUSE), "--length", "2", "--count", "0")
    assert told.startswith(f"{learned.text}\n% {learned}\n")
    assert (len(learned.rules), learned.proofs) == (4, 10)
    assert all(rule in learned.text for rule in learned.rules)
    assert TaskSpace(learned.domain, 4).count() == 188
    again = learn(learned.domain)
    assert (again.rules, again.text) == (learned.rules, learned.text)
    assert again.domain.facts == learned.domain.facts


def test_a_domain_without_impossible_facts_stays_as_it_is_and_one_without_a_scene_is_refused() -> None:
    domain = load_domain("kitchen")
    learned = learn(domain)
    assert (learned.rules, str(learned), learned.domain) == ((), "0 rules from 0 proofs", domain)
    with pytest.raises(SceneError, match=r"has no \[scene\]"):
        learn(load_domain("hanoi"))

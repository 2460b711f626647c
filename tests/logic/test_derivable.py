"""Steps that can carry nothing but the state are ground at once."""

from __future__ import annotations

import pytest
from hypothesis import given, settings

from prag_asp import load_domain
from prag_asp.domain.load import Domain
from prag_asp.errors import DomainError
from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.logic.ground import ground_step
from tests.brute_force import Toy
from tests.chance import examples
from tests.strategies import toys


def step_of(domain: Domain, *, searched: bool) -> ground_step.GroundStep:
    """Return the ground step, with what steps carry along searched for in any case, or only where there may be some."""
    with pytest.MonkeyPatch.context() as patch:
        if searched:
            patch.setattr(ground_step, "_may_carry", lambda *_: True)
        return DomainLogic(domain).ground


@settings(max_examples=examples(30))
@given(toys(closed=False))
def test_a_step_is_the_same_whether_or_not_it_is_searched_for_what_it_carries(toy: Toy) -> None:
    try:
        domain = load_domain(text=toy.text())
    except DomainError:
        return
    assert step_of(domain, searched=False) == step_of(domain, searched=True)


CARRYING = "used(t) :- occurs(A,t). used(t) :- used(t-1). :- used(t-1), holds(f,true,t-1)."
NEVER = "used(t) :- never(A), occurs(A,t). used(t) :- used(t-1). :- used(t-1). #defined never/1."


@pytest.mark.parametrize(("rules", "searched"), [(CARRYING, True), (NEVER, False)], ids=["carrying", "never"])
def test_only_what_a_step_may_derive_is_searched_for(
    rules: str, searched: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = f"fluent(f). action(a). postcondition(a,f,true). initially(f,false).\n#program step(t).\n{rules}"
    domain = load_domain(text=text)
    expected = step_of(domain, searched=True)
    calls = []
    search = ground_step._add_carried
    monkeypatch.setattr(ground_step, "_add_carried", lambda *given: calls.append(given) or search(*given))
    assert DomainLogic(domain).ground == expected
    assert bool(calls) == searched

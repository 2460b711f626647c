"""What may ever be true is stated by domains, and is compared with what their own rules of a step make true."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis.strategies import booleans, sampled_from, sets

from prag_asp import Domain, DomainError, TaskSpace, load_domain
from tests.chance import examples

LAMPS = """#include "rules/closed_world.lp".
class(lamp). entity((a;b), lamp).
fluent(lit(L)) :- is_a(L,lamp).
fluent(wet(L)) :- is_a(L,lamp).
initially(lit(a), true).
action(touch(L)) :- is_a(L,lamp).
action(read(L)) :- is_a(L,lamp), ever(lit(L)).
precondition(read(L), lit(L), true) :- action(read(L)).
"""


def problems(rules: str, ever: str = '#include "rules/ever.lp".') -> list[str]:
    try:
        load_domain(text=f"{LAMPS}{ever}\n#program step(t).\n{rules}")
    except DomainError as error:
        return str(error).splitlines()
    return []


@pytest.mark.parametrize(
    "rules",
    [
        "holds(lit(L),true,t) :- occurs(touch(L),t). changed(lit(L),t) :- occurs(touch(L),t).",
        "holds(F,true,t) :- sets(F,t). changed(F,t) :- sets(F,t). sets(lit(L),t) :- occurs(touch(L),t).",
        "holds(lit(L),V,t) :- occurs(touch(L),t), _opposite(V,_). changed(lit(L),t) :- occurs(touch(L),t).",
        "changed(lit(L),t) :- occurs(touch(L),t).",
        "{ spark(L,t) : is_a(L,lamp) } :- occurs(touch(_),t). holds(lit(L),true,t) :- spark(L,t). "
        "changed(lit(L),t) :- spark(L,t).",
        "held(N+1,t) :- held(N,t-1), N < 3. held(0,t) :- occurs(touch(_),t). "
        "holds(lit(L),true,t) :- held(2,t), is_a(L,lamp). changed(lit(L),t) :- held(2,t), is_a(L,lamp).",
        "holds(lit(L),true,t) :- holds(wet(L),false,t-1), is_a(L,lamp). changed(lit(L),t) :- occurs(touch(L),t).",
        "holds(lit(L),true,t) :- t > 1, is_a(L,lamp). changed(lit(L),t) :- occurs(touch(L),t).",
    ],
)
def test_what_a_rule_may_make_true_is_asked_of_ever(rules: str) -> None:
    (line,) = problems(rules)
    assert "lit(b) true, but ever" in line or "leaves open whether lit(b) is true, but ever" in line
    assert line.endswith("state ever(lit(b))")
    assert not problems(rules, '#include "rules/ever.lp".\never(lit(L)) :- is_a(L,lamp).')
    assert not problems(rules, "ever(F) :- fluent(F).")


def test_fluents_that_nothing_asks_for_may_be_true_without_being_stated() -> None:
    wet = "initially(wet(b),true). ever(lit(a))."
    dries = (
        "holds(lit(L),true,t) :- holds(wet(L),true,t-1), occurs(touch(L),t). changed(lit(L),t) :- occurs(touch(L),t)."
    )
    (line,) = problems(dries, wet)
    assert line.endswith("state ever(lit(b))")
    assert counts(load_domain(text=f"{LAMPS}{wet} ever(lit(b)).\n#program step(t).\n{dries}"))[2] > 0


def counts(domain: Domain) -> list[int]:
    """Return the numbers of plans of lengths 0 to 3; the spaces share what is ground."""
    space = TaskSpace(domain, 3)
    return [space.at(length).count(by="plan") for length in range(4)]


@pytest.mark.parametrize(
    "rules",
    [
        "holds(lit(L),true,t) :- holds(lit(L),true,t-1), occurs(touch(L),t). "
        "holds(lit(L),false,t) :- dark(L,t). changed(lit(L),t) :- dark(L,t). dark(L,t) :- occurs(touch(L),t).",
        "holds(wet(L),true,t) :- occurs(touch(L),t). changed(wet(L),t) :- occurs(touch(L),t).",
        "holds(lit(L),true,t) :- bright(L,t). changed(lit(L),t) :- bright(L,t). changed(lit(L),t) :- dark(L,t). "
        "holds(lit(L),false,t) :- dark(L,t), not bright(L,t). "
        "dark(L,t) :- occurs(touch(L),t). bright(a,t) :- occurs(touch(a),t).",
        "holds(lit(L),false,t) :- occurs(touch(L),t). changed(lit(X),t) :- occurs(touch(X),t).",
        "holds(lit(L),true,t) :- occurs(touch(L),t), L != b. changed(lit(L),t) :- occurs(touch(L),t), L != b.",
        "holds(lit(L),true,t) :- occurs(touch(L),t), not bad(L). changed(lit(L),t) :- occurs(touch(L),t), not bad(L).",
        "#defined odd/1. holds(lit(L),true,t) :- odd(L), occurs(touch(L),t). changed(lit(L),t) :- odd(L), occurs(_,t).",
        "holds(lit(L),false,t) :- occurs(touch(L),t). changed(lit(L),t) :- is_a(L,lamp), occurs(touch(L),t).",
        "made(L,lit(L),t) :- occurs(touch(L),t), L = a. holds(F,true,t) :- made(_,F,t). changed(F,t) :- made(_,F,t).",
        "pile(on(L,S),t) :- pile(S,t-1), occurs(touch(L),t), L = a. holds(wet(L),true,t) :- pile(on(L,on(_,_)),t). "
        "changed(wet(L),t) :- pile(on(L,on(_,_)),t).",
    ],
)
def test_rules_that_cannot_make_it_true_are_not_reported(rules: str) -> None:
    start = "bad(b). pile(empty,0)."
    asking, whole = (
        f"{LAMPS}{start} {ever}\n#program step(t).\n{rules}"
        for ever in ('\n#include "rules/ever.lp".', "ever(F) :- fluent(F).")
    )
    assert counts(load_domain(text=asking)) == counts(load_domain(text=whole))


@pytest.mark.parametrize(
    ("rules", "message"),
    [
        (
            'holds(lit(L),false,t) :- kind(L,"Bad"), occurs(touch(L),t). '
            'changed(lit(L),t) :- kind(L,"Bad"), occurs(touch(L),t). '
            'changed(lit(L),t) :- kind(L,"Good"), occurs(touch(L),t).',
            "this rule leaves open whether lit(b) is true",
        ),
        (
            "holds(lit(L),true,t) :- occurs(touch(L),t), power(L). changed(lit(L),t) :- occurs(touch(L),t), power(L).",
            "this rule may make lit(b) true",
        ),
        (
            "occurs(read(L),t) :- occurs(touch(L),t-1), holds(lit(L),true,t-1). "
            "holds(lit(L),true,t) :- occurs(touch(L),t). changed(lit(L),t) :- occurs(touch(L),t).",
            "ever does not say that lit(b) may be true, but it may be so at some step",
        ),
        (
            "changed(lit(L),t) :- occurs(touch(L),t).\n#program step(k).\nholds(lit(L),false,k) :- occurs(touch(L),t).",
            "this rule leaves open whether lit(b) is true",
        ),
    ],
)
def test_what_is_not_known_may_be_so(rules: str, message: str) -> None:
    kinds = '1 { power(L) : is_a(L,lamp) } 1.\nkind(a,"Bad"). kind(b,"Good"). #include "rules/ever.lp".'
    (found,) = problems(rules, kinds)
    assert message in found


def test_a_constant_may_stand_for_any_fluent() -> None:
    asking = LAMPS.replace("ever(lit(L))", "ever(wanted)") + "#const wanted = wet(b).\n"
    rule = "holds(wet(b),true,t) :- occurs(touch(b),t). changed(wet(b),t) :- occurs(touch(b),t)."
    with pytest.raises(DomainError, match=r"this rule may make wet\(b\) true"):
        load_domain(text=f'{asking}#include "rules/ever.lp".\n#program step(t).\n{rule}')


RULES = [
    "sets(lit(L),t) :- occurs(touch(L),t).",
    "sets(wet(L),t) :- occurs(touch(L),t), not holds(wet(L),true,t-1).",
    "sets(lit(L),t) :- occurs(touch(M),t), next(M,L).",
    "sets(lit(L),t) :- holds(wet(L),true,t-1), occurs(read(_),t).",
    "sets(wet(L),t) :- holds(lit(M),true,t-1), next(M,L), occurs(touch(M),t).",
    "clears(lit(L),t) :- occurs(touch(L),t).",
    "clears(F,t) :- occurs(read(L),t), fluent(F), F != lit(L).",
    "sets(F,t) :- clears(F,t), holds(F,false,t-1).",
]
STATED = ["ever(lit(L)) :- next(_,L).", "ever(wet(L)) :- is_a(L,lamp).", "ever(lit(a)).", "initially(wet(b),true)."]
SETTING = """
#defined sets/2. #defined clears/2.
changed(F,t) :- sets(F,t).
changed(F,t) :- clears(F,t).
holds(F,true,t) :- sets(F,t).
holds(F,false,t) :- clears(F,t), not sets(F,t)."""


@settings(max_examples=examples(30))
@given(rules=sets(sampled_from(RULES), min_size=1, max_size=4), stated=sets(sampled_from(STATED)), general=booleans())
def test_no_plan_is_missing_where_nothing_is_reported(rules: set[str], stated: set[str], general: bool) -> None:
    lamps = LAMPS.replace("(a;b)", "(a;b;c)") + "next(a,b). next(b,c). #defined ever/1.\n"
    ever = " ".join([*sorted(stated), '#include "rules/ever.lp".' if general else "ever(lit(a))."])
    steps = "\n".join(["#program step(t).", *sorted(rules), SETTING])
    try:
        asking = load_domain(text=f"{lamps}{ever}\n{steps}")
    except DomainError as error:
        assert "ever" in str(error)
        return
    initial = " ".join(each for each in stated if each.startswith("initially"))
    whole = load_domain(text=f"{lamps}{initial} ever(F) :- fluent(F).\n{steps}")
    assert counts(asking) == counts(whole)


@pytest.mark.parametrize(
    ("more", "warned"),
    [
        ("", False),
        ("action(dry(L)) :- is_a(L,lamp), ever(wet(L)). initially(wet(b),true).", True),
        ("action(dry(L)) :- is_a(L,lamp), ever(wet(L)). % lint: allow asks-more\ninitially(wet(b),true).", False),
        ("action((dry(L);wipe(L))) :- is_a(L,lamp), ever(wet(L)). initially(wet(b),true).", True),
        ("action(dry(L)) :- is_a(L,lamp), ever(lit(L)), ever(wet(L)). initially(wet(a),true). "
         "implies(wet(L),lit(L)) :- is_a(L,lamp). precondition(dry(L),wet(L),true) :- action(dry(L)).", False),
        ("action(dry(L)) :- is_a(L,lamp), ever(lit(L)), ever(wet(L)). initially(wet(a),true). "
         "implies(lit(L),wet(L)) :- is_a(L,lamp). precondition(dry(L),wet(L),true) :- action(dry(L)).", True),
        ("action(dry(L)) :- is_a(L,lamp), ever(wet(L)). initially(wet(a),true). "
         "precondition(dry(L),wet(L),false) :- action(dry(L)).", True),
    ],
)  # fmt: skip
def test_an_action_that_asks_for_what_it_does_not_need_is_warned_of(more: str, *, warned: bool) -> None:
    domain = load_domain(text=f'{LAMPS}#include "rules/ever.lp".\n{more}')
    warnings = [each for each in domain.warnings if each.name == "asks-more"]
    assert len(warnings) == warned
    if warnings:
        assert "is derived only if" in warnings[0].text and "state precondition(" in warnings[0].text

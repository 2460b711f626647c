"""The reduction of a domain: which entities are alike, how many are needed, and what has all of them ground."""

from __future__ import annotations

from pathlib import Path

import pytest

from prag_asp import load_domain
from prag_asp.reduction import reduction as reduction_module
from prag_asp.reduction.reduction import Reduction
from tests.reduction.lifted import TRAPS
from tests.reduction.stacks import STACKS, cubes, reduction_of


@pytest.fixture(autouse=True)
def small_programs_are_large(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reduction_module, "MANY", 0)


@pytest.mark.parametrize(
    ("trap", "told"),
    [
        (TRAPS[2], "an aggregate or a condition"),
        (TRAPS[3], "an aggregate or a condition"),
        (TRAPS[4], "the order of their names"),
        (TRAPS[8], "a rule of a step"),
        (TRAPS[13], "the order of their names"),
        (TRAPS[14], "the order of their names"),
        (TRAPS[16], "an action has the name of one of them"),
        ("far(X) :- is_a(X,thing), not near(X). near(X) :- is_a(X,thing), not far(X).", "on itself through `not`"),
        ("{{ lucky(X) : is_a(X,thing) }}.", "a choice or an aggregate in a head"),
        ("alone(X) :- exclusive(X,X).", "exclusive/2 may depend on every entity"),
        ("fluent(h(@f(X))) :- is_a(X,thing).", "a function of a script"),
        ("late(Z) :- is_a(X,thing), is_a(Z,thing), -X < -Z.", "a minus sign turns names into other names"),
        ("precondition(a(X),g,true) :- action(a(X)), mark(-X).", "a minus sign turns names into other names"),
        ("action(e(-X)) :- is_a(X,thing).", "a minus sign turns names into other names"),
    ],
)
def test_a_rule_that_may_read_entities_that_no_plan_names_prevents_a_reduction(trap: str, told: str) -> None:
    rules = (
        "class(thing). fluent(p(X)) :- is_a(X,thing). action(a(X)) :- is_a(X,thing). action(d). fluent(g). mark(z)."
        "postcondition(a(X),p(X),true) :- action(a(X)). fluent(q(X)) :- is_a(X,thing)."
        f"postcondition(d,g,true). entity(({'; '.join(f'x{n}' for n in range(16))}), thing)."
    )
    found = reduction_of(f"{rules}\n{trap.format(things=16)}", fewest=16)
    assert isinstance(found, str) and told in found


@pytest.mark.parametrize(
    "more",
    [
        "heavy(c1).",
        "precondition(take(c1), held(c1), false).",
        "#const best = c1. mark(X) :- is_a(X,cube), X != best.",
        "near(c1,c1). initially(held(c1),false).",
        # A name with a minus is another name.
        "heavy(-c1).",
        "heavy(far(-c1)).",
        "heavy(-far(c1)). " + " ".join(f"heavy(far(c{n}))." for n in range(20)),
    ],
)
def test_a_distinguished_entity_is_always_ground(more: str) -> None:
    reduction = cubes(20, more).reduction
    assert isinstance(reduction, Reduction)
    assert [len(group) for group in reduction.groups] == [19] and "c1" not in map(str, reduction.groups[0])


def test_a_minus_before_a_number_makes_no_other_name() -> None:
    found = cubes(20, "late(N) :- level(N), N > -(2-1), N < -1+3. level(-1). level(0).").reduction
    assert isinstance(found, Reduction) and [len(group) for group in found.groups] == [20]


def test_entities_that_a_pattern_may_match_are_distinguished() -> None:
    rules = STACKS + "entity(cube(1..4), cube). entity(brick(1..16), cube)."
    alike = load_domain(text=rules).reduction
    assert isinstance(alike, Reduction) and [len(group) for group in alike.groups] == [20]
    looked_into = load_domain(text=f"{rules} right(C) :- is_a(C,cube), C = cube(N), N > 3.").reduction
    assert isinstance(looked_into, Reduction) and {each.name for each in looked_into.groups[0]} == {"brick"}


def test_settings_name_entities_as_they_are_written(tmp_path: Path) -> None:
    """One entity with an argument does not stand for all that are made of the same words."""
    path = tmp_path / "domain.toml"
    path.write_text("[weights]\n'c(29)' = 2\ntake = 7\nc = 3\n")
    domain = load_domain(text=f"entity((c(1..60); c), cube).\n{STACKS}", settings=path)
    assert domain.reduction
    ground = {str(entity) for entity in domain.reduction.facts.entities}
    assert {"c(29)", "c"} <= ground and "c(7)" not in ground and len(ground) < 20


def test_invariants_make_a_program_large(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.undo()
    lamps = "class(lamp). entity(lamp(1..300), lamp). fluent(lit(L)) :- is_a(L,lamp). action(light(L)) :- is_a(L,lamp)."
    effect = "postcondition(light(L),lit(L),true) :- is_a(L,lamp)."
    domain = load_domain(text=lamps + effect)
    assert domain.reduction is None and not domain.irreducible
    domain = load_domain(text=f"{lamps}{effect} exclusive(lit(L),lit(M)) :- is_a(L,lamp), is_a(M,lamp), L < M.")
    assert domain.reduction and domain.reduction.size > 300 * 299 / 2

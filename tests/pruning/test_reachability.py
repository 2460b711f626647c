"""What nothing ever makes possible is never tried: every count stays what it was, for every engine and level."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise, product
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from prag_asp import Domain, TaskSpace, explain, fewest_changes, load_domain
from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.program.paths import data_folder
from prag_asp.space.engines.engine import LEVELS, Level
from tests.brute_force import Action, Toy, term
from tests.chance import examples
from tests.pruning import loaded, unpruned
from tests.space.test_tasks import Schema, orbit, schemas
from tests.spaces import with_engines

ENGINES = ("automaton", "clingo", "sat")


def unreachable(text: str) -> list[str]:
    return [str(action) for action in load_domain(text=text).facts.unreachable]


def assert_plans_are_those_of_the_unpruned(domain: Domain) -> None:
    spaces = [space for each in (domain, unpruned(domain)) for space in with_engines(each, "automaton", "clingo")]
    for length in (1, 3):
        assert len({space.at(length).count("plan") for space in spaces}) == 1


@st.composite
def chains(draw: st.DrawFn, *, closed: bool) -> Toy:
    """Draw a domain whose actions need what others make, where little is so at the start."""
    fluents = draw(st.integers(3, 6))
    values = st.dictionaries(st.integers(0, fluents - 1), st.booleans(), min_size=1, max_size=3)
    effects = st.dictionaries(st.integers(0, fluents - 1), st.sampled_from([True, True, False, None]), max_size=2)
    actions = draw(st.lists(st.builds(Action, st.sampled_from("ab"), values, effects), min_size=2, max_size=6))
    pairs = st.lists(st.tuples(*[st.integers(0, fluents - 1)] * 2), max_size=2)
    numbers = st.just(range(fluents)) if closed else st.sets(st.integers(0, fluents - 1), min_size=fluents // 2)
    known = {fluent: draw(st.sampled_from([False, False, True])) for fluent in draw(numbers)}
    toy = Toy(fluents, tuple(actions), known, tuple(draw(pairs)), tuple(draw(pairs)))
    composites = draw(st.lists(st.lists(st.integers(0, len(actions) - 1), min_size=1, max_size=2), max_size=2))
    if not composites or draw(st.booleans()):
        return toy
    return replace(toy, composites=tuple(map(tuple, composites)), free=(0,))


@settings(max_examples=examples(50), suppress_health_check=list(HealthCheck))
@given(st.one_of(chains(closed=False), chains(closed=True)))
def test_random_chains_count_as_the_definition_says(toy: Toy) -> None:
    domain = loaded(toy.text())
    if domain is None:
        return
    never = set(map(str, domain.facts.unreachable))
    plans = [[tuple(term(toy, i) for i in plan) for plan in toy.plans(n)] for n in range(4)]
    assert not any(never.intersection(plan) for found in plans for plan in found)
    names = {tuple(action.partition("(")[0] for action in plan) for plan in plans[3]}
    spaces = [each.at(3) for each in with_engines(domain, *ENGINES)]
    for space in spaces if never else ():
        assert [space.count(level) for level in ("plan", "skeleton")] == [len(plans[3]), len(names)]
    assert set(spaces[0].enumerate("plan")) == set(plans[3])


@settings(max_examples=examples(20), suppress_health_check=list(HealthCheck))
@given(schemas())
def test_what_is_never_reached_tells_entities_apart_as_before(schema: Schema) -> None:
    domain = loaded(schema.text())
    if domain is None or not (domain.facts.unreachable or domain.facts.static):
        return
    groups = DomainLogic(unpruned(domain)).groups(3)
    assert DomainLogic(domain).groups(3) == groups
    plans = schema.plans(3)
    tasks = {orbit(plan, [tuple(map(str, group)) for group in groups]) for plan in plans}
    assert {space.at(3).count("task") for space in with_engines(domain, *ENGINES)} == {len(tasks)}


KEYS = """
room(1..5). fluent(in(R)) :- room(R). fluent(has(K)) :- room(K). fluent(open(R)) :- room(R).
initially(in(1),true). initially(has(1),true). #include "rules/closed_world.lp".
action(unlock(R)) :- room(R).       action(enter(R,S)) :- room(R), room(S), |R-S| = 1.  action(take(K)) :- room(K).
precondition(unlock(R),has(R),true) :- room(R). postcondition(unlock(R),open(R),true) :- room(R).
precondition(enter(R,S),in(R),true; enter(R,S),open(S),true)   :- action(enter(R,S)).
postcondition(enter(R,S),in(R),false; enter(R,S),in(S),true)   :- action(enter(R,S)).
precondition(take(K),in(K),true) :- room(K), K != 2.  precondition(take(2),in(1),true).
postcondition(take(K),has(K),true) :- room(K).
"""


def test_behind_a_door_whose_key_lies_behind_it_nothing_is_reached() -> None:
    never = {"enter(2,3)", "enter(3,2)", "enter(3,4)", "enter(4,3)", "enter(4,5)", "enter(5,4)"}
    locks = {"take(3)", "take(4)", "take(5)", "unlock(3)", "unlock(4)", "unlock(5)"}
    assert set(unreachable(KEYS)) == never | locks


def test_what_is_unknown_may_be_learned_either_way() -> None:
    text = KEYS.replace('#include "rules/closed_world.lp".', "")
    assert unreachable(text) == []
    shut = "".join(f"initially(open({room}),false). initially(has({room}),false). " for room in (3, 4, 5))
    assert unreachable(text + shut + "initially(in(3..5),false).") == unreachable(KEYS)


def test_a_negative_condition_is_reached_where_something_makes_it_false() -> None:
    text = """
    fluent(guarded; asleep; inside; rich). initially((guarded),true). initially((asleep;inside;rich),false).
    action(enter; sing; steal).
    precondition(enter,guarded,false). postcondition(enter,inside,true).
    precondition(sing,inside,true). postcondition(sing,guarded,false).
    precondition(steal,asleep,false). postcondition(steal,rich,true).
    """
    assert unreachable(text) == ["enter", "sing"]
    assert unreachable(text + "action(lure). precondition(lure,rich,true). postcondition(lure,guarded,unknown).") == []


def test_a_value_that_invariants_forbid_together_with_all_that_may_be_is_not_reached() -> None:
    text = """
    fluent(lit; warm; shut). initially((lit;warm),false). initially(shut,true). exclusive(lit,shut).
    action(light; bask; burn; wait). postcondition(light,lit,true). precondition(bask,lit,true).
    precondition(burn,warm,true). postcondition(burn,shut,false; burn,warm,true).
    """
    assert unreachable(text) == ["bask", "burn"]
    assert unreachable(text + "postcondition(wait,shut,unknown).") == ["burn"]


BEYOND = "enter(3,4) enter(4,3) enter(4,5) enter(5,4) take(4) take(5) unlock(4) unlock(5)"


@pytest.mark.parametrize(
    ("rules", "never"),
    [
        ("holds(open(3),true,t) :- occurs(enter(1,2),t). changed(open(3),t) :- occurs(enter(1,2),t).", BEYOND),
        ("holds(has(3),true,t) :- occurs(take(2),t), not holds(has(3),true,t-1). changed(has(3),t) :- #false.", BEYOND),
        ("gift(K,t) :- occurs(take(2),t), K = 3. holds(F,true,t) :- found(F,t). found(has(3),t) :- gift(3,t).", BEYOND),
        ("changed(open(R),t) :- occurs(take(2),t), room(R).", ""),
        ("holds(open(R),V,t) :- occurs(take(2),t), room(R), set(V).", ""),
        ("occurs(take(3),t) :- occurs(take(2),t-1).", ""),
    ],
)
def test_what_rules_over_time_make_is_reached(rules: str, never: str) -> None:
    text = f"{KEYS} set(true;false).\n#program step(t).\n{rules}"
    assert sorted(unreachable(text)) == never.split()
    assert_plans_are_those_of_the_unpruned(load_domain(text=text))


MADE = ("holds({F},{V},t)", "changed({F},t)", "sets({F},{V},t)", "now({F},t)")
READ = (
    "occurs({A},t)", "occurs({A},t-1)", "occurs(_,t)", "holds({F},{V},t-1)", "not holds({F},{V},t-1)",
    "_known({F},{V},t)", "now({F},t-1)", "not now({F},t-1)", "sets({F},{V},t-1)", "changed({F},t-1)",
)  # fmt: skip
SETS = """
#defined sets/3. #defined now/2.
holds(F,V,t) :- sets(F,V,t), _opposite(V,_).
changed(F,t) :- sets(F,_,t).
"""


@st.composite
def rules_over_time(draw: st.DrawFn, toy: Toy) -> str:
    """Draw rules that make states of a domain, some by predicates of their own."""
    fluents = st.integers(0, toy.fluents - 1).map(lambda f: f"f{f}")
    names = st.integers(0, len(toy.actions) - 1).map(lambda i: term(toy, i))

    def written(pattern: str) -> str:
        return pattern.format(F=draw(fluents), V=draw(st.sampled_from(["true", "false"])), A=draw(names))

    lines = []
    for _ in range(draw(st.integers(1, 4))):
        head, body = draw(st.sampled_from(MADE)), draw(st.lists(st.sampled_from(READ), min_size=1, max_size=3))
        lines.append(f"{written(head)} :- {', '.join(map(written, body))}.")
    return "\n".join(lines) + SETS


@settings(max_examples=examples(40), suppress_health_check=list(HealthCheck))
@given(st.one_of(chains(closed=False), chains(closed=True)), st.data())
def test_what_random_rules_over_time_make_is_reached(toy: Toy, data: st.DataObject) -> None:
    domain = loaded(toy.text() + data.draw(rules_over_time(toy)))
    if domain is None or not (domain.facts.unreachable or domain.facts.static):
        return
    assert_plans_are_those_of_the_unpruned(domain)


def test_states_that_are_made_at_a_step_by_its_number_keep_all_actions() -> None:
    assert unreachable(f"{KEYS} holds(open(3),true,2).") == []


@settings(max_examples=examples(10), suppress_health_check=list(HealthCheck))
@given(chains(closed=True).map(lambda toy: replace(toy, exclusive=(), implies=())))
def test_fluents_that_no_action_sets_are_ground_with_one_value_alone(toy: Toy) -> None:
    domain = loaded(toy.text())
    if domain is None or not domain.facts.static:
        return
    spaces = with_engines(domain, *ENGINES)
    for length in (1, 3):
        plans = {tuple(term(toy, i) for i in plan) for plan in toy.plans(length)}
        assert {space.at(length).count("plan") for space in spaces} == {len(plans)}
    pruned, whole = (TaskSpace(each, 3) for each in (domain, unpruned(domain)))
    assert [pruned.count(level) for level in LEVELS] == [whole.count(level) for level in LEVELS]
    assert list(pruned) == list(whole)


def test_a_state_has_no_value_that_nothing_makes() -> None:
    domain = load_domain(text=KEYS)
    static = {str(fluent): value for fluent, value in domain.facts.static}
    closed = {f"{name}({number})": "false" for name in ("open", "has", "in") for number in (3, 4, 5)}
    assert static == {**closed, "has(1)": "true"}
    before = set(map(str, DomainLogic(domain).ground.before))
    assert "holds(open(2),true)" in before and "holds(open(4),false)" in before
    assert "holds(open(4),true)" not in before
    rule = "holds(open(3),true,t) :- occurs(enter(1,2),t). changed(open(3),t) :- occurs(enter(1,2),t)."
    domain = load_domain(text=f"{KEYS}\n#program step(t).\n{rule}")
    still = {f"{name}({number})" for name in ("open", "has", "in") for number in (4, 5)} | {"has(1)"}
    assert {str(fluent) for fluent, _ in domain.facts.static} == still
    for more in ("holds(open(3),true,2).", "exclusive(has(4),has(5))."):
        assert not load_domain(text=f"{KEYS} {more}").facts.static


@pytest.mark.parametrize("level", ["plan", "task"])
def test_rules_may_count_the_actions_that_are_never_reached(level: Level) -> None:
    rule = "few :- #count{A : name(A,unlock)} < 5. some(A) :- mentions(A,1,_). #program step(t). :- few, occurs(_,t)."
    text = KEYS.replace("room(1..5).", "room(1..5). class(room). entity(R,room) :- room(R).") + rule
    assert unreachable(text) == unreachable(KEYS)
    domain = load_domain(text=text + ":- _pruned(unlock(4)), occurs(_,t).")
    assert domain.facts.unreachable == ()
    assert TaskSpace(domain, 3).count(level) == TaskSpace(load_domain(text=text), 3).count(level) > 0


def test_a_rule_over_time_that_only_reads_leaves_out_as_much_and_counts_the_same() -> None:
    text = KEYS + "#program step(t).\ntired(t) :- occurs(enter(_,_),t-1).\n:- occurs(enter(_,_),t), tired(t)."
    assert unreachable(text) == unreachable(KEYS)
    domain = load_domain(text=text)
    spaces = [space for each in (domain, unpruned(domain)) for space in with_engines(each, *ENGINES)]
    for length, level in product((2, 3), LEVELS):
        counts = {space.at(length).count(level) for space in spaces}
        assert len(counts) == 1
        assert counts.pop()


FREECELL = """
suit(hearts; spades). rank(1..4). entity(card(S,R),card) :- suit(S), rank(R). class(card).
place(C) :- entity(C,card). place(home(S)) :- suit(S). place(cell(1..2)). place(column(1..3)).
fluent(on(C,P)) :- entity(C,card), place(P), C != P. fluent(clear(P)) :- place(P).
below(card(S,R),card(T,R+1)) :- suit(S), suit(T), rank(R), rank(R+1), S != T.
below(card(S,R),cell(K)) :- suit(S), rank(R), place(cell(K)).
below(card(S,R),column(K)) :- suit(S), rank(R), place(column(K)).
below(card(S,1),home(S)) :- suit(S).  below(card(S,R+1),card(S,R)) :- suit(S), rank(R), rank(R+1).
dealt(card(hearts,1),column(1)). dealt(card(spades,3),card(hearts,1)). dealt(card(hearts,4),card(spades,3)).
dealt(card(spades,1),column(2)). dealt(card(hearts,2),card(spades,1)). dealt(card(spades,4),card(hearts,2)).
dealt(card(hearts,3),column(3)). dealt(card(spades,2),card(hearts,3)).
initially(on(C,P),true) :- dealt(C,P).   initially(clear(P),true) :- place(P), not dealt(_,P).
#include "rules/closed_world.lp".
action(move(C,P,Q)) :- fluent(on(C,P)), below(C,Q), P != Q.
precondition(move(C,P,Q),(on(C,P);clear(C);clear(Q)),true) :- action(move(C,P,Q)).
postcondition(move(C,P,Q),(on(C,P);clear(Q)),false; move(C,P,Q),(on(C,Q);clear(P)),true) :- action(move(C,P,Q)).
"""


def forward(domain: Domain, length: int) -> int:
    """Return the number of plans by a search that knows nothing of reachability."""
    facts = domain.facts
    start = frozenset(fluent for fluent, value in facts.initially if value == "true")
    states = {start: 1}
    for _ in range(length):
        following: dict[frozenset[object], int] = {}
        for (state, ways), action in product(states.items(), facts.actions):
            if all((fluent in state) == (value == "true") for fluent, value in facts.preconditions[action]):
                after = set(state)
                for fluent, value in facts.postconditions[action]:
                    (after.add if value == "true" else after.discard)(fluent)
                following[frozenset(after)] = following.get(frozenset(after), 0) + ways
        states = following  # type: ignore[assignment]
    return sum(states.values())


def test_of_a_card_game_only_what_can_be_played_is_tried() -> None:
    domain = load_domain(text=FREECELL)
    assert len(domain.facts.unreachable) > len(domain.facts.tried) > 20
    automaton, clingo = with_engines(domain, "automaton", "clingo")
    for length in (1, 3, 4):
        assert automaton.at(length).count("plan") == forward(domain, length) > 0
    assert clingo.at(3).count("plan") == forward(domain, 3)
    assert automaton.at(4).count("task") == forward(domain, 4)


def test_entities_that_only_unreached_actions_tell_apart_stay_apart() -> None:
    text = """
    class(box). entity((red;blue;green),box). fluent(held(B)) :- entity(B,box). fluent(key). initially(key,false).
    #include "rules/closed_world.lp". action(take(B); drop(B)) :- entity(B,box).
    precondition(take(B),held(B),false) :- entity(B,box). postcondition(take(B),held(B),true) :- entity(B,box).
    precondition(drop(B),held(B),true) :- entity(B,box). postcondition(drop(B),held(B),false) :- entity(B,box).
    action(paint(red); find). precondition(paint(red),key,true; find,key,true). postcondition(find,key,true).
    postcondition(paint(red),held(red),true).
    """
    domain = load_domain(text=text)
    assert [str(action) for action in domain.facts.unreachable] == ["find", "paint(red)"]
    assert [[str(each) for each in group] for group in DomainLogic(domain).groups(2)] == [["blue", "green"]]
    spaces = with_engines(domain, *ENGINES)
    assert {space.at(1).count("task") for space in spaces} == {2}
    assert {space.at(2).count("task") for space in spaces} == {5}


def test_what_is_never_reached_may_be_asked_for_and_is_explained() -> None:
    domain = load_domain(text=KEYS)
    for engine in ENGINES:
        space = TaskSpace(domain, 2, engine=engine)
        assert space.count("plan", prefix=["unlock(3)"]) == space.where("has unlock(4)").count("plan") == 0
        assert space.count("plan", prefix=["unlock"]) > 0
        assert space.where("lacks unlock(4)").count("plan") == space.count("plan")
    found = explain(domain, ["take(2)", "unlock(3)"])
    assert found is not None
    assert found.reasons == ("it needs has(3) to be true, but that has been false from the start",)
    assert [str(task) for task in TaskSpace(domain, 1).sample(1, seed=1, weights={"unlock(3)": 5, "enter": 0})]


def test_a_domain_in_which_nothing_is_reached_has_no_plan_and_no_refusal() -> None:
    text = """
    fluent(chicken; egg). initially((chicken;egg),false). action(lay; hatch).
    precondition(lay,chicken,true; hatch,egg,true). postcondition(lay,egg,true; hatch,chicken,true).
    """
    assert unreachable(text) == []
    domain = load_domain(text=text)
    assert [TaskSpace(domain, n, engine=engine).count() for n in (0, 1) for engine in ENGINES] == [1] * 3 + [0] * 3
    assert [(each.line, each.name) for each in domain.warnings] == [(2, "no-plan")]
    assert "hatch and all others wait for each other" in domain.warnings[0].text


def test_encodings_without_the_relaxed_program_try_all(tmp_path: Path) -> None:
    for source in data_folder("encodings").rglob("*.lp"):
        copy = tmp_path / source.relative_to(data_folder("encodings"))
        copy.parent.mkdir(exist_ok=True)
        if source.name != "reachable.lp":
            copy.write_bytes(source.read_bytes())
    domain = load_domain(text=KEYS, encodings=tmp_path)
    assert domain.facts.unreachable == ()
    assert TaskSpace(domain, 4).count() == TaskSpace(load_domain(text=KEYS), 4).count() > 0


@pytest.mark.slow
def test_a_thousand_actions_that_are_reached_one_after_the_other_are_all_kept() -> None:
    steps = 1000
    lines = ["fluent(at(0..1000)). initially(at(0),true).", '#include "rules/closed_world.lp".']
    lines += [
        f"action(go({b})). precondition(go({b}),at({a}),true). postcondition(go({b}),at({b}),true)."
        for a, b in pairwise(range(steps + 1))
    ]
    assert unreachable("\n".join(lines)) == []
    assert len(unreachable("\n".join(lines).replace("(go(2),at(1),", f"(go(2),at({steps}),"))) == steps - 1


def test_the_lines_that_keep_an_action_from_being_reached_are_named() -> None:
    text = """
    fluent(chicken; egg). initially((chicken;egg),false). action(lay; hatch; wait).
    precondition(lay,chicken,true). precondition(hatch,egg,true).
    postcondition(lay,egg,true). postcondition(hatch,chicken,true).
    """
    domain = load_domain(text=text)
    assert [str(each) for each in domain.facts.unreachable] == ["hatch", "lay"]
    changes = fewest_changes(TaskSpace(domain, 1), action="lay")
    assert [line.line for (line,) in changes] == [2, 3]

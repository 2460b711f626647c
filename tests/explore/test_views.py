"""The views of a page show the numbers of the commands, and each view is a link."""

from __future__ import annotations

import shlex
from dataclasses import asdict, replace

import pytest

from prag_asp import Condition, PragError, QueryError, TaskSpace, load_domain
from prag_asp.explore.comparison_view import comparison_view
from prag_asp.explore.empty_view import empty_view
from prag_asp.explore.explored_domain import ExploredDomain
from prag_asp.explore.facets_view import facets_view, fact_orbits
from prag_asp.explore.jumps import to_rank, to_sample
from prag_asp.explore.page_state import PageState, parse_query
from prag_asp.explore.plan_view import count_view, plan_view, share
from prag_asp.explore.vocabulary_view import vocabulary_view
from tests.chance import Chance
from tests.commands import ok

CONDITIONS = {
    "blocks": ("has at least 2 pick_up", "uses b", "nontrivial", "ends on(a,b)"),
    "two_arms": ("uses bar_1", "lacks give", "nontrivial"),
}


def explored(name: str) -> ExploredDomain:
    return ExploredDomain(load_domain(name), (name,), f"load_domain({name!r})")


@pytest.fixture(scope="module")
def domains() -> dict[str, ExploredDomain]:
    return {name: explored(name) for name in CONDITIONS}


@pytest.mark.parametrize(("name", "length"), [("blocks", 4), ("two_arms", 3)])
def test_a_random_walk_shows_the_numbers_of_counts(
    domains: dict[str, ExploredDomain], name: str, length: int, chance: Chance
) -> None:
    random, domain = chance.generator(1), domains[name]
    for _ in range(chance.examples(2)):
        where = tuple(random.sample(CONDITIONS[name], random.randrange(2)))
        state = PageState(length, where, by=random.choice(["task", "plan"]))
        space = domain.space(length).where(*where)
        while True:
            view = plan_view(domain, state)
            assert parse_query(view.query) == state
            assert view.count == str(space.count(state.by, state.chosen))
            assert view.total == str(space.count(state.by))
            assert sum(int(each.count) for each in view.actions) == (int(view.count) if view.actions else 0)
            words = list(space.enumerate(state.by))
            if view.count != "0":
                assert words[int(view.first_rank)][: len(state.chosen)] == state.chosen
            if not view.actions:
                break
            chosen = random.choice(view.actions)
            assert chosen.count == str(space.count(state.by, [*state.chosen, chosen.action]))
            assert words[int(chosen.first_rank)][len(state.chosen)] == chosen.action
            state = parse_query(chosen.query)
        assert count_view(domain, state).count == view.count


@pytest.mark.parametrize(("name", "by"), [("blocks", "task"), ("two_arms", "plan")])
def test_a_facet_leaves_what_its_conditions_leave(
    domains: dict[str, ExploredDomain], name: str, by: str, chance: Chance
) -> None:
    random, domain = chance.generator(2), domains[name]
    state = parse_query(f"length=3&by={by}")
    first = plan_view(domain, state)
    state = parse_query(random.choice(first.actions).query)
    view = facets_view(domain, state)
    assert view.count == plan_view(domain, state).count
    for facet in random.sample(view.facets, 1):
        for condition, left in ((facet.choose, facet.chosen), (facet.exclude, facet.excluded)):
            assert count_view(domain, replace(state, where=(condition,))).count == left, condition


def test_facts_that_renamings_exchange_are_one_facet() -> None:
    space = TaskSpace(load_domain("blocks"), 3)
    orbits = fact_orbits(space.domain.facts.fluents, space.symmetries)
    assert ("clear(a)", "clear(b)", "clear(c)", "clear(d)") in orbits
    assert {len(orbit) for orbit in orbits if orbit[0].startswith("on(")} == {12}
    assert sorted(fact for orbit in orbits for fact in orbit) == sorted(map(str, space.domain.facts.fluents))


def test_two_conditions_and_their_overlap_are_counted_alike(domains: dict[str, ExploredDomain]) -> None:
    blocks, length = domains["blocks"], 4
    view = comparison_view(blocks, PageState(length, ("has at least 2 pick_up",), beside=("nontrivial",)))
    space = TaskSpace(blocks.domain, length)
    both = space.where("has at least 2 pick_up", "nontrivial").count()
    assert (view.level, view.both) == ("task", str(both))
    assert view.first.only == str(space.where("has at least 2 pick_up").count() - both)
    apart = comparison_view(blocks, PageState(length, ("uses a",), beside=("uses b",)))
    assert (apart.level, apart.distinguishes) == ("plan", True)
    plans = list(space.enumerate("plan"))
    using = {block: {plan for plan in plans if any(block in a.partition("(")[2] for a in plan)} for block in "ab"}
    one, other = using["a"], using["b"]
    assert (apart.first.count, apart.second.count) == (str(len(one)), str(len(other)))
    assert (apart.both, apart.either, apart.all) == (str(len(one & other)), str(len(one | other)), str(len(plans)))


def test_jumps_lead_to_tasks_of_the_commands(domains: dict[str, ExploredDomain]) -> None:
    domain, state = domains["two_arms"], PageState(4)
    space = TaskSpace(domain.domain, 4)
    assert parse_query(to_rank(domain, state, "-1").query).chosen == space.plan_at(space.count() - 1)
    begun = parse_query(plan_view(domain, state).actions[0].query)
    jump = to_sample(domain, begun, 7, weighted=False)
    found = parse_query(jump.query)
    assert found.chosen[:1] == begun.chosen
    assert found.chosen in space
    assert ok(*shlex.split(jump.same.shell)[1:]).strip() == " ".join(found.chosen)
    for text in ("", "x", "10000000"):
        with pytest.raises(QueryError, match="rank"):
            to_rank(domain, state, text)


def test_an_empty_view_has_the_reasons_of_explain(domains: dict[str, ExploredDomain]) -> None:
    state = PageState(3, ("lacks pick_up",))
    view = empty_view(domains["blocks"], state)
    assert view.empty
    assert view.conditions == ("has exactly 0 pick_up",)
    assert view.lines
    assert not empty_view(domains["blocks"], PageState(3)).empty
    assert plan_view(domains["blocks"], state).actions == ()


def test_the_states_beside_a_plan_mark_what_changed(domains: dict[str, ExploredDomain]) -> None:
    view = plan_view(domains["blocks"], PageState(4, chosen=("pick_up(a)",)))
    assert view.steps[1].changed == ("holding(a)",)
    assert view.steps[1].undone == ("clear(a)", "hand_empty", "on_table(a)")


def test_chosen_actions_get_canonical_names(domains: dict[str, ExploredDomain]) -> None:
    view = plan_view(domains["blocks"], PageState(4, chosen=("pick_up(c)",)))
    assert parse_query(view.query).chosen == ("pick_up(a)",)
    plans = plan_view(domains["blocks"], PageState(4, chosen=("pick_up(c)",), by="plan"))
    assert parse_query(plans.query).chosen == ("pick_up(c)",)


def test_composites_are_trees() -> None:
    kitchen = explored("kitchen")
    task = TaskSpace(kitchen.domain, 5)[0]
    whole = plan_view(kitchen, PageState(5, chosen=tuple(map(str, task.actions)))).tree
    assert whole is not None and whole.unfinished == ()
    chosen = ("open(panda,cupboard_1)", "approach(panda,cup_1,cupboard_1)")
    begun = plan_view(kitchen, PageState(7, chosen=chosen)).tree
    assert begun is not None and begun.unfinished == chosen[1:]
    assert plan_view(kitchen, PageState(0)).tree is not None


@pytest.mark.parametrize(
    ("query", "problem"),
    [
        ("", "one length"),
        ("length=-1", "number from 0"),
        ("length=10001", "at most 10,000"),
        ("length=2&by=word", "choose task or plan"),
        ("length=2&color=red", "no field of a link"),
        ("length=1&do=pick_up(a)&do=put_down(a)", "undo some"),
        ("length=1&do=pick_up", "choose an action with its arguments"),
        ("length=1&do=pick_up(z)", "pick_up"),
        ("length=1&where=usess", "did you mean uses"),
        (f"length=1{'&where=uses+a' * 600}", "more than 500 fields"),
    ],
)
def test_wrong_links_get_one_line(domains: dict[str, ExploredDomain], query: str, problem: str) -> None:
    with pytest.raises(PragError, match=problem) as error:
        plan_view(domains["blocks"], parse_query(query))
    assert len(error.value.lines) == 1


def test_length_zero_has_one_task_and_no_action(domains: dict[str, ExploredDomain]) -> None:
    view = plan_view(domains["blocks"], PageState(0))
    assert (view.total, view.count, view.actions) == ("1", "1", ())
    assert facets_view(domains["blocks"], PageState(0)).count == "1"


def test_the_vocabulary_composes_conditions(domains: dict[str, ExploredDomain]) -> None:
    found = vocabulary_view(domains["blocks"])
    assert found.names == ("pick_up", "put_down", "stack", "unstack")
    for keyword in found.whole:
        assert Condition.parse(keyword)
    assert "counts" not in asdict(found)


def test_only_exact_shares_are_whole() -> None:
    assert [share(*pair) for pair in ((0, 7), (7, 7), (0, 0), (1, 10**7), (10**7 - 1, 10**7), (1, 8))] == [
        "0",
        "1",
        "0",
        "0.000000",
        "1.000000",
        "0.125000",
    ]

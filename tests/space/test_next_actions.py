"""The numbers of next actions and of final states are those of listed tasks, of counts and of conditions."""

from __future__ import annotations

from collections import Counter
from itertools import product
from typing import Any

import pytest

from prag_asp import QueryError, TaskSpace, load_domain, parse_atom
from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.space.engines import LEVELS
from prag_asp.space.engines.automaton_engine import AutomatonEngine
from tests.chance import Chance
from tests.spaces import with_engine

CASES = [("blocks", 4), ("hanoi", 4), ("prag", 3), ("two_arms", 5)]


@pytest.mark.parametrize(
    ("engine", "by"), [*product(("auto", "symbolic"), LEVELS), ("clingo", "task"), ("sat", "task")]
)
def test_the_numbers_of_next_actions_are_those_of_listed_words(engine: str, by: Any) -> None:
    space = with_engine(TaskSpace(load_domain("blocks"), 3), engine)
    words = list(space.enumerate(by))
    for prefix in {word[:size] for word in words[::3] for size in range(4)}:
        after = Counter(word[len(prefix)] for word in words if word[: len(prefix)] == prefix and len(prefix) < 3)
        found = space.next_actions(prefix, by)
        assert found == after, prefix
        assert list(found) == [letter for letter in space.action_texts(by) if letter in after]


@pytest.mark.parametrize("few", [0, 10**6])
@pytest.mark.parametrize(("domain", "length"), CASES)
def test_the_numbers_of_next_actions_and_of_ends_are_counts(
    domain: str, length: int, few: int, chance: Chance, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("prag_asp.space.final_states.FEW_TASKS", few)
    space, random = TaskSpace(load_domain(domain), length), chance.generator(1)
    facts = list(map(str, space.domain.facts.fluents))
    groups = [[fact] for fact in random.sample(facts, 2)] + [random.sample(facts, 2)]
    words = list(space.enumerate("plan", random.choice(list(space.enumerate("plan")))[:1]))
    for word in random.sample(words, 2):
        prefix = word[: random.randrange(1, length + 1)]
        assert sum(space.next_actions(prefix, "plan").values()) == (
            space.count("plan", prefix) if len(prefix) < length else 0
        )
        states = [task.states[-1] for task in space.tasks_of_plans(w for w in words if w[: len(prefix)] == prefix)]
        for group, ending in zip(groups, space.ending(groups, prefix, "plan"), strict=True):
            atoms = [parse_atom(fact) for fact in group]
            assert ending is not None
            assert ending.holding == sum(any(state.get(atom) for atom in atoms) for state in states)
            assert ending.possible == sum(any(state.get(atom, True) for atom in atoms) for state in states)
            assert ending.possible == space.where(f"ends {' or '.join(group)}").count("plan", prefix)


@pytest.mark.parametrize("merge", [False, True])
@pytest.mark.parametrize("domain", ["blocks", "two_arms"])
def test_merged_states_give_the_same_next_actions(domain: str, merge: bool) -> None:
    engine = AutomatonEngine(DomainLogic(load_domain(domain)), "plan", merge=merge)
    words = list(engine.words(4))
    for prefix in {word[:size] for word in words[::17] for size in range(4)}:
        assert engine.following(4, prefix) == Counter(
            word[len(prefix)] for word in words if word[: len(prefix)] == prefix
        )


def test_the_numbers_after_names_are_sums_over_their_actions() -> None:
    space = TaskSpace(load_domain("prag"), 3)
    found = space.next_actions(["approach", "grasp"])
    assert sum(found.values()) == space.count(prefix=["approach", "grasp"])
    (after,) = space.ending([["open(panda)"]], ["approach", "grasp"])
    listed = [task for task in space if task.skeleton[:2] == ("approach", "grasp")]
    assert after is not None
    assert after.holding == sum(task.states[-1].get(parse_atom("open(panda)"), False) for task in listed)


def test_large_numbers_of_ends_are_exact() -> None:
    space = TaskSpace(load_domain("hanoi"), 60)
    fact = str(space.domain.facts.fluents[0])
    (ending,) = space.ending([[fact]], by="plan")
    assert ending is not None
    assert ending.possible == space.where(f"ends {fact}").count("plan") > 2**64


def test_all_ends_of_few_tasks_are_counted_where_those_of_the_space_take_too_many_states(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    for limit in ("FEW_EDGES", "MANY_EDGES"):
        monkeypatch.setattr(f"prag_asp.space.final_states.{limit}", 5)
    space = TaskSpace(load_domain("tabletop"), 3)
    facts = [[str(fluent)] for fluent in space.domain.facts.fluents]
    assert set(space.ending(facts)) == {None}
    task = space[1234]
    for (fact,), ending in zip(facts, space.ending(facts, list(map(str, task.actions))), strict=True):
        value = task.states[-1].get(parse_atom(fact))
        assert ending is not None
        assert (ending.holding, ending.possible) == (int(value is True), int(value is not False))


def test_wrong_questions_about_ends_are_refused() -> None:
    space = TaskSpace(load_domain("blocks"), 2)
    with pytest.raises(QueryError, match=r"did you mean clear\(a\)"):
        space.ending([["claer(a)"]])
    with pytest.raises(QueryError, match="skeletons have no final states"):
        space.ending([["clear(a)"]], by="skeleton")
    with pytest.raises(QueryError, match="choose one"):
        TaskSpace(load_domain("blocks"), "2..3").next_actions()


def test_the_tasks_of_a_condition_on_whole_plans_have_their_own_ends() -> None:
    space = TaskSpace(load_domain("blocks"), 4).where("shortest")
    tasks = list(space)
    assert space.next_actions() == Counter(str(task.actions[0]) for task in tasks)
    (ending,) = space.ending([["hand_empty"]])
    assert ending is not None
    assert ending.holding == sum(task.states[-1][parse_atom("hand_empty")] for task in tasks)

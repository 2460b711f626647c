"""Courses through task spaces: what they draw, with which exact probability, and what they never draw."""

from __future__ import annotations

import json
import math
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from pathlib import Path

import pytest

from prag_asp import Task, TaskSpace, load_domain
from prag_asp.atom import Atom
from prag_asp.errors import QueryError
from prag_asp.rl import AdaptiveCurriculum, BanditCurriculum, LengthCurriculum, NoveltyCurriculum, ReverseCurriculum
from prag_asp.rl.curriculum.task_pool import Proposal, RankedPart, TaskPool, Word, sample_index
from prag_asp.rl.curriculum.task_sampler import (
    Attempt,
    DomainWeightsSampler,
    EpisodeResult,
    TaskCurriculum,
    TaskSampler,
)
from tests.chance import Chance

KINDS: Sequence[TaskCurriculum] = (
    LengthCurriculum(window=4),
    *(NoveltyCurriculum(what) for what in ("tasks", "skeletons", "names", "pairs")),
    AdaptiveCurriculum(lot=8),
    BanditCurriculum(lot=8),
)
NAMES = [str(kind) for kind in KINDS]


@pytest.fixture(scope="module")
def space() -> TaskSpace:
    return TaskSpace(load_domain("prag"), length=2)


@pytest.fixture(scope="module")
def parts(space: TaskSpace) -> Sequence[tuple[TaskPool, set[str]]]:
    """Parts for training, each with the tasks that it has."""
    split = space.split({"train": "1/3", "test": "2/3"}, seed=1)["train"]
    held, _ = space.hold_out("can")
    skeletons = space.split_skeletons({"train": "3/4", "test": "1/4"}, seed=1)["train"]
    found = [TaskPool(space, RankedPart(split, space)), TaskPool(held), TaskPool(skeletons)]
    return [(pool, set(map(str, tasks))) for pool, tasks in zip(found, (split, held, skeletons), strict=True)]


@pytest.fixture(scope="module")
def tasks(space: TaskSpace) -> dict[Word, Task]:
    return {tuple(map(str, task.actions)): task for task in space}


def names(word: Iterable[str]) -> list[str]:
    return [action.split("(")[0] for action in word]


def pairs(word: Iterable[str]) -> set[str]:
    return {">".join(pair) for pair in pairwise(names(word))}


def lived(course: TaskSampler, space: TaskSpace, episodes: int, good: Callable[[int], bool]) -> list[Proposal]:
    """Return what a course offers while episodes end as `good` says; every fifth task is not feasible."""
    found, pool = [], TaskPool(space)
    for number in range(episodes):
        offer = course.propose()
        found.append(offer)
        course.note_feasibility(offer.word, number % 5 > 0)
        if number % 5:
            actions = pool.task(offer).actions
            attempts = [
                Attempt(action, actions[i - 1] if i else None, good(number)) for i, action in enumerate(actions)
            ]
            course.update(EpisodeResult(len(actions), 0, attempts, good(number)))
    return found


@pytest.mark.parametrize("kind", KINDS, ids=NAMES)
def test_a_course_that_is_resumed_goes_on_as_it_would_have(kind: TaskCurriculum, space: TaskSpace) -> None:
    one, two = kind.task_sampler(TaskPool(space)), kind.task_sampler(TaskPool(space))
    one.seed(5)
    first = lived(one, space, 20, lambda number: number % 2 > 0)
    two.load_state_dict(json.loads(json.dumps(one.state_dict())))
    after = lived(one, space, 10, lambda number: True)
    assert lived(two, space, 10, lambda number: True) == after and one.state_dict() == two.state_dict()
    two.seed(5)
    assert lived(two, space, 20, lambda number: number % 2 > 0) == first
    two.seed(6)
    assert lived(two, space, 20, lambda number: number % 2 > 0) != first


@pytest.mark.parametrize("kind", KINDS, ids=NAMES)
def test_what_is_held_out_is_never_drawn(
    kind: TaskCurriculum, parts: Sequence[tuple[TaskPool, set[str]]], tasks: dict[Word, Task]
) -> None:
    for pool, allowed in parts:
        assert 0 < len(allowed) < len(tasks)
        offers = lived(kind.task_sampler(pool), pool.space, 12, lambda number: number % 3 > 0)
        assert all(str(pool.task(offer)) in allowed for offer in offers)


def test_probabilities_are_those_of_a_brute_force(space: TaskSpace, tasks: dict[Word, Task]) -> None:
    pool, count = TaskPool(space), len(tasks)
    assert {offer.probability for offer in lived(DomainWeightsSampler(pool), space, 20, bool)} == {Fraction(1, count)}
    order = lived(NoveltyCurriculum("tasks").task_sampler(pool), space, count + 1, bool)
    assert {offer.word for offer in order[:-1]} == set(tasks)
    assert [offer.probability for offer in order] == [Fraction(1, count - i) for i in range(count)] + [
        Fraction(1, count)
    ]
    skeletons = Counter(tuple(names(word)) for word in tasks)
    each = lived(NoveltyCurriculum("skeletons").task_sampler(pool), space, len(skeletons), bool)
    assert {tuple(names(offer.word)) for offer in each} == set(skeletons)
    for i, offer in enumerate(each):
        shape = tuple(names(offer.word))
        assert offer.probability == Fraction(1, (len(skeletons) - i) * skeletons[shape])


@pytest.mark.parametrize("what", ["names", "pairs"])
def test_every_draw_has_something_that_is_due_as_probably_as_it_should(
    what: str, space: TaskSpace, tasks: dict[Word, Task]
) -> None:
    have = {word: pairs(word) if what == "pairs" else set(names(word)) for word in tasks}
    every = set().union(*have.values())
    course = NoveltyCurriculum(what).task_sampler(TaskPool(space))  # type: ignore[arg-type]
    course.seed(2)
    due: set[str] = set(every)
    for _ in range(12):
        offer = course.propose()
        course.note_feasibility(offer.word, True)
        having = sum(not has.isdisjoint(due) for has in have.values())
        assert not have[offer.word].isdisjoint(due) and offer.probability == Fraction(1, having)
        due = due - have[offer.word] or set(every)
        assert course.summary() == {"due": len(due), "of": len(every)}


def test_what_is_rare_and_due_is_weighed_up_and_still_exact() -> None:
    space = TaskSpace(load_domain("prag"), length=4)
    all_words = list(space.enumerate())
    course = NoveltyCurriculum("pairs").task_sampler(TaskPool(space))
    counts = Counter(pair for word in all_words for pair in pairs(word))
    rarest = min(counts, key=lambda pair: (counts[pair], pair))
    assert counts[rarest] < len(all_words) / 100, "it is not rare"
    course.load_state_dict({**course.state_dict(), "due": [rarest]})
    weights = {word: 64 ** sum(">".join(pair) == rarest for pair in pairwise(names(word))) for word in all_words}
    due = {word: weight for word, weight in weights.items() if rarest in pairs(word)}
    assert sum(due.values()) * 2 >= sum(weights.values()), "one step is enough"
    for _ in range(5):
        offer = course.propose()
        assert offer.probability == Fraction(due[offer.word], sum(due.values()))
    for _ in range(20):
        course.note_feasibility(offer.word, False)
    assert course.summary()["due"] == len(counts), "after so many infeasible ones it is given up"


def test_a_rare_name_that_is_also_that_of_a_class_is_waited_for(tmp_path: Path) -> None:
    program = "class(ball). entity(red,ball). fluent(on). action(ball). action(hit). action(rest(1..98))."
    (tmp_path / "domain.lp").write_text(f"{program} postcondition(ball,on,true). postcondition(hit,on,false).")
    course = NoveltyCurriculum("names").task_sampler(TaskPool(TaskSpace(load_domain(tmp_path), length=1)))
    drawn = []
    for _ in range(3):
        drawn += course.propose().word
        course.note_feasibility((drawn[-1],), True)
    assert set(names(drawn)) == {"ball", "hit", "rest"} and course.summary() == {"due": 3, "of": 3}
    course.load_state_dict({**course.state_dict(), "due": ["ball"]})
    assert [course.propose() for _ in range(2)] == [Proposal(("ball",), Fraction(1))] * 2, "it is the only one"
    course.load_state_dict({**course.state_dict(), "due": ["ball", "hit"]})
    assert course.propose() == Proposal(("hit",), Fraction(64**2, 64**2 + 1)), "what has a weight is weighed up"


def test_lengths_come_one_after_another_with_their_shares() -> None:
    spaces = TaskSpace(load_domain("prag"), range(1, 4))
    course = LengthCurriculum(threshold=0.75, window=4, review=0.5).task_sampler(TaskPool(spaces))
    sizes = {length: spaces.at(length).count() for length in (1, 2, 3)}
    shares = {1: {1: Fraction(1)}, 2: dict.fromkeys((1, 2), Fraction(1, 2))}
    shares[3] = {1: Fraction(1, 4), 2: Fraction(1, 4), 3: Fraction(1, 2)}
    for longest in (1, 2, 3):
        assert course.summary() == {"length": longest}
        offers = [course.propose() for _ in range(40)]
        assert {len(offer.word) for offer in offers} == set(shares[longest])
        for offer in offers:
            length = len(offer.word)
            assert offer.probability == shares[longest][length] / sizes[length]
        for success in (True, False, False, True, True, True):  # the last four are enough
            assert course.summary() == {"length": longest}
            course.update(EpisodeResult(longest, 0, (), success))
            course.update(EpisodeResult(longest % 3 + 1, 0, (), True)) if longest > 1 else None


def test_success_becomes_weights_and_the_probability_is_that_of_the_mixture(
    space: TaskSpace, tasks: dict[Word, Task]
) -> None:
    course = AdaptiveCurriculum(exploration=0.25, lot=40, window=4).task_sampler(TaskPool(space))
    pick = next(task for word, task in tasks.items() if names(word) == ["approach", "grasp"]).actions
    other = next(task for word, task in tasks.items() if names(word) == ["follow", "move"]).actions
    for number in range(40):
        actions, reached = (pick, number > 20) if number % 2 else (other, True)
        course.update(EpisodeResult(2, 1, [Attempt(actions[1], actions[0], reached)], reached))
        assert course.summary()["lot"] == (number == 39)
    assert not course.state_dict()["weights"], "whoever makes no progress draws by the weights of the domain"
    for number in range(40):
        actions, reached = (pick, number > 35) if number % 2 else (other, True)
        course.update(EpisodeResult(2, 1, [Attempt(actions[1], actions[0], reached)], reached))
    weights = {key: Fraction(weight) for key, weight in course.state_dict()["weights"].items()}
    assert weights["grasp"] == weights["approach>grasp"] == 4 and "move" not in weights
    one, all_of_them = space.weights(weights), space.sampling(weights=weights).total_weight()
    assert all_of_them == sum(one.of_plan(plan(space, word)) for word in tasks)
    for _ in range(60):
        offer = course.propose()
        expected = Fraction(1, 4 * len(tasks)) + Fraction(3, 4) * one.of_plan(plan(space, offer.word)) / all_of_them
        assert offer.probability == expected


@pytest.mark.parametrize(
    "kind", [AdaptiveCurriculum(exploration=0.25, lot=8, window=4), BanditCurriculum(lot=6)], ids=["adaptive", "bandit"]
)
def test_lengths_and_weights_of_the_domain_are_in_the_probability(kind: TaskCurriculum) -> None:
    usual = {"grasp": Fraction(3), "can": Fraction(1, 2), "move>drop": Fraction(5)}
    domain = load_domain("prag")
    spaces = TaskSpace(replace(domain, settings=replace(domain.settings, weights=usual)), range(3))
    every = [word for length in (0, 1, 2) for word in spaces.at(length).enumerate()]
    mentioned = {word: weighable(spaces, word) for word in every}

    def share(word: Word, factors: Mapping[str, Fraction]) -> Fraction:
        weights = {key: usual.get(key, 1) * factors.get(key, Fraction(1)) for key in {*usual, *factors}}
        total = sum(math.prod(weights[each] for each in keys if each in weights) for keys in mentioned.values())
        return math.prod((weights[each] for each in mentioned[word] if each in weights), start=Fraction(1)) / total

    pool = TaskPool(spaces)
    course = kind.task_sampler(pool)
    course.seed(1)
    lengths, factors = set[int](), dict[str, Fraction]()
    for number in range(18):
        state, told = course.state_dict(), course.summary()
        offer = course.propose()
        word = offer.word
        if "arm" in told:
            factors = {str(told["arm"]): Fraction(8)}
            assert offer.probability == share(word, factors)
        else:
            factors = {key: Fraction(each) for key, each in state["weights"].items()}
            assert offer.probability == (share(word, {}) + 3 * share(word, factors)) / 4
        lengths.add(len(word))
        task = pool.task(offer).actions
        attempts = [Attempt(action, task[i - 1] if i else None, number % 3 > 0) for i, action in enumerate(task)]
        course.update(EpisodeResult(len(task), 0, attempts, True))
    assert factors and lengths == {1, 2}


def weighable(spaces: TaskSpace, word: Word) -> list[str]:
    """Return what of a task has a weight: its names, its pairs, and once what each entity that it names is."""
    entities = {argument for action in word for argument in action.rstrip(")").partition("(")[2].split(",")}
    classes = [str(kind) for entity, kind in spaces.domain.facts.memberships if str(entity) in entities]
    return [*names(word), *map(">".join, pairwise(names(word))), *entities, *classes]


def plan(space: TaskSpace, word: Word) -> list[object]:
    symbols = {str(action): action for action in space.domain.facts.actions}
    return [symbols[action] for action in word]


@pytest.mark.parametrize(
    "kind", [AdaptiveCurriculum(lot=10, exploration=0.3), BanditCurriculum(lot=10)], ids=["adaptive", "bandit"]
)
def test_importance_weights_give_back_the_mean_of_uniform_draws(
    kind: TaskCurriculum, chance: Chance, space: TaskSpace, tasks: dict[Word, Task]
) -> None:
    course = kind.task_sampler(TaskPool(space))
    course.seed(chance.seed(1))
    lived(course, space, 40, lambda number: number % 7 < 3)
    drawn = [course.propose() for _ in range(1500)]
    weights = [Fraction(1, len(tasks)) / offer.probability for offer in drawn]
    right = Fraction(sum("grasp" in names(word) for word in tasks), len(tasks))
    found = sum(weight for weight, offer in zip(weights, drawn, strict=True) if "grasp" in names(offer.word))
    assert float(found / len(drawn)) == pytest.approx(float(right), abs=0.12)
    assert float(sum(weights) / len(drawn)) == pytest.approx(1.0, abs=0.12)


@pytest.mark.parametrize(
    "kind",
    [AdaptiveCurriculum(lot=20, window=4, exploration=0.3), NoveltyCurriculum("names")],
    ids=["adaptive", "novelty"],
)
def test_what_is_passed_over_for_a_part_counts_as_draws_of_the_same_mixture(
    kind: TaskCurriculum, chance: Chance, space: TaskSpace, tasks: dict[Word, Task]
) -> None:
    part = [rank for rank, word in enumerate(space.enumerate()) if "grasp" in names(word)]
    pool = TaskPool(space, RankedPart(space[part[0] : part[-1] + 1], space))
    course = kind.task_sampler(pool)
    course.seed(chance.seed(2))
    grasp = next(tasks[word].actions for word in space.enumerate() if names(word) == ["approach", "grasp"])
    for number in range(20):
        course.update(EpisodeResult(2, 0, [Attempt(action, None, number > 17) for action in grasp], number > 17))
    drawn = [course.propose() for _ in range(400)]
    draws = sum(1 + offer.passed for offer in drawn)
    found = sum(1 / offer.probability for offer in drawn) / draws
    # Of a course by names that no task is settled with, all are due.
    assert float(found) == pytest.approx(pool.part.size if pool.part else 0, rel=0.17)


def test_what_no_task_of_the_part_has_does_not_stay_due(space: TaskSpace) -> None:
    course = NoveltyCurriculum("names").task_sampler(TaskPool(space, RankedPart(space[7:9], space)))
    for _ in range(4):
        offer = course.propose()
        assert offer.word in (space.plan_at(7), space.plan_at(8))
        course.note_feasibility(offer.word, True)


def test_a_part_of_one_task_is_found_among_skeletons(space: TaskSpace) -> None:
    part = space[7:8]
    course = NoveltyCurriculum("skeletons").task_sampler(TaskPool(space, RankedPart(part, space)))
    assert {course.propose().word for _ in range(3)} == {space.plan_at(7)}


def test_a_bandit_learns_as_exp3_does_and_draws_more_of_its_arm(space: TaskSpace, tasks: dict[Word, Task]) -> None:
    course = BanditCurriculum(exploration=0.3, lot=2).task_sampler(TaskPool(space))
    assert {"grasp", "approach>grasp", "can"} <= set(course.arms)
    gained, before = dict.fromkeys(course.arms, 0.0), dict.fromkeys(course.arms, 0.0)
    every = [task.actions for task in tasks.values()]
    for number in range(5):
        arm = str(course.summary()["arm"])
        chance = float(course.probabilities[course.arms.index(arm)])
        weights = space.weights({arm: 8})
        offer = course.propose()
        total = space.sampling(weights={arm: 8}).total_weight()
        assert offer.probability == weights.of_plan(plan(space, offer.word)) / total
        reached = number % 2 == 0
        having = next(actions for actions in every if arm in keys(space, actions))
        attempts = [Attempt(action, having[i - 1] if i else None, reached) for i, action in enumerate(having)]
        for _ in range(2):
            course.update(EpisodeResult(2, 0, attempts, reached))
        gained[arm] += abs(reached - before[arm]) / chance
        before.update(dict.fromkeys(keys(space, having), float(reached)))
        pulled = [math.exp(0.3 * gained[each] / len(course.arms)) for each in course.arms]
        expected = [0.7 * each / sum(pulled) + 0.3 / len(course.arms) for each in pulled]
        assert list(map(float, course.probabilities)) == pytest.approx(expected)
        assert sum(course.probabilities) == 1


def keys(space: TaskSpace, actions: Sequence[Atom]) -> set[str]:
    """Return the names, pairs and classes of a task."""
    facts = space.domain.facts
    named = {argument for action in actions for argument in action.arguments}
    classes = {str(kind) for entity, kind in facts.memberships if str(entity) in named}
    return {*names(map(str, actions)), *pairs(map(str, actions)), *classes}


def test_going_back_from_the_goal() -> None:
    walk = ReverseCurriculum(threshold=1, window=3, review=0.2).subgoal_sampler()
    for back in (1, 2, 3, 4, 4):
        assert walk.summary() == {"back": back}
        drawn = {walk.stage(4) for _ in range(60)}
        shares = {4 - back: Fraction(4, 5) if back > 1 else Fraction(1)}
        shares |= {stage: Fraction(1, 5 * (back - 1)) for stage in range(5 - back, 4)}
        assert drawn == set(shares.items())
        assert all(stage >= 0 for stage, _ in (walk.stage(2) for _ in range(10)))
        walk.update(EpisodeResult(4, 3, (), False)) if back > 1 else None
        for success in (False, True, True, True):
            assert walk.summary() == {"back": back}
            walk.update(EpisodeResult(4, 4 - back, (), success))
    again = ReverseCurriculum(threshold=1, window=3, review=0.2).subgoal_sampler()
    again.load_state_dict(json.loads(json.dumps(walk.state_dict())))
    assert [walk.stage(4) for _ in range(9)] == [again.stage(4) for _ in range(9)]


def test_a_place_is_chosen_by_exactly_its_share() -> None:
    shares = [Fraction(1, 3), Fraction(0), Fraction(2, 3)]
    counts = Counter(sample_index(shares, 0, "test", number) for number in range(900))
    assert counts[1] == 0 and counts[0] == pytest.approx(300, abs=60)


@pytest.mark.parametrize(
    "wrong",
    [
        lambda: LengthCurriculum(threshold=0), lambda: LengthCurriculum(window=0), lambda: LengthCurriculum(review=1.5),
        lambda: ReverseCurriculum(threshold="x"), lambda: ReverseCurriculum(window=True),
        lambda: NoveltyCurriculum("pair"), lambda: AdaptiveCurriculum(window=0.5),  # type: ignore[arg-type]
        lambda: AdaptiveCurriculum(exploration=0), lambda: AdaptiveCurriculum(lot=0),
        lambda: BanditCurriculum(exploration=2), lambda: BanditCurriculum(lot=-1),
    ],
)  # fmt: skip
def test_curricula_that_mean_nothing_are_refused(wrong: Callable[[], object]) -> None:
    with pytest.raises(QueryError):
        wrong()


def test_pools_that_have_nothing_are_refused(space: TaskSpace) -> None:
    with pytest.raises(QueryError, match="no task"):
        TaskPool(space, RankedPart(space[:0], space))
    with pytest.raises(QueryError, match="no subgoal"):
        TaskPool(space.at(0))
    with pytest.raises(QueryError, match="has pairs"):
        NoveltyCurriculum("pairs").task_sampler(TaskPool(space.at(1)))
    for kind in KINDS:
        with pytest.raises(QueryError, match="no task"):
            kind.task_sampler(TaskPool(space.where("has at least 3 grasp")))

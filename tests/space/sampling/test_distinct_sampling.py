"""Distinct tasks: one order in Python, on the command line and in datasets; by weight, each among those left."""

from __future__ import annotations

import math
from collections import Counter
from fractions import Fraction
from functools import cache
from itertools import chain, count, islice, pairwise, permutations
from pathlib import Path
from random import Random
from typing import Any

import pytest

from prag_asp import QueryError, TaskSpace, load_domain
from prag_asp.exact_numbers import Number
from prag_asp.random_bits import SeededBits
from prag_asp.space import distinct_sampling
from prag_asp.space.distinct_sampling import distinct_order
from prag_asp.space.sampling.remaining_words import RemainingWords, walks_of
from prag_asp.space.without_replacement import Division, ordered_parts, with_tasks
from tests.chance import Chance
from tests.commands import run
from tests.domains import domain_of
from tests.spaces import with_engine

THREE = "fluent(f). initially(f,true). action(a). action(b). action(c)."
WEIGHTS = {"a": 3, "b": "1/2", "c": 0, "d": 7}


def random_text(random: Random) -> str:
    """Return a domain of two to four actions over three fluents, in which most plans go on."""
    lines = ["fluent(f(0..2)). initially(f(0), true). initially(f(1), false). initially(f(2), false)."]
    for name in "abcd"[: random.randint(2, 4)]:
        lines.append(f"action({name}).")
        if random.random() < 0.5:
            lines.append(f"precondition({name}, f({random.randrange(3)}), {random.choice(('true', 'false'))}).")
        lines.append(f"postcondition({name}, f({random.randrange(3)}), {random.choice(('true', 'false'))}).")
    return "\n".join(lines)


@pytest.mark.parametrize("number", range(50))
def test_python_the_command_line_and_datasets_sample_the_same_distinct_tasks(
    number: int, tmp_path: Path, chance: Chance, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(distinct_sampling, "MISSES", 20)
    random = chance.generator(number)
    file = tmp_path / "toy.lp"
    file.write_text(random_text(random), encoding="utf-8")
    domain = load_domain(str(file))
    names = {str(action) for action in domain.facts.actions}
    weights: dict[str, Any] = {key: weight for key, weight in WEIGHTS.items() if key in names and random.random() < 0.7}
    temperature, seed = random.choice(("1", "2", "inf")), random.randrange(1000)
    space = TaskSpace(domain, random.choice(("2", "3", "1..3", "2..3")))
    if not space.sampling(weights=weights, temperature=temperature).total_weight():
        with pytest.raises(QueryError, match="to sample"):
            space.stream(seed=seed, weights=weights, temperature=temperature, distinct=True)
        return
    over = random.choice((None, None, "skeletons", "goals" if len(space.lengths) == 1 else "skeletons"))
    tasks = list(space.stream(seed=seed, weights=weights, temperature=temperature, over=over, distinct=True))
    weighed = space.weights(weights, temperature)
    (part,) = ordered_parts(space, Division.parse(None), seed=seed, weights=weighed, over=over).values()
    assert [task for _, task in with_tasks(space, part.pick(count()))] == tasks
    assert len({task.actions for task in tasks}) == len(tasks)
    allowed = [task for task in space if weights.get("c", 1) or "c" not in task.skeleton]
    assert {task.actions for task in tasks} == {task.actions for task in allowed}
    for size in (1, len(tasks) // 2, len(tasks)):
        options = {"weights": weights, "temperature": temperature, "over": over}
        assert tasks[:size] == space.sample(size, seed=seed, distinct=True, **options)
    given = [part for key, weight in weights.items() for part in ("--weight", f"{key}={weight}")]
    given += [] if over is None else ["--over", over]
    lengths = "..".join(map(str, sorted({space.lengths[0], space.lengths[-1]})))
    done = run(
        "sample", str(file), "-n", lengths, "--count", str(len(tasks)), "--seed", str(seed), "--uniform", *given,
        "--temperature", temperature, "--distinct", "--no-physics",
    )  # fmt: skip
    assert (done.returncode, done.stdout.splitlines()) == (0, list(map(str, tasks)))


def test_parts_of_a_split_sample_distinct_tasks_as_prefixes() -> None:
    part = TaskSpace(load_domain("prag"), 3).split({"train": "0.8", "test": "0.2"})["test"]
    many = part.sample(50, seed=3, distinct=True)
    assert len({task.actions for task in many}) == 50 and part.sample(7, seed=3, distinct=True) == many[:7]


def test_weight_zero_stays_zero_at_every_temperature() -> None:
    space = TaskSpace(domain_of(THREE), 1)
    for temperature in ("1/2", 1, 3, "inf"):
        tasks = space.stream(seed=0, weights={"a": 0}, temperature=temperature, distinct=True)
        assert sorted(map(str, tasks)) == ["b", "c"]


@pytest.mark.parametrize("engine", ["automaton", "clingo", "symbolic"])
@pytest.mark.parametrize("length", ["1", "1..2"])
def test_tasks_end_only_where_no_weight_is_left(engine: str, length: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(distinct_sampling, "MISSES", 100)
    space = TaskSpace(domain_of(THREE), length, engine=engine)
    tasks = list(space.stream(seed=0, weights={"a": 10**60, "b": "1/7"}, distinct=True))
    assert sorted(map(str, tasks)) == sorted(map(str, space))


def test_more_distinct_tasks_than_there_are_is_an_error() -> None:
    space = TaskSpace(domain_of(THREE), 1)
    with pytest.raises(QueryError, match="cannot sample 4 distinct tasks: there are 3"):
        space.sample(4, seed=0, distinct=True)
    with pytest.raises(QueryError, match="cannot sample 4 distinct tasks: there are 3"):
        space.sample(4, seed=0, over="goals", distinct=True)
    with pytest.raises(QueryError, match="cannot sample 3 distinct tasks: only 2 weigh more than 0"):
        space.sample(3, seed=0, weights={"a": 0}, distinct=True)


@pytest.mark.parametrize("misses", [1, 10**9])
@pytest.mark.parametrize(("lengths", "number"), [("1", 300), ("0..1", 700)])
def test_orders_have_the_probabilities_of_successive_sampling(
    misses: int, lengths: str, number: int, chance: Chance, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(distinct_sampling, "MISSES", misses)
    space = TaskSpace(domain_of(THREE), lengths)
    weights = {(): Fraction(1), ("a",): Fraction(5), ("b",): Fraction(1, 2), ("c",): Fraction(2)}
    words = [word for word in weights if len(word) in space.lengths]
    times = chance.examples(number)
    sampling = space.sampling(weights={"a": 5, "b": "1/2", "c": 2})
    orders = (distinct_order(sampling, seed).pick(count()) for seed in map(chance.seed, range(times)))
    seen = Counter(tuple(draw.word for draw in order) for order in orders)
    statistic = 0.0
    for order in permutations(words):
        left, probability = sum(weights[word] for word in words), Fraction(1)
        for word in order:
            probability *= weights[word] / left
            left -= weights[word]
        statistic += float((seen[order] - times * probability) ** 2 / (times * probability))
    freedom = math.factorial(len(words)) - 1
    assert sum(seen.values()) == times and statistic < freedom + 6 * math.sqrt(2 * freedom)


LETTERS = "fluent(f). initially(f,false). action(a). action(b(1..3)). action(c). postcondition(a,f,true)."
GROUPS = {"skeletons": [["a"], ["b(1)", "b(2)", "b(3)"], ["c"]], "goals": [["a"], ["b(1)", "b(2)", "b(3)", "c"]]}


@pytest.mark.parametrize("misses", [1, 10**9])
@pytest.mark.parametrize("over", ["skeletons", "goals"])
def test_over_groups_each_task_has_its_probability_among_the_remaining_ones(
    misses: int, over: Any, chance: Chance, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(distinct_sampling, "MISSES", misses)
    groups, factors = GROUPS[over], {"b": Fraction(2), "c": Fraction(1, 3)}
    exact = {}
    for group in groups:
        own = {word: factors.get(word[0], Fraction(1)) for word in group}
        exact |= {word: weight / sum(own.values()) / len(groups) for word, weight in own.items()}
    times = chance.examples(500)
    sampling = TaskSpace(domain_of(LETTERS), 1).sampling(weights=factors, over=over, by="plan")
    orders = [list(distinct_order(sampling, seed).pick(count())) for seed in map(chance.seed, range(times))]
    assert {draw.word[0]: draw.probability for order in orders for draw in order} == exact
    assert all({draw.word[0] for draw in order} == exact.keys() and len(order) == 5 for order in orders)
    seen = Counter((order[0].word[0], order[1].word[0]) for order in orders)
    statistic = 0.0
    for one, two in permutations(exact, 2):
        wanted = times * exact[one] * exact[two] / (1 - exact[one])
        statistic += float((seen[one, two] - wanted) ** 2 / wanted)
    assert statistic < 19 + 6 * math.sqrt(2 * 19)


@pytest.mark.parametrize("over", ["skeletons", "goals"])
def test_parts_over_groups_have_their_own_tasks_once(over: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(distinct_sampling, "MISSES", 20)
    space = TaskSpace(domain_of(LETTERS), 2)
    for division in (Division.parse({"train": "0.8", "test": "0.2"}), Division.parse(None, hold_out="c")):
        for excluded in ((), ((2, 7), (2, 20))):
            parts = ordered_parts(space, division, seed=1, weights=space.weights({}), over=over, excluded=excluded)
            ranks = {name: [draw.rank for draw in part.pick(count())] for name, part in parts.items()}
            assert sorted(chain(*ranks.values())) == sorted({*range(25)} - {rank for _, rank in excluded})
            assert {name: part.size for name, part in parts.items()} == {name: len(own) for name, own in ranks.items()}


def test_too_many_skeletons_to_sample_the_remaining_tasks_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(distinct_sampling, "MISSES", 1)
    monkeypatch.setattr(distinct_sampling, "MOST_GROUPS", 2)
    space = TaskSpace(domain_of(LETTERS), 2)
    with pytest.raises(
        QueryError, match="over skeletons, 1 draws in a row gave no new task, and there are more than 2"
    ):
        list(space.stream(seed=0, over="skeletons", distinct=True))


OF_PAIRS: dict[str, Number] = {"grasp": 3, "approach>grasp": "1/2", "apple": 2}


@cache
def probabilities(by: Any) -> dict[tuple[str, ...], Fraction]:
    """Return the probabilities of nearly all words of two actions."""
    draws = TaskSpace(load_domain("prag"), 2).sampling(weights=OF_PAIRS, by=by).draws(seed=1)
    return {draw.word: draw.probability for draw in islice(draws, 8000)}


@pytest.mark.parametrize("engine", ["automaton", "clingo", "symbolic"])
@pytest.mark.parametrize("by", ["plan", "task"])
def test_what_is_left_weighs_exactly_what_was_not_taken(engine: str, by: Any, chance: Chance) -> None:
    space = with_engine(TaskSpace(load_domain("prag"), 2), engine)
    engine_of, letters = space.engines.engine(by, 2), space.action_texts(by)
    weighed = engine_of.weighed(2, space.weights(OF_PAIRS))
    exact = {word: probability * weighed.total(2) for word, probability in probabilities(by).items()}
    left, taken = RemainingWords(walks_of(weighed, 2), 2), []
    while left.weight:
        before = left.weight
        word, weight = left.take(SeededBits(chance.seed(3)), len(taken))
        taken.append(tuple(letters[letter] for letter in word))
        assert before - left.weight == weight == exact.get(taken[-1], weight)
    assert len(set(taken)) == len(taken) == space.count(by) and left.taken == len(taken)


def test_a_held_out_part_without_weight_ends_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(distinct_sampling, "MISSES", 100)
    space = TaskSpace(load_domain("prag"), 12)  # far more tasks than anyone lists
    parts = ordered_parts(space, Division.parse(None, hold_out="rotate"), seed=0, weights=space.weights({"rotate": 0}))
    assert not list(parts["test"].pick(count()))
    words = [draw.word for draw in islice(parts["train"].pick(count()), 300)]
    assert len(set(words)) == 300 and all(one != two for one, two in pairwise(words))

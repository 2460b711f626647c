"""Draws as arrays: exact where 64 bits decide nothing, the same bytes however they are portioned, for every mode."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator
from fractions import Fraction
from functools import cache
from hashlib import sha256
from itertools import accumulate, chain, islice, repeat
from sys import getsizeof
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from prag_asp import QueryError, Task, TaskSpace, load_domain
from prag_asp.exact_numbers import Number
from prag_asp.random_bits import SeededBits, uniform_below
from prag_asp.space.automaton.automaton import Automaton, Completions
from prag_asp.space.sampling import paths, samplers, streams
from prag_asp.space.sampling.choice_table import exact_choice
from prag_asp.space.sampling.samplers import WeightSampler
from prag_asp.space.weights.weights import Weighed
from tests.chance import Chance
from tests.domains import domain_of
from tests.space.sampling.test_sampling import expected_weight
from tests.spaces import with_engine

DRAWS = 400_000
"""Draws of a mode: deviations of five percent exceed `BOUND` by about six standard deviations."""

DOMAIN = load_domain("prag")
PAIRS = TaskSpace(DOMAIN, 2)
BOUND = 4.5
"""Standard deviations of chi-square that a right sampler passes: one in 10^5 seeds would not."""


class Given:
    """A source of bits that gives what a test wants: the same word to every draw, and then further words."""

    def __init__(self, word: int, *further: int) -> None:
        self.word, self.more, self.asked = word, further, 0

    def words(self, first: int, count: int, each: int) -> NDArray[np.uint64]:
        return np.full((count, each), self.word, dtype=np.uint64)

    def further(self, draw: int, step: int) -> Iterator[int]:
        for word in self.more:
            self.asked += 1
            yield word


def fork(*weights: int) -> Weighed:
    """Return an automaton of one-letter words with weights."""
    edges = np.arange(len(weights), dtype=np.int64)
    offsets = np.array([0, len(weights), len(weights)], dtype=np.int64)
    accepting = np.array([False, True])
    return Weighed(
        Completions(Automaton(offsets, edges, np.ones_like(edges), accepting, np.array(weights, dtype=object)))
    )


THIRD = 2**64 // 3


@pytest.mark.parametrize("count", [1, 1000])
@pytest.mark.parametrize(
    ("word", "further", "letter"),
    [
        (THIRD - 1, (), 0),
        (THIRD + 1, (), 1),
        (THIRD, (THIRD - 1,), 0),
        (THIRD, (THIRD + 1,), 1),
        (THIRD, (THIRD, THIRD, THIRD + 1), 1),
        (THIRD, (THIRD, 0), 0),
        (0, (), 0),
        (2**64 - 1, (), 1),
    ],
)
def test_a_tie_of_64_bits_is_decided_by_further_bits(
    word: int, further: tuple[int, ...], letter: int, count: int
) -> None:
    bits = Given(word, *further)
    drawn = WeightSampler(fork(1, 2), 1).sample(bits, 0, count, with_probabilities=False)
    assert drawn.letters.tolist() == [[letter]] * count
    assert bits.asked == count * len(further)


@pytest.mark.parametrize("count", [1, 1000])
def test_edges_that_weigh_far_less_than_one_in_2_to_the_64_are_drawn_where_the_bits_say_so(count: int) -> None:
    tiny = fork(1, 2**200, 0, 1)
    for further, letter in (((0, 0, 0), 0), ((0, 0, 2**64 - 1), 1)):
        drawn = WeightSampler(tiny, 1).sample(Given(0, *further), 0, count, with_probabilities=True)
        assert drawn.letters.tolist() == [[letter]] * count
        assert drawn.probabilities[0] == Fraction((1, 2**200)[letter], 2**200 + 2)
    top = 2**64 - 1
    last = WeightSampler(tiny, 1).sample(Given(top, top, top, top), 0, count, with_probabilities=False)
    assert last.letters.tolist() == [[3]] * count


@given(
    st.lists(st.integers(0, 2**80), min_size=1, max_size=6).filter(any),
    st.lists(st.one_of(st.integers(0, 2**64 - 1), st.sampled_from([0, THIRD, 2**63, 2**64 - 1])), min_size=1),
)
def test_a_choice_is_the_interval_of_the_real_number_that_the_words_spell(weights: list[int], words: list[int]) -> None:
    running = list(accumulate(weights))
    read: list[int] = []

    def further() -> Iterator[int]:
        for word in chain(words[1:], repeat(12345)):
            read.append(word)
            yield word

    chosen = exact_choice(running, words[0], further)
    used = [words[0], *read]
    low = sum((Fraction(word, 2 ** (64 * place)) for place, word in enumerate(used, 1)), start=Fraction(0))
    before = Fraction(running[chosen] - weights[chosen], running[-1])
    assert before <= low and low + Fraction(1, 2 ** (64 * len(used))) <= Fraction(running[chosen], running[-1])


def test_a_number_below_a_bound_is_rejected_rather_than_reduced(chance: Chance) -> None:
    assert uniform_below(5, iter([0b111 << 61, 0b101 << 61, 0b100 << 61])) == 4
    assert uniform_below(2**64 + 1, iter([1 << 63, 7])) < 2**64 + 1
    bits = SeededBits(chance.seed(3))
    assert {bits.randrange(3) for _ in range(300)} == {0, 1, 2}


def test_the_generator_is_the_published_one() -> None:
    """Known answer for counter 0 and key 0 in Random123 1.14; NumPy counts up before each block."""
    raw = np.random.Philox(key=0, counter=2**256 - 1).random_raw(4).tolist()
    assert [f"{word:x}" for word in raw] == [
        "16554d9eca36314c", "db20fe9d672d0fdc", "d7e772cee186176b", "7e68b68aec7ba23b",
    ]  # fmt: skip


@pytest.mark.parametrize("over", [None, "skeletons", "goals"])
def test_a_seed_gives_the_same_bytes_in_whatever_portions(
    over: str | None, monkeypatch: pytest.MonkeyPatch, chance: Chance
) -> None:
    space = TaskSpace(DOMAIN, 5)

    def drawn(count: int, first: int = 0) -> NDArray[np.int32]:
        return space.sampling(weights={"grasp": "1/3"}, over=over).array(count, seed=chance.seed(9), first=first)  # type: ignore[arg-type]

    whole = drawn(700)
    assert whole.shape == (700, 5) and whole.dtype == np.int32
    assert (np.concatenate([drawn(3), drawn(497, 3), drawn(200, 500)]) == whole).all()
    words = islice(space.sampling(weights={"grasp": "1/3"}, over=over).draws(seed=chance.seed(9)), 700)  # type: ignore[arg-type]
    letters = space.action_texts()
    assert [draw.word for draw in words] == [tuple(letters[letter] for letter in row) for row in whole.tolist()]
    monkeypatch.setattr(paths, "CHUNK_WORDS", 100)
    monkeypatch.setattr(paths, "KEPT_EDGES", 0)
    space = TaskSpace(DOMAIN, 5)
    assert (drawn(700) == whole).all()


def test_the_bytes_of_a_seed_never_change() -> None:
    drawn = TaskSpace(DOMAIN, 15).sampling(weights={}).array(2000, seed=1)
    assert sha256(drawn.astype("<i4").tobytes()).hexdigest()[:16] == "84e2dbed8d634dbf"


@pytest.mark.parametrize("by", ["plan", "task", "skeleton"])
def test_both_engines_draw_the_same_words_from_a_seed(by: str, chance: Chance) -> None:
    spaces = (with_engine(PAIRS, engine) for engine in ("automaton", "clingo"))
    one, two = (space.sampling(weights={}, by=by).array(3000, seed=chance.seed(4)) for space in spaces)  # type: ignore[arg-type]
    assert (one == two).all()


WEIGHTS: dict[str, Number] = {"grasp": 2, "grasp>move": "1/2", "can": 3, "bowl_1": "1/3", "withdraw": 0}
MODES = {
    "by weight": ("1", None), "hot": ("2", None), "cold": ("1/2", None), "uniform": ("inf", None),
    "over skeletons": ("1", "skeletons"), "over goals": ("1", "goals"), "over goals, hot": ("inf", "goals"),
}  # fmt: skip


@cache
def tasks_found(engine: str) -> list[Task]:
    """Return the tasks that all modes draw from, as an engine lists them."""
    return list(with_engine(PAIRS, engine))


def exact_probabilities(tasks: list[Task], temperature: str, over: str | None) -> dict[tuple[str, ...], Fraction]:
    """Return the probability of each task by the definition: a group uniformly, then by weight within."""
    powers: dict[str, dict[Fraction, Number]] = {
        # Square roots of the weights: the nearest fractions with denominators up to 10000, below 1 of the inverse.
        "2": {Fraction(2): "8119/5741", Fraction(3): "13775/7953", Fraction(1, 2): "5741/8119",
              Fraction(1, 3): "7953/13775"},
        "1/2": {Fraction(2): 4, Fraction(3): 9, Fraction(1, 2): "1/4", Fraction(1, 3): "1/9"},
        "inf": dict.fromkeys(map(Fraction, ("2", "3", "1/2", "1/3")), 1),
    }  # fmt: skip
    used = {key: powers.get(temperature, {}).get(Fraction(weight), weight) for key, weight in WEIGHTS.items()}
    weights = {tuple(map(str, task.actions)): expected_weight(tuple(map(str, task.actions)), used) for task in tasks}
    groups = {
        word: None if over is None else task.skeleton if over == "skeletons" else frozenset(task.states[-1].items())
        for word, task in zip(weights, tasks, strict=True)
    }
    totals: Counter[object] = Counter()
    for word, weight in weights.items():
        totals[groups[word]] += weight  # type: ignore[assignment]
    number = sum(1 for total in totals.values() if total)
    return {word: weight / totals[groups[word]] / number for word, weight in weights.items() if weight}


def deviation(seen: NDArray[np.float64], shares: NDArray[np.float64], draws: int) -> float:
    """Return by how many standard deviations chi-square exceeds what it is for the shares."""
    freedom = len(shares) - 1
    statistic = float(((seen - draws * shares) ** 2 / (draws * shares)).sum())
    return (statistic - freedom) / math.sqrt(2 * freedom)


def test_sums_of_large_numbers_are_kept_within_a_bound_of_bytes(monkeypatch: pytest.MonkeyPatch) -> None:
    """Draw words whose weights have hundreds of digits, with sums kept and, for the same words, without."""
    names = [f"a{number}" for number in range(6)]
    domain = domain_of(" ".join(f"action({name}(x; y))." for name in names))
    weights: dict[str, Number] = {name: 10**300 + number for number, name in enumerate(names)}

    def drawn(bound: int) -> tuple[list[str], list[int]]:
        monkeypatch.setattr(samplers, "KEPT_SUMS", bound)
        made: list[samplers.SkeletonSampler] = []

        def remembered(*given: Any) -> samplers.SkeletonSampler:
            made.append(samplers.SkeletonSampler(*given))
            return made[-1]

        monkeypatch.setattr(streams, "SkeletonSampler", remembered)
        space = with_engine(TaskSpace(domain, 3), "auto")  # it has no drawer yet
        tasks = space.sample(300, seed=1, weights=weights, over="skeletons")
        return list(map(str, tasks)), [sum(map(bytes_of, each._known.values())) for each in made]

    never, _ = drawn(0)
    for bound in (0, 10_000, 50_000):
        words, kept = drawn(bound)
        assert words == never and kept and max(kept) <= bound
    assert max(kept) > 10_000


def bytes_of(value: object) -> int:
    """Return how much memory numbers, and what holds them, take."""
    if isinstance(value, dict):
        return getsizeof(value) + sum(map(bytes_of, (*value, *value.values())))
    return getsizeof(value) + (sum(map(bytes_of, value)) if isinstance(value, (list, tuple)) else 0)


@pytest.mark.parametrize("engine", ["automaton", "clingo"])
@pytest.mark.parametrize("mode", MODES)
def test_each_mode_draws_with_the_exact_probabilities_and_five_percent_would_show(
    mode: str, engine: str, chance: Chance
) -> None:
    temperature, over = MODES[mode]
    space = with_engine(PAIRS, engine)
    options = {"weights": WEIGHTS, "temperature": temperature, "over": over}
    exact = exact_probabilities(tasks_found(engine), temperature, over)
    assert sum(exact.values()) == 1
    told = list(islice(space.sampling(**options).draws(seed=chance.seed(21)), 300))  # type: ignore[arg-type]
    assert all(draw.probability == exact[draw.word] for draw in told)
    rows = space.sampling(**options).array(DRAWS, seed=chance.seed(21))  # type: ignore[arg-type]
    letters = space.action_texts()
    width = len(letters)
    counted = Counter(dict(zip(*(a.tolist() for a in np.unique(rows @ [width, 1], return_counts=True)), strict=True)))
    numbers = {letter: number for number, letter in enumerate(letters)}
    cells = [numbers[one] * width + numbers[two] for one, two in exact]
    assert set(counted) <= set(cells)
    shares = np.array([float(share) for share in exact.values()])
    assert abs(deviation(np.array([float(counted[cell]) for cell in cells]), shares, DRAWS)) < BOUND
    wrong = shares * np.where(np.arange(len(shares)) % 2, 1.05, 1)
    off = np.random.Generator(np.random.PCG64(chance.seed(5))).multinomial(DRAWS, wrong / wrong.sum())
    assert deviation(off.astype(np.float64), shares, DRAWS) > BOUND


def test_skeletons_come_alike_and_so_do_goals(chance: Chance) -> None:
    space = TaskSpace(DOMAIN, 3)
    drawn = islice(space.stream(seed=chance.seed(2), over="skeletons", weights=WEIGHTS), 8_000)
    seen = Counter(task.skeleton for task in drawn)
    names = {"approach", "grasp", "drop", "move", "transform", "follow", "rotate"}
    wanted = {word for word in space.enumerate("skeleton") if set(word) <= names}
    assert set(seen) == wanted
    shares = np.full(len(seen), 1 / len(seen))
    assert abs(deviation(np.array(list(seen.values()), dtype=np.float64), shares, 8_000)) < BOUND
    goals = Counter(
        task.states[-1] for task in islice(space.stream(seed=chance.seed(2), over="goals", weights={}), 8_000)
    )
    shares = np.full(len(goals), 1 / len({task.states[-1] for task in space}))
    assert abs(deviation(np.array(list(goals.values()), dtype=np.float64), shares, 8_000)) < BOUND


@pytest.mark.parametrize("engine", ["automaton", "clingo"])
def test_the_task_without_actions_is_drawn_in_every_mode(engine: str) -> None:
    space = TaskSpace(DOMAIN, 0, engine=engine)
    for over in (None, "skeletons", "goals"):
        (task,) = space.sample(1, seed=0, weights={"grasp": 2}, over=over)  # type: ignore[arg-type]
        assert (task.actions, task.log_probability) == ((), 0.0)


@pytest.mark.parametrize("engine", ["automaton", "clingo"])
def test_weights_that_outgrow_machine_words_may_lead_nowhere(engine: str) -> None:
    domain = domain_of("fluent(f). initially(f,false). action(a). goal(f,true).")
    space = TaskSpace(domain, 2, engine=engine)
    assert space.sampling(weights={"a": 10**30}).total_weight() == 0
    with pytest.raises(QueryError, match=r"there is no task of length 2 to sample$"):
        space.sampling(weights={"a": 10**30}).array(1, seed=0)


def test_what_cannot_be_drawn_is_refused() -> None:
    space = TaskSpace(DOMAIN, 2)
    with pytest.raises(QueryError, match="all 265 weigh 0"):
        space.sampling(weights={"panda": 0}).array(1, seed=0)
    with pytest.raises(QueryError, match="there are skeletons, goals"):
        space.sample(1, seed=0, over="stars")  # type: ignore[arg-type]
    with pytest.raises(QueryError, match="only for tasks and plans"):
        space.sampling(weights={}, by="skeleton", over="goals").array(1, seed=0)
    with pytest.raises(QueryError, match="skeletons have no weights"):
        space.sampling(weights={"grasp": 2}, by="skeleton").array(1, seed=0)

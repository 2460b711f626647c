"""Draws are uniform, or as the weights say; the same seed gives the same ones."""

from __future__ import annotations

from collections import Counter
from fractions import Fraction
from itertools import islice
from math import prod, sqrt
from typing import TypeVar

import pytest

from prag_asp import DomainError, QueryError, answer_sets
from prag_asp.errors import NotFound
from prag_asp.models.diagram import Branch, Diagram, WeightedDiagram
from prag_asp.random_bits import SeededBits, Words
from tests.chance import Chance
from tests.models.test_known_numbers import COLOURING, QUEENS, TREE

T = TypeVar("T")

DISJUNCTION = "a ; b ; c. a :- b. b :- a. {d; e}. :- a, d."
WEIGHTS = 'weight(a,2). weight(b,(1,3)). weight(c,"0.25"). {a;b;c;d}. :- a, b, c, d. #show a/0. #show b/0. #show c/0. '


def chi_square(drawn: Counter[T], expected: dict[T, Fraction]) -> float:
    """Return the statistic over its degrees of freedom: 1 for draws that follow the shares."""
    assert set(drawn) <= set(expected)
    draws = sum(drawn.values())
    parts = ((drawn[each] - draws * share) ** 2 / (draws * share) for each, share in expected.items())
    return float(sum(parts) / (len(expected) - 1))


@pytest.mark.parametrize(
    ("text", "constants"), [(QUEENS, {"n": 7}), (COLOURING, {"n": 5, "k": 4}), (TREE, {"n": 3}), (DISJUNCTION, {})]
)
def test_draws_are_uniform(text: str, constants: dict[str, int], chance: Chance) -> None:
    found = answer_sets(text=text, constants=constants)
    number = found.count()
    drawn = Counter(map(tuple, found.sample(100 * number, seed=chance.seed(5))))
    shares = {each: Fraction(often, number) for each, often in Counter(map(tuple, found)).items()}
    # Five standard deviations of the statistic around its mean.
    assert abs(chi_square(drawn, shares) - 1) < 5 * sqrt(2 / (len(shares) - 1))


def test_the_first_samples_take_few_random_words(monkeypatch: pytest.MonkeyPatch) -> None:
    counts: list[int] = []
    original = SeededBits.words

    def words(bits: SeededBits, first: int, count: int, each: int) -> Words:
        counts.append(count)
        return original(bits, first, count, each)

    monkeypatch.setattr(SeededBits, "words", words)
    found = answer_sets(text=QUEENS, constants={"n": 7})
    assert len([*found.sample(1, seed=5)]) == 1 and counts == [1]
    hundred = [*found.sample(100, seed=5)]
    assert len(hundred) == 100 and counts[1:] == [1, 2, 4, 8, 16, 32, 64]
    assert [*found.sample(10, seed=5)] == hundred[:10]


@pytest.mark.parametrize("engine", ["diagram", "clingo"])
def test_draws_follow_the_weights(engine: str, chance: Chance) -> None:
    found = answer_sets(text=WEIGHTS, weighted=True, engine=engine)
    weight = {"a": Fraction(2), "b": Fraction(1, 3), "c": Fraction(1, 4)}
    subsets = [{name for bit, name in enumerate("abcd") if number >> bit & 1} for number in range(15)]
    weights: dict[str, Fraction] = {}
    for subset in subsets:
        shown = str(tuple(sorted(subset - {"d"})))
        weights[shown] = weights.get(shown, Fraction(0)) + prod(weight[name] for name in subset - {"d"})
    total = sum(weights.values())
    assert found.total() == total
    drawn = Counter(str(tuple(map(str, each))) for each in found.sample(20_000, seed=chance.seed(6)))
    shares = {shown: own / total for shown, own in weights.items()}
    assert abs(chi_square(drawn, shares) - 1) < 5 * sqrt(2 / (len(shares) - 1))


def test_the_same_seed_gives_the_same_draws_and_a_longer_sample_begins_like_a_shorter_one() -> None:
    found = [answer_sets(text=TREE, constants={"n": 3}) for _ in range(2)]
    assert list(found[0].sample(30, seed=4)) == list(found[1].sample(30, seed=4))
    assert list(found[0].sample(10, seed=4)) == list(islice(found[1].sample(30, seed=4), 10))
    assert list(found[0].sample(30, seed=5)) != list(found[1].sample(30, seed=4))


def test_a_share_that_64_bits_do_not_tell_from_another_is_decided_by_more() -> None:
    choice = WeightedDiagram(Diagram(((Branch((1,), ()), Branch((-1,), ())),)), {1: 1, -1: 2})
    threshold, one, other, exactly = choice._choice(0)
    assert (one.literals, other.literals) == ((1,), (-1,)) and threshold == 2**64 // 3
    assert exactly(iter([threshold, threshold - 1])) and not exactly(iter([threshold, threshold + 1]))
    even = WeightedDiagram(Diagram(((Branch((1,), ()), Branch((-1,), ())),)), {})
    assert not even._choice(0)[3](iter([])), "half of all words lie below"


def test_there_is_nothing_to_draw_from_nothing() -> None:
    for text, weighted in (("a. :- a.", False), ("a :- not a.", False), ("1{b}. weight(b,0).", True)):
        with pytest.raises(NotFound):
            list(answer_sets(text=text, weighted=weighted).sample(1))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{a}.\nweight(a,-1).", "^<text>:2: .* -1 is not a weight"),
        ('{a(1..2)}. weight(a(1),2).\nweight(a(X),"1/0") :- X = 2..2.', "^<text>:2: .* is not a weight"),
        ("{a;b}. weight(b,2).\nweight(a,2) :- a.", "^<text>:2: .* has to be a fact"),
        ("{a}. weight(a,2).\nweight(a,3).", "^<text>:2: .* another weight as well"),
        ("{a}.", "states no weight"),
        (
            "{a}.\n\nweight(a,1,2).",
            r"^<text>:3: weight\(a,1,2\) has 3 arguments, and a weight has 2; write weight\(Atom,W\)",
        ),
        ("{a}.\n-weight(a,2).", r"^<text>:2: -weight\(a,2\) is negated, so it is not a weight; write weight\(Atom,W\)"),
        ("{a;b}.\nweight(a,2). #show b/0.", "^<text>:2: .*projected away"),
        ("{a;b}. weight(b,1).\nweight((a;c),2). #show a : b. #show b/0.", "^<text>:2: .*projected away"),
    ],
)
def test_a_weight_that_is_none_is_refused(text: str, message: str) -> None:
    for engine in ("auto", "clingo"):
        with pytest.raises((DomainError, QueryError), match=message):
            answer_sets(text=text, weighted=True, project=True, engine=engine).total()


def test_ten_to_the_twelve_answer_sets_are_drawn_and_listed_without_finding_them_all() -> None:
    found = answer_sets(text="{a(1..40)}. b(X) :- a(X), not a(X+1), X < 40. :- a(1), a(2), a(3). #show b/1.")
    assert found.count() == 7 * 2**37
    assert len({str(each) for each in found.sample(50, seed=1)}) == 50
    assert len(list(islice(found, 5))) == 5


@pytest.mark.parametrize("engine", ["diagram", "clingo"])
def test_symbols_are_shown_once_and_weights_of_projection_variables_are_read(engine: str) -> None:
    found = answer_sets(text="{a; b}. #show. #show a : a. #show no(a) : not a.", engine=engine)
    assert sorted(" ".join(map(str, each)) for each in found) == ["a", "a", "no(a)", "no(a)"]
    text = "{a;b}. #show a/0. #show a : b."
    found = answer_sets(text=text, engine=engine)
    assert sorted(" ".join(map(str, each)) for each in found) == ["", "a", "a", "a"]
    assert list(found.marginals().values()) == [Fraction(3, 4)]
    projected = answer_sets(text=text, engine=engine, project=True)
    assert projected.count() == len(list(projected)) == projected.total() == 2
    assert list(projected.marginals().values()) == [Fraction(1, 2)]
    text = "{a;b}. c. weight(a,2). weight(c,5). weight(none,3). #show. #show t : a."
    assert answer_sets(text=text, engine=engine, project=True, weighted=True).total() == 15

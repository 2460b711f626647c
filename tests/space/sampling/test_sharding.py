"""Draws that are dealt to several: each has every so many-th, and all together have all."""

from __future__ import annotations

from functools import cache
from itertools import chain, count, islice

import pytest

from prag_asp import QueryError, TaskSpace, load_domain
from prag_asp.space.sampling.sharding import Deal
from prag_asp.space.without_replacement import Division, ordered_parts


@pytest.mark.parametrize("of", [1, 2, 3, 7])
def test_each_draw_is_dealt_to_one_and_numbers_lead_back(of: int) -> None:
    deals = [Deal.parse(f"{number}/{of}") for number in range(1, of + 1)]
    for size in range(20):
        hands = [[deal.whole(own) for own in range(deal.share(size))] for deal in deals]
        assert sorted(chain.from_iterable(hands)) == list(range(size))
        assert all(len(hand) in (size // of, -(-size // of)) for hand in hands)
    for whole in range(20):
        owns = [deal.own(whole) for deal in deals]
        assert [own is not None for own in owns].count(True) == 1
        assert owns[whole % of] == whole // of


@pytest.mark.parametrize("text", ["", "3", "0/3", "4/3", "-1/3", "1/0", "1.0/3", "a/b", "1/2/3", "1/1000001", "٣/٤"])
def test_other_texts_are_refused_in_one_line(text: str) -> None:
    with pytest.raises(QueryError, match="write K/N") as error:
        Deal.parse(text)
    assert len(error.value.lines) == 1


@cache
def kitchen() -> TaskSpace:
    return TaskSpace(load_domain("kitchen"), range(1, 4))


@pytest.mark.parametrize("weights", [{}, {"open": 3}], ids=str)
@pytest.mark.parametrize("more", [{}, {"hold_out": "close"}], ids=str)
def test_what_is_dealt_are_the_draws_of_all_in_their_order(weights: dict[str, int], more: dict[str, str]) -> None:
    space = kitchen()
    division = Division.parse(None, **more)
    whole = ordered_parts(space, division, seed=5, weights=space.weights(weights))
    for number in (1, 2, 3):
        dealt = ordered_parts(space, division, seed=5, weights=space.weights(weights), deal=Deal(number, 3))
        for name, part in whole.items():
            right = list(islice(part.pick(count()), number - 1, None, 3))
            assert list(dealt[name].pick(count())) == right and dealt[name].size == len(right)
            assert list(dealt[name].pick(count(1))) == right[1:]
            picked = [own for own in range(len(right)) if own % 2]
            assert list(dealt[name].pick(picked)) == [right[own] for own in picked]

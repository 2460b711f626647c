"""Phrasings: some of the ways to say the same, so that others are left for somebody who has not heard them."""

from __future__ import annotations

import pytest

from prag_asp import QueryError, TaskSpace, load_domain
from prag_asp.dataset import instruction_writer_of
from prag_asp.grammar.phrasings import Phrasings


def test_two_phrasings_are_disjoint_exactly_where_they_have_no_place_in_common() -> None:
    known = [Phrasings(number, every) for every in range(1, 7) for number in range(1, every + 1)]
    for one in known:
        for other in known:
            places = [place for place in range(720) if one.has(place) and other.has(place)]
            assert one.disjoint(other) == (not places)


def test_a_list_without_such_a_way_is_said_as_it_is() -> None:
    assert Phrasings(2, 2).of(["only"]) == ["only"] and Phrasings(2, 2).of("abcd") == ["b", "d"]
    assert Phrasings.parse("") == Phrasings() and str(Phrasings.parse(" 2  of 3 ")) == "2 of 3"


@pytest.mark.parametrize("text", ["0 of 2", "3 of 2", "1", "one of two", "1 of 2 of 3", "1/2", "-1 of 2"])
def test_what_is_no_phrasing_is_refused(text: str) -> None:
    with pytest.raises(QueryError, match="write which of how many"):
        Phrasings.parse(text)


@pytest.mark.parametrize(("name", "language"), [("tabletop", "en"), ("tabletop", "de")])
def test_no_instruction_of_one_phrasing_is_one_of_the_other_and_both_are_read_back(name: str, language: str) -> None:
    space = TaskSpace(load_domain(name), 2)
    writers = [instruction_writer_of(space.domain, language, phrasings=f"{number} of 2") for number in (1, 2)]
    words: list[set[str]] = [set(), set()]
    for task in space.sample(25, seed=3):
        for writer, heard in zip(writers, words, strict=True):
            for seed in range(3):
                annotation = writer.instructions(task, seed)
                heard |= {annotation.vague, annotation.default, annotation.exact, *annotation.subgoals}
                assert (
                    writer.read(task, annotation.default).actions
                    == writer.read(task, annotation.exact).actions
                    == task.actions
                )
    assert words[0].isdisjoint(words[1]) and min(map(len, words)) > 60


def test_an_action_with_too_few_sentences_is_reported_by_its_name() -> None:
    with pytest.raises(QueryError, match=r"phrasings 3 of 3: \w+ has only 2 in en; write more under"):
        instruction_writer_of(load_domain("tabletop"), phrasings="3 of 3")

"""Facets: which shown atoms some answer sets have and others lack, and what choosing or excluding each leaves."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from prag_asp import AnswerSets, QueryError, answer_sets
from prag_asp.errors import NotFound
from tests.chance import examples
from tests.models.programs import loops, program
from tests.models.test_random_programs import read

Row = tuple[Fraction, int, int, Fraction, Fraction, int, int, Fraction, Fraction]


def facets_by_definition(found: Sequence[Sequence[str]], atom: str, atoms: Sequence[str]) -> Row | Fraction:
    """Return the share of an atom, and for a facet the numbers and the shares by which they shrink."""

    def facets(some: Sequence[Sequence[str]]) -> int:
        return sum(0 < sum(each in shown for shown in some) < len(some) for each in atoms)

    having, lacking = [shown for shown in found if atom in shown], [shown for shown in found if atom not in shown]
    share, before = Fraction(len(having), len(found)), facets(found)
    if not having or not lacking:
        return share

    def left(some: Sequence[Sequence[str]]) -> tuple[int, int, Fraction, Fraction]:
        sets, open_atoms = len(some), facets(some)
        return sets, open_atoms, Fraction(len(found) - sets, len(found)), Fraction(before - open_atoms, before)

    return (share, *left(having), *left(lacking))


def rows(found: AnswerSets) -> dict[str, Row | Fraction]:
    listed: dict[str, Row | Fraction] = {}
    for symbol, facet in found.facets().items():
        chosen, excluded = facet.chosen, facet.excluded
        listed[str(symbol)] = facet.share
        assert facet.is_facet == (chosen is not None) == (excluded is not None) == (0 < facet.share < 1)
        if chosen is not None and excluded is not None:
            both = [(n.answer_sets, n.facets, n.of_answer_sets, n.of_facets) for n in (chosen, excluded)]
            listed[str(symbol)] = (facet.share, *both[0], *both[1])
    return listed


@given(st.one_of(program(), loops()), st.booleans())
@settings(max_examples=examples(20))
def test_facets_are_those_of_the_listed_answer_sets(text: str, project: bool) -> None:
    found = read(text, project=project)
    if found is None:
        return
    listed = [tuple(map(str, each)) for each in found]
    for each in (found, answer_sets(text=text, project=project, engine="clingo")):
        if not listed:
            with pytest.raises(NotFound, match="there is no answer set"):
                each.facets()
            continue
        facets = rows(each)
        assert facets == {atom: facets_by_definition(listed, atom, list(facets)) for atom in facets}


def test_a_chosen_facet_settles_others() -> None:
    facets = rows(answer_sets(text="1 { a; b; c } 1. d :- c. e."))
    half = Fraction(1, 2)
    assert facets["e"] == 1
    assert facets["c"] == facets["d"] == (Fraction(1, 3), 1, 0, Fraction(2, 3), 1, 2, 2, Fraction(1, 3), half)
    assert facets["a"] == (Fraction(1, 3), 1, 0, Fraction(2, 3), 1, 2, 3, Fraction(1, 3), Fraction(1, 4))


def test_facets_of_more_answer_sets_than_any_list() -> None:
    facets = answer_sets(text="{ a(1..300) }. :- a(1), a(2).").facets()
    chosen = {str(symbol): facet.chosen for symbol, facet in facets.items()}
    assert chosen["a(1)"] is not None and chosen["a(3)"] is not None
    assert (chosen["a(1)"].answer_sets, chosen["a(1)"].facets) == (2**298, 298)
    assert (chosen["a(3)"].answer_sets, chosen["a(3)"].facets) == (3 * 2**297, 299)


def test_facets_are_counted_not_weighed() -> None:
    with pytest.raises(QueryError, match="leave out --weighted, or ask for marginals"):
        answer_sets(text="{a}. weight(a,2).", weighted=True).facets()

"""The chosen renaming of a state, and twins, against all permutations tried one by one."""

from __future__ import annotations

import itertools

import clingo
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.logic.step.packed import pack, unpack
from prag_asp.logic.step.transition import Transition
from prag_asp.logic.symmetry.canonical_states import Merging, find_merging
from prag_asp.logic.symmetry.renaming import renamed
from prag_asp.logic.symmetry.term_patterns import read_patterns
from tests.chance import examples
from tests.domains import domain_of

# Every fluent is read, so that each is a variable: of single things, of pairs of things, of a thing and a place.
TEXT = """
class(c). class(d). entity(x(1..4),c). entity(y(1..2),d). thing(X) :- entity(X,c). place(Y) :- entity(Y,d).
fluent((p(X);q(X))) :- thing(X). fluent(r(X,Z)) :- thing(X), thing(Z), X != Z. fluent(s(X,Y)) :- thing(X), place(Y).
fluent(g). initially(F,false) :- fluent(F), F != g. initially(g,true).
action(flip(F)) :- fluent(F). precondition(flip(F),F,false) :- fluent(F). postcondition(flip(F),F,true) :- fluent(F).
"""


def parts() -> tuple[Transition, Merging]:
    model = DomainLogic(domain_of(TEXT))
    transition = model.transition(tasks=False)
    groups = model.symmetries(0).innermost
    assert [len(group) for group in groups] == [4, 2]
    merging = find_merging(transition, groups)
    assert merging is not None
    return transition, merging


TRANSITION, MERGING = parts()
ENTITIES = [entity for group in MERGING.groups for (entity,) in group]
PLACE = {variable: place for place, variable in enumerate(TRANSITION.variables)}
PERMUTATIONS = [(*things, *places) for things in itertools.permutations(range(4)) for places in ((4, 5), (5, 4))]


def permuted(column: np.ndarray, order: tuple[int, ...]) -> np.ndarray:
    """Return the state in which entity j is what entity order[j] was: by renaming terms."""
    names = {ENTITIES[old]: ENTITIES[new] for new, old in enumerate(order)}
    after = column.copy()
    for variable, place in PLACE.items():
        after[PLACE[renamed(variable, names)]] = column[place]
    return after


columns = st.lists(st.sampled_from(range(len(PLACE))), max_size=12).map(
    lambda places: np.isin(np.arange(len(PLACE)), places)
)


@settings(max_examples=examples(40))
@given(columns)
def test_the_order_leads_to_the_chosen_renaming_and_all_renamings_have_the_same(column: np.ndarray) -> None:
    # With 4 and 2 entities no tie of non-twins is left by refinement that no renaming maps onto each other.
    everything = np.stack([permuted(column, order) for order in PERMUTATIONS], axis=1)
    rows, orders = MERGING.canonical(pack(everything))
    assert len(np.unique(rows, axis=0)) == 1
    for place in (0, 17):
        state = unpack(rows, len(PLACE))[:, place]
        assert np.array_equal(state, permuted(everything[:, place], tuple(orders[place].tolist())))
        assert sorted(orders[place][:4].tolist()) == [0, 1, 2, 3] and sorted(orders[place][4:].tolist()) == [4, 5]
        # It does not depend on which states are looked at together.
        assert np.array_equal(MERGING.canonical(pack(everything[:, [place]]))[0][0], rows[0])
    # Twins are those whose swap leaves the state as it is.
    twins = MERGING.twins(rows[:1])[0].tolist()
    for place in range(6):
        order = list(range(6))
        swappable = place not in (0, 4)
        if swappable:
            order[place - 1], order[place] = place, place - 1
        assert twins[place] == (swappable and np.array_equal(permuted(state, tuple(order)), state))


@pytest.mark.parametrize(
    "pairs", [[(0, 1), (2, 3)], [(0, 1), (1, 2), (2, 3), (3, 0)], [(0, 1), (1, 0), (2, 3), (3, 2)]]
)
def test_ties_of_entities_that_are_no_twins_are_broken_the_same_way(pairs: list[tuple[int, int]]) -> None:
    # Pairs, a cycle and two swaps: refinement alone leaves things in ties that no swap of two explains.
    column = np.zeros(len(PLACE), dtype=np.bool_)
    for first, second in pairs:
        told = clingo.parse_term(f"holds(r({ENTITIES[first]},{ENTITIES[second]}),true)")
        column[PLACE[told]] = True
    everything = np.stack([permuted(column, order) for order in PERMUTATIONS], axis=1)
    assert len(np.unique(everything, axis=1).T) > 2
    assert len(np.unique(MERGING.canonical(pack(everything))[0], axis=0)) == 1


def test_patterns_say_where_renamings_are_missing() -> None:
    terms = [clingo.parse_term(text) for text in ("f(a,b)", "f(b,a)", "f(a,a)", "f(b,b)", "g(c)", "h")]
    a, b, c = map(clingo.parse_term, "abc")
    patterns = read_patterns(terms, [[(a,), (b,)]])
    assert patterns is not None and patterns.complete
    assert patterns.arity.tolist() == [2, 2, 1, 1, 0, 0]
    assert patterns.find(patterns.pattern, patterns.entities).tolist() == list(range(6))
    assert patterns.find(patterns.pattern[:1], np.array([[1, 0]])).tolist() == [1]
    for missing in (1, 3):
        left = read_patterns(terms[:missing] + terms[missing + 1 :], [[(a,), (b,)]])
        assert left is not None and not left.complete
    assert read_patterns(terms, [[(a,), (b,)], [(c,)]]).complete  # type: ignore[union-attr]


def test_patterns_with_too_many_codes_for_a_table_are_searched() -> None:
    from prag_asp.logic.symmetry import term_patterns as module

    entities = [clingo.Function(f"e{number}") for number in range(400)]
    units = [(entity,) for entity in entities]
    terms = [clingo.Function("f", list(chosen)) for chosen in itertools.islice(itertools.permutations(entities, 4), 50)]
    patterns = read_patterns(terms, [units])
    assert patterns is not None and module.LARGEST_TABLE < 401**4
    assert patterns.find(patterns.pattern, patterns.entities).tolist() == list(range(50))
    many = [clingo.Function("f", entities[:8])]
    assert read_patterns(many, [units]) is None

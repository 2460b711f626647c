"""Counts, lists, marginals and weights of random programs are those of clingo's enumeration."""

from __future__ import annotations

from collections import Counter
from fractions import Fraction

from hypothesis import given, settings
from hypothesis import strategies as st

from prag_asp import AnswerSets, DomainError, answer_sets
from tests.chance import examples
from tests.models.programs import WEIGHT, loops, program, told_by_clingo


def read(text: str, **how: object) -> AnswerSets | None:
    """Return the answer sets of a program, None where clingo cannot ground it."""
    try:
        return answer_sets(text=text, **how)  # type: ignore[arg-type]
    except DomainError as error:
        assert "unsafe" in str(error), error
        return None


def marginals(told: Counter[tuple[str, ...]]) -> dict[str, Fraction]:
    total = sum(told.values())
    return {
        symbol: Fraction(sum(often for shown, often in told.items() if symbol in shown), total)
        for symbol in {symbol for shown in told for symbol in shown}
    }


@given(program(), st.booleans())
@settings(max_examples=examples(50))
def test_a_program_has_the_answer_sets_that_clingo_finds(text: str, project: bool) -> None:
    told = told_by_clingo(text, project=project)
    found = read(text, project=project, engine="auto")
    if found is None:
        return
    assert found.count() == sum(told.values())
    assert answer_sets(text=text, project=project, engine="clingo").count() == sum(told.values())
    listed = [tuple(map(str, each)) for each in found]
    if project and "#project" in text:  # what is printed then is what is projected on
        assert len(listed) == len(set(listed)) == sum(told.values())
        return
    assert Counter(listed) == told
    if told:
        shares = {str(symbol): share for symbol, share in found.marginals().items() if share}
        assert shares == marginals(told)
        assert {tuple(map(str, each)) for each in found.sample(5, seed=1)} <= set(told)


@given(program())
@settings(max_examples=examples(25))
def test_a_weighted_program_has_the_weights_of_its_atoms(text: str) -> None:
    told = told_by_clingo(text + WEIGHT, project=False, weighted=True)
    found = read(text + WEIGHT, weighted=True)
    if found is None:
        return
    assert found.total() == sum(told.values())
    if sum(told.values()):
        assert {str(symbol): share for symbol, share in found.marginals().items() if share} == {
            symbol: share for symbol, share in marginals(told).items() if share
        }
        assert all(told[tuple(map(str, each))] > 0 for each in found.sample(5, seed=3))


@given(program())
@settings(max_examples=examples(25))
def test_a_diagram_has_as_many_models_as_the_counter(text: str) -> None:
    found = read(text, engine="diagram")
    if found is None or found._reason_to_enumerate:
        return
    told = told_by_clingo(text, project=False)
    assert found.count() == answer_sets(text=text, engine="ganak").count() == sum(told.values())


@given(loops(), st.booleans())
@settings(max_examples=examples(40))
def test_a_program_with_loops_has_the_answer_sets_that_clingo_finds(text: str, project: bool) -> None:
    text += "#show r/1."
    told = told_by_clingo(text, project=project)
    found = answer_sets(text=text, project=project, engine="diagram")
    assert found.count() == sum(told.values())
    if told:
        shares = {str(symbol): share for symbol, share in found.marginals().items() if share}
        assert shares == marginals(told)

"""Counts, lists, marginals and weights of random programs are those of clingo's enumeration."""

from __future__ import annotations

from collections import Counter
from fractions import Fraction

from hypothesis import given, settings
from hypothesis import strategies as st

from prag_asp import AnswerSets, DomainError, answer_sets
from tests.chance import examples
from tests.models.programs import WEIGHT, answer_sets_by_clingo, loops, program


def read(text: str, **how: object) -> AnswerSets | None:
    """Return the answer sets of a program, None where clingo cannot ground it or does so wrongly."""
    try:
        return answer_sets(text=text, **how)  # type: ignore[arg-type]
    except DomainError as error:
        assert "unsafe" in str(error) or "conditional literal in the head" in str(error), error
        return None


def marginals(expected: Counter[tuple[str, ...]]) -> dict[str, Fraction]:
    total = sum(expected.values())
    return {
        symbol: Fraction(sum(often for shown, often in expected.items() if symbol in shown), total)
        for symbol in {symbol for shown in expected for symbol in shown}
    }


@given(program(), st.booleans())
@settings(max_examples=examples(30))
def test_a_program_has_the_answer_sets_that_clingo_finds(text: str, project: bool) -> None:
    expected = answer_sets_by_clingo(text, project=project)
    found = read(text, project=project, engine="auto")
    if found is None:
        return
    assert found.count() == sum(expected.values())
    assert answer_sets(text=text, project=project, engine="clingo").count() == sum(expected.values())
    listed = [tuple(map(str, each)) for each in found]
    if project and "#project" in text:  # what is printed then is what is projected on
        assert len(listed) == len(set(listed)) == sum(expected.values())
        return
    assert Counter(listed) == expected
    if expected:
        shares = {str(symbol): share for symbol, share in found.marginals().items() if share}
        assert shares == marginals(expected)
        assert {tuple(map(str, each)) for each in found.sample(5, seed=1)} <= set(expected)


@given(program())
@settings(max_examples=examples(15))
def test_a_weighted_program_has_the_weights_of_its_atoms(text: str) -> None:
    expected = answer_sets_by_clingo(text + WEIGHT, project=False, weighted=True)
    found = read(text + WEIGHT, weighted=True)
    if found is None:
        return
    assert found.total() == sum(expected.values())
    if sum(expected.values()):
        assert {str(symbol): share for symbol, share in found.marginals().items() if share} == {
            symbol: share for symbol, share in marginals(expected).items() if share
        }
        assert all(expected[tuple(map(str, each))] > 0 for each in found.sample(5, seed=3))


@given(program())
@settings(max_examples=examples(15))
def test_a_diagram_has_as_many_models_as_the_counter(text: str) -> None:
    found = read(text, engine="diagram")
    if found is None or found._reason_to_enumerate:
        return
    expected = answer_sets_by_clingo(text, project=False)
    assert found.count() == answer_sets(text=text, engine="ganak").count() == sum(expected.values())


@given(loops(), st.booleans())
@settings(max_examples=examples(25))
def test_a_program_with_loops_has_the_answer_sets_that_clingo_finds(text: str, project: bool) -> None:
    text += "#show r/1."
    expected = answer_sets_by_clingo(text, project=project)
    found = answer_sets(text=text, project=project, engine="diagram")
    assert found.count() == sum(expected.values())
    if expected:
        shares = {str(symbol): share for symbol, share in found.marginals().items() if share}
        assert shares == marginals(expected)

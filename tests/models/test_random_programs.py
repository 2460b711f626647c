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


@st.composite
def sums(draw: st.DrawFn) -> str:
    """Return a program with sums of repeated, negated and negative terms, which atoms, choices and constraints read."""
    size, rules = draw(st.integers(2, 5)), []
    for place in range(draw(st.integers(1, 4))):
        terms = st.tuples(st.sampled_from([-2, 1, 2, 3]), st.sampled_from(["", "not "]), st.integers(1, size))
        drawn = draw(st.lists(terms, min_size=2, max_size=6))
        elements = ";".join(f"{weight},{at}:{sign}x({atom})" for at, (weight, sign, atom) in enumerate(drawn))
        head = draw(st.sampled_from(["", f"y({place})", f"{{y({place}); y(9)}}", f"1 {{x(1); y({place})}} 1"]))
        rules.append(
            f"{head} :- #sum{{{elements}}} {draw(st.sampled_from(['>=', '=', '!=']))} {draw(st.integers(-1, 8))}."
        )
    return " ".join([f"{{x(1..{size})}}.", *rules, draw(st.sampled_from(["", "#show y/1."]))])


@given(sums(), st.booleans())
@settings(max_examples=examples(40))
def test_a_program_with_sums_has_the_answer_sets_that_clingo_finds(text: str, project: bool) -> None:
    expected = answer_sets_by_clingo(text, project=project)
    found = read(text, project=project, engine="diagram")
    if found is None or found._compiled.no_clauses:
        return
    assert found.count() == sum(expected.values())
    if expected and not project:
        assert {str(symbol): share for symbol, share in found.marginals().items() if share} == marginals(expected)

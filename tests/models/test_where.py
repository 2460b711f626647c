"""Choices keep the answer sets that show some symbols and lack others, by each engine and for each query."""

from __future__ import annotations

from collections import Counter
from fractions import Fraction
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from prag_asp import AnswerSets, QueryError, answer_sets
from prag_asp.errors import NotFound
from tests.chance import examples
from tests.models.programs import answer_sets_by_clingo, loops, program
from tests.models.test_random_programs import read

ASPIF = """asp 1 0 0
1 1 3 1 2 3 0 0
1 0 1 4 1 2 3 1 1 2 1 3 1
1 0 0 0 1 -4
4 1 a 1 1
4 4 both 2 1 2
4 1 c 1 3
0
"""


def agrees(shown: tuple[str, ...], literals: list[str]) -> bool:
    return all((each.removeprefix("not ") in shown) != each.startswith("not ") for each in literals)


@given(st.one_of(program(), loops()), st.booleans(), st.data())
@settings(max_examples=examples(6))
def test_choices_keep_what_clingo_finds_with_them(text: str, project: bool, data: st.DataObject) -> None:
    found = read(text, project=project)
    if found is None or (project and "#project" in text):  # clingo prints more than what is projected on
        return
    expected = answer_sets_by_clingo(text, project=project)
    symbols = sorted({symbol for shown in expected for symbol in shown})
    if not symbols:
        return
    literal = st.builds(str.__add__, st.sampled_from(["", "not "]), st.sampled_from(symbols))
    literals = data.draw(st.lists(literal, min_size=1, max_size=3))
    left = Counter({shown: often for shown, often in expected.items() if agrees(shown, literals)})
    compiled = read(text, project=project)
    assert compiled is not None
    compiled.compile()
    for whole in (found, compiled, answer_sets(text=text, project=project, engine="clingo")):
        each = whole.where(*literals)
        assert each.count() == sum(left.values())
        assert Counter(tuple(map(str, shown)) for shown in each) == left
        if left:
            shares = {str(symbol): facet.share for symbol, facet in each.facets().items() if facet.share}
            assert shares == shares_of(left)
            assert {tuple(map(str, shown)) for shown in each.sample(4, seed=1)} <= set(left)
        else:
            with pytest.raises(NotFound):
                each.marginals()
    assert (found.where(*literals).explain() is None) == bool(left)


def shares_of(left: Counter[tuple[str, ...]]) -> dict[str, Fraction]:
    total = sum(left.values())
    symbols = {symbol for shown in left for symbol in shown}
    return {
        symbol: Fraction(sum(often for shown, often in left.items() if symbol in shown), total) for symbol in symbols
    }


def both(text: str, **how: object) -> list[AnswerSets]:
    """Return the answer sets of a text with and without a compiled diagram, and by clingo."""
    compiled = answer_sets(text=text, **how)  # type: ignore[arg-type]
    assert compiled.compile()
    return [answer_sets(text=text, **how), compiled, answer_sets(text=text, engine="clingo", **how)]  # type: ignore[arg-type]


def test_choices_among_optimal_answer_sets_do_not_change_the_optimum() -> None:
    for found in both("1 { a; b; c }. #minimize { 1,X : X = 1, a; 1,X : X = 2, b; 3,3 : c }.", optimal=True):
        assert found.count() == 2
        assert found.where("a").count() == 1
        assert found.where("c").count() == 0
        assert found.where("c").explain() is None  # without the optimum, there is an answer set


def test_projections_on_atoms_can_be_chosen() -> None:
    for found in both("{ a; b; c }. :- a, b. #show c/0. #project a/0. #project b/0.", project=True):
        assert found.count() == 3
        assert found.where("not a").count() == 2
        assert [str(each) for (each,) in found.where("not a", "b")] == ["b"]
        conflict = found.where("a", "b").explain()
        assert conflict is not None
        assert [str(line) for line in conflict.lines] == ["<text>:1: :- a, b.", "<where>:1: a", "<where>:2: b"]


def test_symbols_of_ground_programs_can_be_chosen() -> None:
    for found in both(ASPIF):
        assert (found.count(), found.where("both").count(), found.where("not both").count()) == (4, 2, 2)
        conflict = found.where("not both", "not c").explain()
        assert conflict is not None
        assert [str(line) for line in conflict.lines][-2:] == ["<where>:1: not both", "<where>:2: not c"]


def test_choices_scale_the_total_weight() -> None:
    text = "{ h(1..3) }. :- h(1), h(2), h(3). weight(h(1),2). weight(h(2),(1,3)). #show h/1."
    for found in both(text, weighted=True):
        assert found.where("h(1)", "not h(2)").total() == 4
        assert found.where("h(1)").where("h(2)").total() == Fraction(2, 3)


def test_choices_narrow_more_answer_sets_than_any_list() -> None:
    whole = answer_sets(text="{ a(1..300) }. :- a(1), a(2).")
    whole.compile()
    assert whole.where("a(1)").count() == 2**298
    assert whole.where("a(1)", "not a(3)", "a(1)").choices == whole.where("a(1)").where("not  a(3)").choices
    assert whole.where() is whole


@pytest.mark.parametrize(
    ("literal", "problem"),
    [("q(1)", "no shown atom 'q.1.'"), ("p(", "not a literal"), ("", "not a literal"), ("not", "no shown atom"),
     ("p(4)", "did you mean"), ("not not p(1)", "not a literal"), (f"{'f(' * 9999}", "not a literal|too deep")],
)  # fmt: skip
def test_wrong_literals_are_one_line(literal: str, problem: str) -> None:
    found = answer_sets(text="{ p(1..3) }. { q(1) }. #show p/1.")
    with pytest.raises(QueryError, match=problem) as error:
        found.where("p(1)", literal)
    assert len(error.value.lines) == 1


def test_the_command_keeps_what_is_chosen(tmp_path: Path) -> None:
    from tests.commands import ok, run

    (tmp_path / "few.lp").write_text("1 { a; b; c } 2.\n:- a, b.\n")
    few = str(tmp_path / "few.lp")
    assert ok("models", "count", few, "--where", "c", "--where", "not a") == "2\n"
    assert ok("models", "list", few, "--where", "a") == "a c\na\n"
    done = run("models", "explain", few, "--where", "a", "--where", "b")
    assert (done.returncode, done.stdout.splitlines()[-3:]) == (
        1, [f"  {few}:2: :- a, b.", "  <where>:1: a", "  <where>:2: b"],
    )  # fmt: skip
    assert "no shown atom 'd'" in run("models", "count", few, "--where", "d").stderr

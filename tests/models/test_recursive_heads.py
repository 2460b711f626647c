"""Conditional literals in heads are counted rightly, or refused by their line where clingo grounds them wrongly."""

from __future__ import annotations

from pathlib import Path

import pytest

from prag_asp import DomainError, answer_sets
from tests.chance import Chance
from tests.models.here_and_there import Conditional, ConditionalRule, answer_sets_here_and_there, random_rules

REASON = "a conditional literal in the head is not supported where a condition of the rule reads"


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("a.\nb :- a.\na: a :- b.", 3),
        ("a.\nb :- a: a; a.\na: a :- b.", 3),
        ("c.\nc: c :- c.", 2),
        ("d; c.\nd: d :- d.", 2),
        ("{a}.\nb :- a.\na: a; c :- b.", 3),
        ("b: not b :- b: b.\n{b}.", 1),
        ("a(1). a(2).\nb(X) :- a(X).\n\na(X+2): a(X), X < 3 :- b(1).", 4),
        ("a. {b} :- c.\nc :- a: a.\na: d :- b: c.", 3),
        ("-a. b :- -a.\n-a: -a :- b.", 2),
        ("reach(1). next(1,2). ok :- reach(1).\nreach(Y): reach(X), next(X,Y); stuck :- ok.", 2),
    ],
)
def test_a_condition_that_depends_on_its_own_head_is_refused_by_its_line(text: str, line: int, tmp_path: Path) -> None:
    (tmp_path / "given.lp").write_text(text)
    with pytest.raises(DomainError) as error:
        answer_sets(tmp_path / "given.lp", engine="clingo")
    (message,) = error.value.lines
    assert message.startswith(f"{tmp_path / 'given.lp'}:{line}: {REASON}")


@pytest.mark.parametrize(
    ("text", "count"),
    [
        ("day(1..2). on(X): day(X) :- meet. {free}. meet :- free: person(1). person(1).", 3),
        ("at(a,b). {out(b)}. in(Y): at(Y,X) :- out(X). out(X) :- in(Y), at(Y,X).", 2),
        ("{s(X): t(X)} :- b. t(X) :- s(X). b. t(1..2).", 4),
        ("{b}. a: b; c.", 3),
        ("r(1..2,1..2). o(X) :- r(X,_); r(X,Y): t(Y). t(Y) :- r(_,Y); r(X,Y): o(X).", 1),
    ],
)
def test_other_conditional_literals_are_counted(text: str, count: int) -> None:
    assert answer_sets(text=text).count() == count


def test_random_programs_with_conditional_literals_have_the_answer_sets_of_here_and_there(chance: Chance) -> None:
    source, refused = chance.generator(1), 0
    assert answer_sets_here_and_there([ConditionalRule((Conditional("a"),), (Conditional("not b"),))]) == ["a"]
    tries = chance.examples(250)
    for _ in range(tries):
        rules = list(random_rules(source))
        text = "\n".join(map(str, rules))
        try:
            found = answer_sets(text=text)
        except DomainError as error:
            assert REASON in str(error), text
            refused += 1
            continue
        expected = answer_sets_here_and_there(rules)
        assert found.count() == len(expected), text
        assert sorted("".join(map(str, each)) for each in found) == expected, text
    assert refused < tries / 2

"""Programs that are unreadable or unsupported are refused by file and line; what clingo ignores is ignored."""

from __future__ import annotations

from pathlib import Path

import clingo
import pytest

from prag_asp import DomainError, EngineError, QueryError, answer_sets
from tests.commands import run


@pytest.mark.parametrize(
    ("text", "line", "reason"),
    [
        ("a.\n#minimize { 1 : a }.", 2, "#minimize is not supported"),
        ("a.\n\n:~ a. [1]", 3, "weak constraint"),
        ("a :-\n &sum { x } > 0.", 2, "theory atom &sum is not supported"),
        ("#theory t { }.", 1, "#theory t is not supported"),
        ("#script (python) def f(): return 1 #end.", 1, "#script is not supported"),
        ("a.\n#include <incmode>.", 2, "#include <incmode> is not supported because it is a script"),
        ("a.\nb(X) :- a.", 2, "unsafe variable X"),
        ("a.\nb :- ,.", 2, "unexpected ,"),
        ("a(1).\nb(X+2147483647) :- a(X).", 2, "out of range"),
        ("n(0).\nn(X+1) :- n(X).", 2, "without end"),
        ("a.\nb(@f(1)) :- a.", 2, "the function @f is not supported"),
    ],
)
def test_what_is_not_supported_is_refused_by_its_name_and_line(
    text: str, line: int, reason: str, tmp_path: Path
) -> None:
    file = tmp_path / "given.lp"
    file.write_text(text)
    with pytest.raises(DomainError) as error:
        answer_sets(file)
    (message,) = error.value.lines
    assert message.startswith(f"{file}:{line}: ") and reason in message


def test_constants_are_set_whether_they_are_declared_or_not_if_the_program_reads_them() -> None:
    assert answer_sets(text="#const n=2. {a(1..n)}.", constants={"n": 5}).count() == 32
    assert answer_sets(text="{a(1..n)}.", constants={"n": 6}).count() == 64
    assert answer_sets(text="#const m=n. {a(1..m)}.", constants={"n": 3}).count() == 8
    with pytest.raises(DomainError, match="constant m: nothing in the program reads it; did you mean mm"):
        answer_sets(text="#const mm=2. {a(1..mm)}.", constants={"m": 5})
    for text in ("{n(1..3)}.", "{n}. #show n/0.", "{a(n(1))}.", '{a("n")}. % n'):
        with pytest.raises(DomainError, match="constant n: nothing in the program reads it"):
            answer_sets(text=text, constants={"n": 3})


def test_what_has_no_bearing_on_answer_sets_is_ignored_and_an_external_is_false() -> None:
    text = "{a;b}. #heuristic a. [1,true] #external c. :- c. d :- not c. #program step(t). e(t)."
    assert answer_sets(text=text).count() == 4
    assert {str(each) for each in next(iter(answer_sets(text=text)))} == {"a", "b", "d"}


@pytest.mark.parametrize(
    ("derives", "count"), [("{q} :- not q.", 4), ("q :- b. :- b.", 2), (":- b. q :- b.", 2), ("q :- b.", 2), ("q.", 2)]
)
def test_an_external_that_a_rule_derives_is_what_clingo_takes_it_for(derives: str, count: int) -> None:
    text = f"{{b}}. #external q. [free] {derives}"
    control = clingo.Control(["0"])
    control.add("base", [], text)
    control.ground([("base", [])])
    with control.solve(yield_=True) as models:
        by_clingo = sorted(tuple(map(str, sorted(model.symbols(shown=True)))) for model in models)
    notes: list[str] = []
    found = answer_sets(text=text, tell=notes.append)
    assert sorted(tuple(map(str, each)) for each in found) == by_clingo
    assert found.count() == len(by_clingo) == count
    if ":-" in derives:
        assert notes == [
            "a rule derives q, which is #external and not false: "
            "clingo enumerates, which takes time for each answer set"
        ]
        with pytest.raises(QueryError, match="choose the engine clingo"):
            answer_sets(text=text, engine="diagram").count()


def test_a_graph_that_has_to_be_acyclic_is_left_to_clingo_and_that_is_reported() -> None:
    notes: list[str] = []
    found = answer_sets(text="{e(1,2); e(2,1)}. #edge (X,Y) : e(X,Y).", tell=notes.append)
    assert found.count() == 3 and len(list(found.sample(5))) == 5
    assert notes == ["#edge requires a graph without cycles: clingo enumerates, which takes time for each answer set"]
    with pytest.raises(QueryError, match="choose the engine clingo"):
        answer_sets(text="{e(1,2); e(2,1)}. #edge (X,Y) : e(X,Y).", engine="ganak").count()


def test_files_are_one_program_and_include_others(tmp_path: Path) -> None:
    (tmp_path / "one.lp").write_text('#include "two.lp". {a}.')
    (tmp_path / "two.lp").write_text("{b} :- a.")
    (tmp_path / "three.lp").write_text(":- not a.")
    assert answer_sets(tmp_path / "one.lp").count() == 3
    assert answer_sets(tmp_path / "one.lp", tmp_path / "three.lp").count() == 2


def test_answer_sets_come_in_an_order_that_is_always_the_same() -> None:
    listed = [" ".join(map(str, each)) for each in answer_sets(text="1 {c;a;b} 2.")]
    assert listed == ["a b", "a c", "a", "b c", "b", "c"]
    assert list(answer_sets(text="a :- not a.")) == []
    assert list(answer_sets(text="#show.")) == [()]


def test_without_the_counter_a_diagram_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("prag_asp.logic.formula.counter.find_spec", lambda name: None)
    assert answer_sets(text="{a(1..50)}. :- a(1), a(2).").count() == 3 * 2**48
    with pytest.raises(EngineError, match="engine ganak: the package pyganak is missing; pip install"):
        answer_sets(text="{a}.", engine="ganak").count()


class _Enough(Exception):
    """What ends a count that would never end."""


def test_clingo_tells_on_the_way_how_many_answer_sets_there_are_at_least() -> None:
    for text, project in (("{a(1..80)}.", False), ("{a(1..80)}. #show t(X) : a(X). #show t(X) : a(X), a(1).", True)):
        lines: list[str] = []

        def tell(words: str, lines: list[str] = lines) -> None:
            lines.append(words)
            if len(lines) == 3:
                raise _Enough

        with pytest.raises(_Enough):
            answer_sets(text=text, project=project, engine="clingo", progress=tell).count()
        bounds = [int(words.split()[2].replace(",", "")) for words in lines]
        assert 0 < bounds[0] <= bounds[1] <= bounds[2] < 2**80
        assert lines == [f"at least {bound:,} answer set{'s' if bound > 1 else ''}" for bound in bounds]


@pytest.mark.parametrize(
    ("more", "note"),
    [
        ("", ""),
        ("weight(heads(3),3).", "no rule derives heads(3), so its weight has no effect; did you"),
        (
            "weight(x,3). weight(y,3). weight(z,0).",
            "no rule derives x, so its weight has no effect, and 2 other ",
        ),
    ],
)
def test_a_weight_of_an_atom_that_no_rule_derives_is_noted(more: str, note: str, tmp_path: Path) -> None:
    (tmp_path / "coins.lp").write_text(f"{{heads(1..2)}}. weight(heads(1),2).\n{more}")
    notes: list[str] = []
    assert answer_sets(tmp_path / "coins.lp", weighted=True, tell=notes.append).total() == 6
    weighed = [note for note in notes if "no rule derives" in note]
    assert len(weighed) == bool(note)
    assert all(each.startswith(f"{tmp_path / 'coins.lp'}:2: {note}") for each in weighed)


def test_atoms_that_no_rule_derives_are_noted_once_by_their_line_unless_that_is_allowed(tmp_path: Path) -> None:
    file = tmp_path / "given.lp"
    file.write_text(
        "{b}. a :- c(X), b, not e.\nd :- e. % lint: allow undefined\n"
        "d :- k(X), not f(X*X+1), not f(X*X+1). k(1).\n#defined g/0. d :- g."
    )
    assert answer_sets(file).ground.remarks == (
        f"{file}:1: info: atom does not occur in any rule head: c(X) [undefined]",
        f"{file}:1: info: atom does not occur in any rule head: e [undefined]",
        f"{file}:3: info: atom does not occur in any rule head: f((((X*X)+1))) [undefined]",
    )
    shown = run("models", "count", str(file))
    assert shown.stdout == "2\n"
    assert shown.stderr.splitlines() == [*answer_sets(file).ground.remarks]

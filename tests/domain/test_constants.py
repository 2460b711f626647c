"""``#const``s set from outside: every reader of a domain sees the value that its text would have had."""

from __future__ import annotations

import io
import re
from pathlib import Path

import clingo
import pytest

from prag_asp import TaskSpace, load_domain
from prag_asp.dataset.jsonl import Record, read_lines, write_line
from prag_asp.errors import DomainError
from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.logic.formula.cnf import dimacs
from prag_asp.program.constants import Constant
from prag_asp.program.paths import shipped_domains
from prag_asp.space.engines import LEVELS, automaton_engine
from prag_asp.space.engines.stored_automata import automaton_slot
from prag_asp.space.engines.word_formula import word_formula

HANOI = (shipped_domains()["hanoi"] / "domain.lp").read_text(encoding="utf-8")
LAMPS = """
class(lamp).
entity(lamp(1..lamps), lamp).
fluent(lit(L)) :- is_a(L,lamp).
action(press(L)) :- is_a(L,lamp).
postcondition(press(L), lit(L), true) :- action(press(L)).
label(word). written(L) :- label(L). initially(lit(L), false) :- is_a(L,lamp), written(_).
"""


def edited(discs: int) -> str:
    return HANOI.replace("#const discs = 3.", f"#const discs = {discs}.")


@pytest.fixture(scope="module")
def edited_words() -> dict[tuple[int, str], list[object]]:
    """Return what the edited text has for some numbers of discs, by level, as the automaton enumerates it."""
    spaces = {discs: TaskSpace(load_domain(text=edited(discs)), 3, engine="automaton") for discs in (1, 2, 4)}
    return {(discs, level): list(space.enumerate(level)) for discs, space in spaces.items() for level in LEVELS}


@pytest.mark.parametrize("engine", ["automaton", "clingo", "sat", "sharp", "symbolic"])
def test_every_engine_counts_what_the_edited_text_has(
    engine: str, edited_words: dict[tuple[int, str], list[object]]
) -> None:
    for discs in (1, 2, 4):
        space = TaskSpace(load_domain("hanoi", constants={"discs": discs}), 3, engine=engine)
        for level in LEVELS:
            words = edited_words[discs, level]
            assert space.count(level) == len(words)
            assert list(space.enumerate(level)) == words


def test_the_number_of_walks_is_that_of_the_graph_with_so_many_discs() -> None:
    def walks(discs: int, length: int) -> int:
        """Count sequences of moves by hand: a disc moves onto a peg where no smaller one stands."""
        found = [(0,) * discs]
        for _ in range(length):
            found = [
                (*state[:disc], peg, *state[disc + 1 :])
                for state in found
                for disc in range(discs)
                for peg in range(3)
                if peg != state[disc] and not {state[disc], peg} & set(state[:disc])
            ]
        return len(found)

    for discs in (1, 2, 3, 5):
        space = TaskSpace(load_domain("hanoi", constants={"discs": discs}), 0)
        assert [space.at(length).count("plan") for length in range(6)] == [walks(discs, length) for length in range(6)]


def test_the_clauses_of_an_export_and_a_condition_see_the_value() -> None:
    formulas = [
        list(dimacs(word_formula(DomainLogic(domain), "task", 2).cnf, []))
        for domain in (load_domain("hanoi", constants={"discs": 2}), load_domain(text=edited(2)))
    ]
    assert formulas[0] == formulas[1]
    space = TaskSpace(load_domain("hanoi", constants={"discs": 5}), 1)
    assert space.where("uses disc(5)").count() == 0
    assert space.at(9).where("uses disc(4)").count() > 0


@pytest.mark.parametrize(
    ("value", "written"),
    [
        (4, "4"), ("4", "4"), (" 2+2 ", "4"), (-3, "-3"), ("f(x, 1)", "f(x,1)"), ('"a b"', '"a b"'), ("(1,2)", "(1,2)"),
        (clingo.Function("red"), "red"), (clingo.String("é"), '"é"'),
    ],
)  # fmt: skip
def test_a_value_is_any_term(value: Constant, written: str) -> None:
    domain = load_domain(text=LAMPS + "#const lamps = 2. #const word = none.", constants={"word": value})
    assert domain.constants == {"word": written}
    assert domain.label == f"text (word={written})"
    assert f"#const word = {written}." in domain.program.text


@pytest.mark.parametrize(
    "value", ["X", "1..3", "f(", "", "a b", "a;b", "é", "a\0b", "1/0", "@f(1)", "4.", "(" * 9999, True]
)
def test_a_value_that_is_no_term_is_refused(value: Constant) -> None:
    with pytest.raises(
        DomainError, match=r"(?s)^constant discs: .* is not a term; write a number such as 8, or a term"
    ):
        load_domain("hanoi", constants={"discs": value})


@pytest.mark.parametrize(
    ("text", "name", "message"),
    [
        (HANOI, "disc", "constant disc: text has no such #const; did you mean discs?"),
        (HANOI, "n", "constant n: text has no such #const; there is discs"),
        (
            f"{LAMPS}#const word = a. #const lamps = 1.", "n",
            "constant n: text has no such #const; there are lamps, word",
        ),
        (LAMPS.replace("lamps", "2"), "n", "constant n: text has no such #const; declare it there with #const n = ..."),
        (HANOI, "true", "constant true: text has no such #const; there is discs"),
        (
            f"{HANOI}\n#const true = 1.", "true",
            "<text>:22: #const true would change what true means; choose another name",
        ),
        (
            HANOI.replace("discs = 3.", "discs = 3. [override]"), "discs",
            "<text>:5: #const discs says [override], so it cannot be set; remove [override]",
        ),
    ],
)  # fmt: skip
def test_a_constant_that_cannot_be_set_is_reported(text: str, name: str, message: str) -> None:
    with pytest.raises(DomainError) as caught:
        load_domain(text=text, constants={name: 2})
    assert str(caught.value) == message


def test_a_constant_is_set_wherever_it_is_declared_and_others_follow_it(tmp_path: Path) -> None:
    (tmp_path / "sizes.lp").write_text("#const lamps = 2.", encoding="utf-8")
    (tmp_path / "domain.lp").write_text(f'#include "sizes.lp".\n{LAMPS}#const word = a.', encoding="utf-8")
    assert len(load_domain(tmp_path, constants={"lamps": 5}).facts.entities) == 5
    assert len(load_domain(tmp_path).facts.entities) == 2
    text = LAMPS + "#const lamps = half * 2. #const half = 1. #const word = a."
    assert len(load_domain(text=text, constants={"half": 3}).facts.entities) == 6


def test_lines_stay_where_they_are() -> None:
    parts = ['%* ü *% #const lamps\n = f(x,\n "é"). ', "#const word = a. ", "unread(1).\n"]
    for order in (parts, [parts[1], parts[0], parts[2]]):
        text = LAMPS + "".join(order)
        with pytest.raises(DomainError) as caught:
            load_domain(text=text, constants={"lamps": 3, "word": "b"}, strict=True)
        line = text[: text.index("unread")].count("\n") + 1
        assert re.match(rf"<text>:{line}: no rule reads unread/1", str(caught.value))
        domain = load_domain(text=text.replace("unread(1).", ""), constants={"lamps": 3, "word": "b"})
        assert len(domain.facts.entities) == 3 and "#const word = b." in domain.program.text


def test_tasks_carry_the_constants_they_were_made_with_and_lines_have_them_only_then() -> None:
    plain = TaskSpace(load_domain("hanoi"), 2)[0]
    own = TaskSpace(load_domain("hanoi", constants={"discs": 3}), 2)[0]
    assert plain.constants == {} and own.constants == {"discs": "3"}
    assert plain != own and hash(own) == hash(TaskSpace(load_domain("hanoi", constants={"discs": "3"}), 2)[0])
    line = write_line(Record(own))
    assert line.replace('"constants":{"discs":"3"},', "") == write_line(Record(plain))
    (read,) = read_lines(io.StringIO(line), "tasks")
    assert read.task == own


def test_a_cached_automaton_of_one_value_is_never_used_for_another(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PRAG_ASP_CACHE", str(tmp_path))
    monkeypatch.setattr(automaton_engine, "WORTH_KEEPING", -1.0)
    for _ in range(2):
        counts = [TaskSpace(load_domain("hanoi", constants={"discs": discs}), 6).count() for discs in (1, 2, 3)]
        assert counts == sorted(set(counts))
    assert len(list(tmp_path.iterdir())) == 3
    keys = {
        shelf.key
        for domain in (load_domain("hanoi"), load_domain("hanoi", constants={"discs": 3}))
        if (shelf := automaton_slot(tmp_path, DomainLogic(domain), "task", None))
    }
    assert len(keys) == 1  # the same program

"""A message is one line that a terminal prints and does not obey, however long and strange what it quotes."""

from __future__ import annotations

import pickle

from prag_asp.errors import LONGEST, DomainError, QueryError, one_line, plain


def test_what_a_terminal_would_obey_is_spelled_as_in_python() -> None:
    assert plain("a\x1b[31mb\x07\x9b\u202ec\u2028\n\r\t\x00\ud800") == (
        r"a\x1b[31mb\x07\x9b\u202ec\u2028\n\r\t\x00\ud800"
    )
    assert plain("déjà vu ♥ 日本 \\n 'x'") == "déjà vu ♥ 日本 \\n 'x'"
    assert plain(plain("\n")) == plain("\n")


def test_a_long_message_keeps_where_it_is_and_what_to_do() -> None:
    text = f"domain.toml:7: {'x' * 5000}: unknown key; did you mean title?"
    line = one_line(text)
    assert len(line) == LONGEST
    assert line.startswith("domain.toml:7: x") and line.endswith("x: unknown key; did you mean title?")
    assert one_line("y" * LONGEST) == "y" * LONGEST


def test_each_problem_of_an_error_is_a_line_of_its_own() -> None:
    error = DomainError("a:1: one\ntwo; x", "a:2: three; y")
    assert error.lines == (r"a:1: one\ntwo; x", "a:2: three; y")
    assert str(error) == "a:1: one\\ntwo; x\na:2: three; y"
    assert pickle.loads(pickle.dumps(error)).lines == error.lines


def test_an_error_that_is_raised_again_says_the_same() -> None:
    error = QueryError(f"no \x1b[2J{'z' * 1000}")
    assert str(QueryError(str(error))) == str(error) and len(str(error)) == LONGEST

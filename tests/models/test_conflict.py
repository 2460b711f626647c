"""Lines that exclude every answer set: together they do, and lifting any one of them leaves an answer set."""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence
from pathlib import Path
from random import Random

import clingo
import pytest

from prag_asp import answer_sets
from prag_asp.models.questions import conflict
from tests.chance import Chance

PIGEONS = """pigeon(1..4). hole(1..3).
{ in(P,H) : hole(H) } = 1 :- pigeon(P).
:- in(P,H), in(Q,H), P < Q.
{ light }.
:- light, in(1,1).
"""


def lines_of(text: str) -> list[tuple[int, str]]:
    found = answer_sets(text=text).explain()
    assert found is not None and found.minimal
    return [(each.line, each.text) for each in found.lines]


@pytest.mark.parametrize(
    ("text", "lines"),
    [
        (PIGEONS, [2, 3]),
        ("a.\n:- a.", [2]),
        ("a :- not a.", [1]),
        ("{ a }.\n:- a.\n:- not a.\nb :- a.", [2, 3]),
        (":- not goal.\ngoal :- p(5).\np(1..4).", [1, 2]),
        ("a.\n-a.\nb.", [1, 2]),
        ("{ a; -a }.\na.\nb :- a.\n-a :- b.\nc.", [2, 3, 4]),
        ("a; b.\n:- a.\n:- b.\n{ c }.", [1, 2, 3]),
        ("{ a(X) : X = 1..3 } = 1.\n:- a(1).\n:- a(X), X > 1.\n:- a(2).", [1, 2, 3]),
        ("not a.\na :- not b.\nb :- not a.\n:- b.", [1, 3, 4]),
        ("{ a }.\n:- a,\n   a.\n:- not\n   a. { c }.", [2, 4]),
    ],
)
def test_the_lines_of_a_program_without_answer_sets_are_named(text: str, lines: list[int]) -> None:
    assert [line for line, _ in lines_of(text)] == lines


def test_a_line_has_the_text_of_its_author_and_its_file(tmp_path: Path) -> None:
    (tmp_path / "more.lp").write_text(":- b,\n   not c.  % never\n")
    (tmp_path / "one.lp").write_text('#include "more.lp".\n{ a }. b :- a. :- not b.\n')
    found = answer_sets(tmp_path / "one.lp").explain()
    assert found is not None
    assert [str(each) for each in found.lines] == [
        f"{tmp_path}/more.lp:1: :- b, not c.",
        f"{tmp_path}/one.lp:2: :- not b.",
    ]


def satisfiable(rules: Sequence[tuple[str, str]], kept: Sequence[int]) -> bool:
    """Return whether there is an answer set if some rules are kept, and the atoms of the other heads are free."""
    heads = [head.replace("{", "").replace("}", "") for head, _ in rules]
    texts = [
        f"{head} :- {body}." if place in kept else f"{{ {heads[place]} }}." if head else ""
        for place, (head, body) in enumerate(rules)
    ]
    control = clingo.Control(logger=lambda *_: None)
    control.add("base", [], " ".join(texts))
    control.ground([("base", [])])
    return bool(control.solve().satisfiable)


def data_of(rules: Sequence[tuple[str, str]]) -> list[int]:
    """Return the rules whose heads are facts to clingo."""
    control = clingo.Control(logger=lambda *_: None)
    control.add("base", [], " ".join(f"{head} :- {body}." for head, body in rules))
    control.ground([("base", [])])
    facts = {str(atom.symbol) for atom in control.symbolic_atoms if atom.is_fact}
    return [place for place, (head, _) in enumerate(rules) if head and set(head.strip("{}").split("; ")) <= facts]


def random_rules(random: Random) -> list[tuple[str, str]]:
    """Return rules of a few atoms as heads and bodies, which often exclude every answer set."""
    rules = [("{a; b}", "#true")]
    for _ in range(random.randint(5, 10)):
        literals = [random.choice(("", "not ")) + random.choice("abcdef") for _ in range(random.randint(1, 2))]
        head = random.choice(("", "", "{c}", "e; f", *"abcdef"))
        rules.append((head, ", ".join(literals)))
    return rules


def test_the_lines_are_a_minimal_set_by_an_independent_definition(chance: Chance) -> None:
    random, explained = chance.generator(5), 0
    while explained < chance.examples(25):
        rules = random_rules(random)
        text = "\n".join(f"{head} :- {body}." for head, body in rules)
        found = answer_sets(text=text).explain()
        assert (found is None) == satisfiable(rules, range(len(rules))), text
        if found is None:
            continue
        explained += 1
        kept = [each.line - 1 for each in found.lines]
        data = [line for line in data_of(rules) if line not in kept]
        if all(line in data_of(rules) for line in kept):  # data alone exclude every answer set
            data = []
        assert not satisfiable(rules, [*kept, *data]), text
        for line in kept:
            assert satisfiable(rules, [*data, *(other for other in kept if other != line)]), text


def test_a_solver_that_gives_up_leaves_a_set_that_may_not_be_minimal(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(conflict, "CONFLICTS", 0)
    found = answer_sets(text=PIGEONS).explain()
    assert found is not None and not found.minimal and {2, 3} <= {each.line for each in found.lines}


def test_a_program_with_answer_sets_has_nothing_to_explain() -> None:
    assert answer_sets(text="{a}. :- a.").explain() is None
    assert answer_sets(text="asp 1 0 0\n1 1 1 1 0 0\n0\n").explain() is None


@pytest.mark.parametrize(
    ("lines", "explained"),
    [
        ("1 0 0 0 0", ["3: :- ."]),
        ("1 0 1 1 0 1 -1", ["3: a :- not a."]),
        ("1 1 2 1 9 0 0;1 0 0 0 1 1;6 1 1", ["4: :- a.", "5: :- not a."]),
        ("1 1 2 1 9 0 0;6 2 1 -1", ["4: :- not a. :- a."]),
        ("1 1 2 1 2 0 0;1 0 1 8 1 3 2 1 2 2 1;1 0 0 0 1 -8", [
            "4: x_8 :- #sum { 2,1 : a; 1,2 : b } >= 3.", "5: :- not x_8.", "6: :- b.",
        ]),
        ("1 1 1 1 0 1 9;6 1 1", ["3: { a } :- x_9.", "4: :- not a."]),
        ("1 0 1 1 0 0;1 0 0 0 1 1", ["4: :- a."]),
        ("1 0 2 1 2 0 0;1 0 0 0 1 1", ["3: a; b.", "4: :- a.", "5: :- b."]),
        ("1 1 2 1 9 0 0;5 8 2;1 0 0 0 1 -8", ["5: :- not x_8."]),
        ("1 1 2 1 9 0 0;8 0 1 1 1;8 1 0 1 9;6 2 1 9", ["6: :- not a. :- not x_9."]),
    ],
)  # fmt: skip
def test_the_lines_of_a_ground_program_are_named_and_spelled_as_rules(lines: str, explained: list[str]) -> None:
    text = "\n".join(["asp 1 0 0", "4 1 a 1 1", *lines.split(";"), "1 0 0 0 1 2", "4 1 b 1 2", "0\n"])
    found = answer_sets(text=text).explain()
    assert found is not None and found.minimal
    assert [str(each).removeprefix("<text>:") for each in found.lines] == explained


def test_random_ground_programs_are_explained_by_a_minimal_set_of_lines(chance: Chance) -> None:
    random, explained = chance.generator(7), 0
    while explained < chance.examples(25):
        lines = random_ground_lines(random)
        found = answer_sets(text="\n".join(["asp 1 0 0", *lines, "0\n"])).explain()
        everything = set(range(len(lines)))
        assert (found is None) == ground_satisfiable(lines, everything), lines
        if found is None:
            continue
        explained += 1
        kept = {each.line - 2 for each in found.lines}
        facts = {place for place, line in enumerate(lines) if re.fullmatch(r"1 0 1 \d 0 0", line)} - kept
        if not any(re.fullmatch(r"1 0 1 \d 0 0", lines[place]) is None for place in kept):
            facts = set()
        assert found.minimal and not ground_satisfiable(lines, kept | facts), lines
        for line in kept:
            assert ground_satisfiable(lines, (kept | facts) - {line}), lines


def random_ground_lines(random: Random) -> list[str]:
    """Return the rules and assumptions of a ground program of six atoms, which often exclude every answer set."""
    lines = ["1 1 2 1 2 0 0"]
    for _ in range(random.randint(5, 9)):
        heads = [str(random.randint(1, 6)) for _ in range(random.choice([0, 0, 1, 1, 1, 2]))]
        body = [str(random.choice([1, -1]) * random.randint(1, 6)) for _ in range(random.randint(0 if heads else 1, 3))]
        choice = random.choice([0, 0, 1]) if heads else 0
        weighted = " ".join(f"{literal} {random.randint(1, 2)}" for literal in body)
        end = f"1 {random.randint(1, 3)} {len(body)} {weighted}" if body and random.random() < 0.3 else None
        lines.append(
            " ".join(["1", str(choice), str(len(heads)), *heads, end or " ".join(["0", str(len(body)), *body])])
        )
    return [*lines, *random.choice([[], ["6 1 3"], ["6 2 -4 5"]])]


def ground_satisfiable(lines: Sequence[str], kept: Collection[int]) -> bool:
    """Return whether there is an answer set if some lines are kept, and the heads of the other rules are free."""
    written = ["asp 1 0 0"]
    for place, line in enumerate(lines):
        kind, *fields = line.split()
        if kind == "6":
            written += [f"1 0 0 0 1 {-int(literal)}" for literal in fields[1:] if place in kept]
        elif place in kept:
            written.append(line)
        elif fields[1] != "0":
            written.append(" ".join(["1 1", *fields[1 : 2 + int(fields[1])], "0 0"]))
    control = clingo.Control(logger=lambda *_: None)
    control.add("base", [], "\n".join([*written, "0\n"]))
    control.ground([("base", [])])
    return bool(control.solve().satisfiable)

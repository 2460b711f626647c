"""Ground programs in aspif have the answer sets that clingo finds; what is not supported is refused by its line."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from random import Random

import pytest

from prag_asp import DomainError, answer_sets
from tests.chance import Chance
from tests.models.programs import answer_sets_by_clingo, count_in_process

HEADER = "asp 1 0 0\n"

FRIENDS = """asp 1 0 0 incremental
1 1 3 1 2 3 0 0
1 0 1 4 0 1 1
1 0 1 4 0 1 2
1 1 1 5 0 1 4
1 0 1 6 0 2 5 3
1 0 1 5 0 1 6
1 0 1 7 1 2 3 1 1 2 1 3 1
1 0 0 0 2 7 -5
10 what is shown
4 10 likes(a,b) 1 1
4 10 likes(a,c) 1 2
4 10 likes(b,c) 1 3
4 8 happy(a) 1 5
4 8 happy(b) 1 6
4 4 many 1 7
4 4 both 2 1 2
4 5 "a b" 1 -1
0
"""


def random_program(random: Random) -> str:
    """Return a ground program of all kinds of statements but those that minimize, with names for most atoms."""
    number = 9

    def atoms(most: int) -> str:
        chosen = random.sample(range(1, number), random.randint(0, most))
        return " ".join(map(str, [len(chosen), *chosen]))

    def literals(most: int, *, weighted: bool = False) -> str:
        chosen = [
            atom * random.choice((1, 1, -1)) for atom in random.choices(range(1, number), k=random.randint(0, most))
        ]
        fields = [f"{literal} {random.randint(0, 3)}" if weighted else str(literal) for literal in chosen]
        return " ".join([str(len(chosen)), *fields])

    lines = [f"1 1 {atoms(5)} 0 0"]
    for _ in range(random.randint(3, 9)):
        heads = f"{random.choice((0, 0, 1))} {atoms(random.choice((0, 1, 1, 2)))}"
        body = (
            f"1 {random.randint(-1, 4)} {literals(4, weighted=True)}" if random.random() < 0.3 else f"0 {literals(3)}"
        )
        lines.append(f"1 {heads} {body}")
    extras = ["3 2 1 2", f"5 3 {random.randint(0, 2)}", f"6 {literals(1)}", f"7 4 1 1 1 {literals(1)}", "4 1 z 0"]
    extras += [
        f"8 0 1 {literals(1)}\n8 1 0 {literals(1)}",
        f"4 4 t(1) {literals(2)}",
        f"4 4 t(1) {literals(2)}",
        "10 x",
    ]
    lines += random.sample(extras, random.randint(0, 4))
    lines += [f"4 1 {'abcdefgh'[atom - 1]} 1 {atom}" for atom in range(1, number) if random.random() < 0.8]
    return "\n".join([HEADER + lines[0], *lines[1:], "0", ""])


@pytest.mark.parametrize("engine", ["auto", "clingo"])
def test_a_ground_program_has_the_answer_sets_that_clingo_finds(engine: str) -> None:
    expected = answer_sets_by_clingo(FRIENDS.replace("10 what is shown\n", ""), project=False)
    found = answer_sets(text=FRIENDS, engine=engine)
    assert found.count() == sum(expected.values()) == 10
    assert Counter(tuple(map(str, each)) for each in found) == expected


@pytest.mark.parametrize("project", [False, True])
def test_random_ground_programs_have_the_answer_sets_that_clingo_finds(project: bool, chance: Chance) -> None:
    random = chance.generator(1 + project)
    for _ in range(chance.examples(15)):
        text = random_program(random)
        expected = answer_sets_by_clingo(text.replace("10 x\n", ""), project=project)
        by_clingo = answer_sets(text=text, project=project, engine="clingo")
        either = answer_sets(text=text, project=project)
        counts = {either.count(), by_clingo.count(), count_in_process(text, project=project)}
        assert counts == {sum(expected.values())}, text
        for found in (by_clingo, either):
            listed = Counter(tuple(map(str, each)) for each in found)
            assert listed == expected or (project and "\n3 " in text), text


def test_weights_of_a_ground_program_are_facts_that_it_shows() -> None:
    text = HEADER + "1 1 2 1 2 0 0\n4 1 a 1 1\n4 1 b 1 2\n4 11 weight(a,3) 0\n4 15 weight(b,(1,2)) 0\n0\n"
    assert answer_sets(text=text, weighted=True).total() == 6


@pytest.mark.parametrize(
    ("lines", "line", "problem"),
    [
        ("1 1 2 1 2 0 0\n1 0 1 3 0 4\n0", 3, "expected a literal, and found nothing"),
        ("1 0 1 0 0 0\n0", 2, "expected an atom, and found '0'"),
        ("1 0 1 1 0 1 0\n0", 2, "0 is not a literal"),
        ("1 0 1 1 1 1 1 2 -1\n0", 2, "expected a weight that is not negative"),
        ("1 0 1 x 0 0\n0", 2, "expected an atom, and found 'x'"),
        ("1 0 1 1  0 0\n0", 2, "expected the kind of a body, 0 or 1, and found nothing"),
        ("1 0 1 1 0 0 7\n0", 2, "' 7' follows the statement"),
        ("1 0 1 99999999999 0 0\n0", 2, "expected an atom, and found '99999999999'"),
        ("4 3 f(1 0\n0", 2, "'f(1' is not a ground term"),
        ("4 9 a 1 1\n0", 2, "no blank follows the 9 bytes of the term"),
        ("5 1 4\n0", 2, "the value of an external"),
        ("9 0 1 5\n0", 2, "a theory is not supported"),
        ("2 0 1 1 1\n0", 2, "add --optimal"),
        ("11 1\n0", 2, "no statement of kind 11"),
        ("1 0 1 1 0 0\n0\n1 0 1 2 0 0\n0", 4, "a second step"),
        ("1 0 1 1 0 0\n\n", 2, "the program has no end"),
    ],
)
def test_a_line_that_clingo_would_not_read_is_named(lines: str, line: int, problem: str) -> None:
    with pytest.raises(DomainError) as error:
        answer_sets(text=HEADER + lines)
    (message,) = error.value.lines
    assert message.startswith(f"<text>:{line}: ") and problem in message


def test_a_ground_program_is_alone_and_has_no_constants(tmp_path: Path) -> None:
    ground, other = tmp_path / "ground.lp", tmp_path / "other.lp"
    ground.write_text(HEADER + "0\n")
    other.write_text("a.")
    with pytest.raises(DomainError, match=r"ground\.lp:1: a ground program in aspif has to be the only file"):
        answer_sets(other, ground)
    with pytest.raises(DomainError, match=r"constant n: .* is already ground"):
        answer_sets(ground, constants={"n": 1})
    with pytest.raises(DomainError, match="<text>:1: this header is not that of aspif"):
        answer_sets(text="asp 2 0 0\n0\n")

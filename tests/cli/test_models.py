"""``prag-asp models``: results on stdout, one line for each mistake, and what was asked for."""

from __future__ import annotations

import json
import shlex
import subprocess
from pathlib import Path
from typing import Any

import pytest

from prag_asp.integers import digits_of
from tests.commands import PRAG, ok, run, run_apart
from tests.processes import family, gone, interrupt, interruptible, until_it_works

QUEENS = """{ q(I,1..n) } = 1 :- I = 1..n.
:- q(I,J), q(K,J), I < K.
:- q(I,J), q(K,L), I < K, |I-K| = |J-L|.
"""


@pytest.fixture
def queens(tmp_path: Path) -> str:
    (tmp_path / "queens.lp").write_text(QUEENS)
    return str(tmp_path / "queens.lp")


def test_a_program_is_counted_listed_and_drawn_from_in_one_command_each(queens: str) -> None:
    assert ok("models", "count", queens, "-c", "n=6") == "4\n"
    listed = ok("models", "list", queens, "-c", "n=6").splitlines()
    assert len(listed) == 4 and listed[0] == "q(1,2) q(2,4) q(3,6) q(4,1) q(5,3) q(6,5)"
    assert ok("models", "list", queens, "-c", "n=6", "--count", "2").splitlines() == listed[:2]
    drawn = ok("models", "sample", queens, "-c", "n=6", "--count", "40", "--seed", "3")
    assert set(drawn.splitlines()) == set(listed)
    assert ok("models", "sample", queens, "-c", "n=6", "--count", "40", "--seed", "3") == drawn
    assert ok("models", "marginals", queens, "-c", "n=5").splitlines()[:2] == ["1/5  q(1,1)", "1/5  q(1,2)"]


def test_weights_are_exact_on_the_command_line(tmp_path: Path) -> None:
    (tmp_path / "coins.lp").write_text("{ head(1..3) }. weight(head(C),(1,3)) :- C = 1..3. #show head/1.")
    assert ok("models", "count", str(tmp_path / "coins.lp")) == "8\n"
    assert ok("models", "count", str(tmp_path / "coins.lp"), "--weighted") == "64/27\n"
    assert ok("models", "marginals", str(tmp_path / "coins.lp"), "--weighted").split("\n")[0] == "1/4  head(1)"


def test_what_compiling_takes_and_what_clingo_leaves_out_is_told_beside_the_results(tmp_path: Path) -> None:
    (tmp_path / "odd.lp").write_text("{ a; b }. :- a, b.\nc :- 1/0 = 1.")
    done = run("models", "sample", str(tmp_path / "odd.lp"), "--count", "1")
    assert done.returncode == 0 and len(done.stdout.splitlines()) == 1
    assert done.stderr.splitlines() == [
        f"note: {tmp_path}/odd.lp:2: operation undefined: (1/0); clingo leaves this out",
        "note: compiling 1 clause over 2 variables, width 1",
    ]


@pytest.mark.parametrize(
    ("text", "code", "told"),
    [
        ("a :- b(X).\n#minimize { 1 : a }.", 2, "given.lp:2: a weak constraint or #minimize is not supported"),
        ("asp 1 0 0\n1 0 1 0 0 0\n0\n", 2, "given.lp:2: expected an atom, and found '0'; correct the line"),
        ("a\n:- b", 2, "given.lp:2: the file ends within a statement"),
        ("a. :- a.", 1, "there is no answer set"),
    ],
)
def test_a_program_that_cannot_be_answered_gives_one_line(text: str, code: int, told: str, tmp_path: Path) -> None:
    (tmp_path / "given.lp").write_text(text)
    done = run("models", "sample", "given.lp", cwd=tmp_path)
    assert (done.returncode, done.stdout) == (code, "") and done.stderr.startswith(told)
    assert len(done.stderr.splitlines()) == 1


HARD = "{ a(X,Y) } :- X = 1..14, Y = 1..14. " + " ".join(
    f":- #sum {{ (X*{k}+Y*{k * k}) \\ 97,X,Y : a(X,Y) }} != {900 + k}." for k in range(3, 9)
)
MANY = "{ a(1..60) }."
FOR_EVER = {"sample": ("--count", "1000000000")}


def test_a_limit_on_time_ends_what_would_take_for_ever(tmp_path: Path) -> None:
    (tmp_path / "hard.lp").write_text(HARD)
    for question in ("count", "sample"):
        done = run_apart("models", question, str(tmp_path / "hard.lp"), "--time", "1s")
        assert done.returncode == 3 and "the time limit of 1 s was reached" in done.stderr


@pytest.mark.parametrize("question", ["count", "sample", "list", "marginals"])
def test_an_interruption_is_one_line_whatever_is_asked(question: str, tmp_path: Path) -> None:
    (tmp_path / "hard.lp").write_text(MANY if question == "list" else HARD)
    with interruptible([*PRAG, "models", question, "hard.lp", *FOR_EVER.get(question, ())], tmp_path) as process:
        if question == "list":
            assert process.stdout is not None and process.stdout.readline()
        else:
            until_it_works(process, seconds=1)
        assert interrupt(process).splitlines()[-1] == "interrupted"
    assert process.returncode == 130 and gone(family(process.pid))


@pytest.mark.parametrize("question", ["sample", "list", "marginals"])
def test_a_pipe_that_is_closed_ends_the_answer_without_a_word(question: str, tmp_path: Path) -> None:
    (tmp_path / "many.lp").write_text("{ a(1..8000) }." if question == "marginals" else MANY)
    command = [*PRAG, "models", question, "many.lp", *FOR_EVER.get(question, ())]
    with interruptible(command, tmp_path) as process:
        assert process.stdout is not None and process.stderr is not None
        assert process.stdout.readline().endswith("\n")
        process.stdout.close()
        told = process.stderr.read()
        process.wait(timeout=60)
    assert not [line for line in told.splitlines() if not line.startswith("note: ")]


@pytest.mark.parametrize("question", ["count", "sample", "list", "facets"])
def test_a_closed_stdout_is_an_error_of_output(question: str, tmp_path: Path) -> None:
    (tmp_path / "few.lp").write_text("{ a }.")
    shell = f"{shlex.join([*PRAG, 'models', question, 'few.lp'])} >&-"
    done = subprocess.run(["sh", "-c", shell], cwd=tmp_path, capture_output=True, text=True, timeout=60, check=False)
    lines = [line for line in done.stderr.splitlines() if not line.startswith("note: ")]
    assert (done.returncode, lines) == (4, ["stdout: Bad file descriptor"])


def document(*words: str) -> Any:
    return json.loads(ok("models", *words, "--format", "json"))


def test_all_answers_are_read_as_json(queens: str, tmp_path: Path) -> None:
    size = ("-c", "n=6")
    assert document("count", queens, *size) == {"count": 4}
    listed = ok("models", "list", queens, *size).splitlines()
    assert document("list", queens, *size)["answer_sets"] == [line.split() for line in listed]
    assert document("list", queens, *size, "-n", "2")["answer_sets"] == [line.split() for line in listed[:2]]
    assert document("list", queens, "-c", "n=3") == {"answer_sets": []}
    drawn = [line.split() for line in ok("models", "sample", queens, *size, "-n", "3").splitlines()]
    assert document("sample", queens, *size, "-n", "3")["answer_sets"] == drawn
    shares = dict(reversed(line.split("  ")) for line in ok("models", "marginals", queens, *size).splitlines())
    assert document("marginals", queens, *size) == {"marginals": shares}
    assert document("facets", queens, *size)["facets"]["q(1,2)"] == {
        "share": "1/4",
        "facet": True,
        "chosen": {"answer_sets": 1, "facets": 0, "of_answer_sets": "3/4", "of_facets": "1"},
        "excluded": {"answer_sets": 3, "facets": 18, "of_answer_sets": "1/4", "of_facets": "1/4"},
    }
    (tmp_path / "coins.lp").write_text("{ head(1..2) }. weight(head(1),(1,3)). :~ head(2). [3@2]")
    weighted = document("count", str(tmp_path / "coins.lp"), "--weighted", "--optimal")
    assert weighted == {"optimum": [{"priority": 2, "value": 0}], "total_weight": "4/3"}
    (tmp_path / "many.lp").write_text("{ a(1..15000) }. #show.")
    huge = ok("models", "count", str(tmp_path / "many.lp"), "--engine", "diagram", "--format", "json")
    assert huge.split()[2] == digits_of(2**15000)


def test_the_lines_that_exclude_every_answer_set_are_printed(tmp_path: Path) -> None:
    (tmp_path / "given.lp").write_text("{ a(1..n) } = n.\n:- a(X), X > 1.\nb.\n:~ b. [1]\n")
    done = run("models", "explain", "given.lp", "-c", "n=2", cwd=tmp_path)
    lines = "  given.lp:1: { a(1..n) } = n.\n  given.lp:2: :- a(X), X > 1.\n"
    assert (done.returncode, done.stderr) == (1, "")
    assert done.stdout == f"these lines together exclude every answer set:\n{lines}"
    found = json.loads(run("models", "explain", "given.lp", "-c", "n=2", "--format", "json", cwd=tmp_path).stdout)
    assert (found["satisfiable"], found["minimal"], len(found["lines"])) == (False, True, 2)
    assert found["lines"][1] == {"file": "given.lp", "line": 2, "text": ":- a(X), X > 1."}
    done = run("models", "explain", "given.lp", "-c", "n=1", cwd=tmp_path)
    assert (done.returncode, done.stdout) == (0, "there is an answer set\n")


def test_the_optimum_is_printed_beside_the_number_of_optimal_answer_sets(tmp_path: Path) -> None:
    (tmp_path / "given.lp").write_text("{ pick(1..4) }.\n:- pick(1), pick(2).\n:~ not pick(X), X=1..4. [X]")
    done = run("models", "count", "given.lp", "--optimal", cwd=tmp_path)
    assert (done.returncode, done.stdout, done.stderr) == (0, "1\n", "note: the best value is 1\n")
    assert ok("models", "list", str(tmp_path / "given.lp"), "--optimal") == "pick(2) pick(3) pick(4)\n"
    done = run("models", "facets", "given.lp", "--optimal", "--weighted", cwd=tmp_path)
    assert (done.returncode, done.stdout) == (2, "") and "the program states no weight" in done.stderr


def test_help_loads_no_solver() -> None:
    done = run("models", "count", "--help")
    assert done.returncode == 0 and "FILE" in done.stdout


@pytest.mark.parametrize("command", [("models", "count", "queens.lp"), ("count", "hanoi", "--length", "1")])
def test_a_constant_is_set_once(command: tuple[str, ...], queens: str) -> None:
    done = run(*command, "-c", "n=4", "-c", "n=5", cwd=Path(queens).parent)
    assert (done.returncode, done.stdout, done.stderr) == (2, "", "--const n: it is set twice; give it once\n")

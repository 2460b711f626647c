"""An estimate is within its bounds as often as it says, and is never taken for an exact number."""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import pytest

from prag_asp import Estimate, QueryError, TaskSpace, answer_sets, load_domain
from prag_asp.errors import EngineError
from prag_asp.logic.formula.approximate import Tolerance, estimate_models
from prag_asp.logic.formula.cnf import Cnf
from prag_asp.logic.formula.counter import APPROXMC
from prag_asp.processes.workers import Worker, WorkerGroup
from tests.chance import Chance
from tests.commands import ok, run

needs_approxmc = pytest.mark.skipif("not __import__('importlib.util').util.find_spec('pyapproxmc')", reason="none")

QUEENS = ":- queen(I,J), queen(K,J), I < K. :- queen(I,J), queen(K,L), I < K, |I-K| = |J-L|."
CIRCLE = "{ colour(X,1..5) } = 1 :- X = 1..n. :- colour(X,C), colour(X+1,C). :- colour(1,C), colour(n,C)."
LINKED = "{ edge(X,Y) } :- X = 1..4, Y = 1..4, X < Y. reach(1). reach(Y) :- reach(X), edge(X,Y). #show reach/1."
KNOWN = [
    ("{ queen(I,1..8) } = 1 :- I = 1..8. " + QUEENS, False, 92),
    (CIRCLE.replace("n", "12"), False, 4**12 + 4),
    (LINKED, False, 64),
    (LINKED, True, 8),
    ("{ a(1..40) }. :- a(1), a(2).", False, 3 * 2**38),
    ("{ a(1..9) }. b(X) :- a(X), X > 3. #show b/1.", True, 2**6),
    ("a. :- a.", False, 0),
]
"""Programs, whether they are projected, and how many answer sets they have."""


@pytest.fixture(scope="module")
def approxmc() -> Iterator[Worker]:
    with WorkerGroup(APPROXMC.module) as children:
        yield children.start()


def estimated(approxmc: Worker, cnf: Cnf, seed: int, tolerance: Tolerance) -> int:
    approxmc.send((cnf.variables, cnf.shown, cnf.clauses, tolerance.epsilon, tolerance.delta, seed))
    return int(approxmc.receive())


@needs_approxmc
@pytest.mark.parametrize(("text", "project", "count"), KNOWN)
def test_the_estimates_of_ten_seeds_are_within_the_bounds(
    text: str, project: bool, count: int, approxmc: Worker
) -> None:
    cnf = answer_sets(text=text, project=project)._compiled.counting_formula.cnf
    estimates = [estimated(approxmc, cnf, seed, Tolerance()) for seed in range(10)]
    assert all(count / 1.8 <= each <= count * 1.8 for each in estimates), estimates


@needs_approxmc
def test_variables_that_units_leave_free_are_counted(approxmc: Worker, chance: Chance) -> None:
    """Few models are counted one by one, so that the estimate has to be right: by brute force here."""
    draw = chance.generator(1)
    for _ in range(chance.examples(60)):
        variables = draw.randint(1, 6)
        numbers = range(1, variables + 1)
        clauses = tuple(
            tuple(draw.choice([-1, 1]) * v for v in draw.sample(numbers, min(variables, draw.randint(1, 3))))
            for _ in range(draw.randint(0, 7))
        )
        shown = tuple(sorted(draw.sample(numbers, draw.randint(0, variables))))
        every = itertools.product((False, True), repeat=variables)
        models = (values for values in every if all(any(values[abs(x) - 1] == (x > 0) for x in c) for c in clauses))
        expected = len({tuple(values[v - 1] for v in shown) for values in models})
        assert estimated(approxmc, Cnf(variables, clauses, {}, shown), 1, Tolerance()) == expected, (clauses, shown)


@needs_approxmc
def test_an_estimate_is_no_number_and_says_how_near_it_is() -> None:
    found = answer_sets(text=KNOWN[1][0]).estimate(epsilon=0.5, delta=0.1, seed=3)
    assert isinstance(found, Estimate) and not isinstance(found, int)
    assert str(found) == f"about {found.about} (within a factor of 1.5 with probability at least 0.9)"
    assert found == answer_sets(text=KNOWN[1][0]).estimate(epsilon=0.5, delta=0.1, seed=3)
    with pytest.raises(TypeError):
        int(found)  # type: ignore[call-overload]


@needs_approxmc
@pytest.mark.parametrize("by", ["plan", "task", "skeleton"])
def test_plans_tasks_and_skeletons_are_estimated(by: str) -> None:
    space = TaskSpace(load_domain("hanoi"), 6)
    count = space.count(by)  # type: ignore[arg-type]
    assert count / 1.8 <= space.estimate(by).about <= count * 1.8  # type: ignore[arg-type]
    assert space.where("has at least 9 move").estimate(by).about == 0  # type: ignore[arg-type]


@needs_approxmc
def test_the_command_prints_about_how_many() -> None:
    lines = ok("count", "hanoi", "--length", "0..1", "--by", "plan", "--approximate", "--seed", "5").splitlines()
    counts = [TaskSpace(load_domain("hanoi"), length).count("plan") for length in (0, 1)]
    bounds = "(within a factor of 1.8 with probability at least 0.8)"
    assert lines[1:] == [f"{n:>6}  about {count} {bounds}" for n, count in enumerate(counts)]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--epsilon", "1"], "--epsilon is for estimates; add --approximate"),
        (["--seed", "1"], "--seed is for estimates; add --approximate"),
        (["--approximate", "--epsilon", "0"], "epsilon 0: write a number from 0.01 to 100"),
        (["--approximate", "--delta", "nan"], "delta nan: write a number from 0.0001 to 0.9999"),
        (["--approximate", "--engine", "clingo"], "leave out --engine"),
    ],
)
def test_what_no_estimate_can_be_made_of_is_refused(arguments: list[str], message: str) -> None:
    done = run("count", "hanoi", "--length", "1", *arguments)
    assert (done.returncode, done.stdout, len(done.stderr.splitlines())) == (2, "", 1)
    assert message in done.stderr


def test_what_has_no_clauses_or_no_counter_or_a_seed_that_is_none_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(QueryError, match="#edge requires a graph without cycles; leave it out"):
        answer_sets(text="{ a(1..2) }. #edge(1,2) : a(1). #edge(2,1) : a(2).").estimate()
    with pytest.raises(QueryError, match="seed -1: --approximate takes one from 0 to 4294967295"):
        estimate_models(Cnf(1, ((1,),), {}, (1,)), Tolerance(), -1)
    monkeypatch.setattr("prag_asp.logic.formula.counter.find_spec", lambda name: None)
    with pytest.raises(EngineError, match=r"pip install 'prag_asp\[approximate\]'"):
        answer_sets(text="{ a }.").estimate()

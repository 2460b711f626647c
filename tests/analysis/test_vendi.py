"""The Vendi score of a space is that of the matrix of the similarities of all its tasks."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from fractions import Fraction
from itertools import pairwise
from math import exp, log

import numpy as np
import pytest

from prag_asp import QueryError, TaskSpace, load_domain
from prag_asp.analysis import vendi_score
from prag_asp.analysis.moments import FEATURES, Feature
from tests.analysis.orbit_spaces import orbit_spaces
from tests.chance import Chance
from tests.orbits.case import Case, Plan, rename

Values = Sequence[Hashable]


def name(action: str) -> str:
    return action.partition("(")[0]


def features(case: Case) -> dict[Feature, Callable[[Plan], Values]]:
    return {
        "actions": lambda plan: plan,
        "names": lambda plan: list(map(name, plan)),
        "classes": lambda plan: [rename(action, case.entities) for action in plan],
        "pairs": lambda plan: list(pairwise(map(name, plan))),
    }


def similarity(one: Values, other: Values, bag: bool) -> int:
    return sum(a == b for a in one for b in other) if bag else sum(a == b for a, b in zip(one, other, strict=True))


def expected(rows: Sequence[Values], bag: bool) -> tuple[float, Fraction]:
    """Return the score of some tasks, and the exact one of order 2, from all similarities."""
    gram = [[similarity(one, other, bag) for other in rows] for one in rows]
    trace = sum(gram[k][k] for k in range(len(rows)))
    weights = np.linalg.eigvalsh(np.array(gram) / trace)
    score = exp(-sum(w * log(w) for w in weights.tolist() if w > 1e-12))
    return score, Fraction(trace**2, sum(each**2 for row in gram for each in row))


@pytest.mark.parametrize("bag", [False, True])
def test_the_score_is_that_of_all_similarities(bag: bool, chance: Chance, monkeypatch: pytest.MonkeyPatch) -> None:
    for number, (case, space, orbits) in enumerate(orbit_spaces(chance, 8, 3)):
        monkeypatch.setattr("prag_asp.analysis.moments.SAFE", 0 if number % 2 else 2**62)
        plans = {plan for orbit in orbits for plan in orbit}
        tasks = list(space.enumerate("task"))
        for feature, of in features(case).items():
            for level, words in (("plan", sorted(plans)), ("task", tasks)):
                found = vendi_score(space, feature=feature, by=level, bag=bag)  # type: ignore[arg-type]
                score, order_2 = expected(list(map(of, words)), bag)
                assert found.order_2 == order_2 and found.words == len(words), (feature, level, case.text())
                assert found.score == pytest.approx(score, rel=1e-9)
            given = vendi_score(space, [*tasks, *tasks[:2]], feature=feature, bag=bag)
            assert given.order_2 == expected([of(plan) for plan in (*tasks, *tasks[:2])], bag)[1]


def test_the_names_of_interchangeable_entities_do_not_matter() -> None:
    space = TaskSpace(load_domain("prag"), 2)
    one = ["grasp(panda,apple_1)", "rotate(panda,apple_1,straight)"]
    swapped = [action.replace("apple_1", "apple_2") for action in one]
    assert vendi_score(space, [one, swapped]).score == pytest.approx(1)
    assert vendi_score(space, [one, ["grasp(panda,can_1)", "drop(panda,can_1)"]]).score == pytest.approx(2)


def test_a_thousand_tasks_of_the_paper_are_less_diverse_than_their_space() -> None:
    space = TaskSpace(load_domain("prag"), 15)
    whole, some = vendi_score(space), vendi_score(space, space.sample(100, seed=3))
    assert whole.words == space.count() and whole.score == pytest.approx(297.17, abs=0.01)
    assert 50 < some.score < 100 and some.words == 100
    skeletons = [list(pairwise(skeleton)) for skeleton in space.at(4).enumerate("skeleton")]
    found = vendi_score(space.at(4), feature="pairs", by="skeleton")
    assert found.order_2 == expected(skeletons, bag=False)[1]


def test_what_has_no_score_is_refused() -> None:
    space = TaskSpace(load_domain("blocks"), 2)
    for refused, arguments in (
        ("no feature colours; there are actions", {"feature": "colours"}),
        ("skeletons have names and pairs, but no actions", {"by": "skeleton"}),
        ("no task to compare", {"tasks": []}),
        ("a task of 1 actions, but the space is blocks of length 2", {"tasks": [["pick_up(a)"]]}),
    ):
        with pytest.raises(QueryError, match=refused):
            vendi_score(space, **arguments)  # type: ignore[arg-type]
    with pytest.raises(QueryError, match="too short"):
        vendi_score(space.at(1), feature="pairs")
    with pytest.raises(QueryError, match="there is no task of blocks"):
        vendi_score(space.where("has at least 3 stack"))
    assert set(FEATURES) == {"actions", "classes", "names", "pairs"}

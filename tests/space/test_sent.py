"""Task spaces, domains and data about them are sent to other processes, where clingo's symbols lie elsewhere."""

from __future__ import annotations

import pickle
import subprocess
import sys
from typing import Any

import clingo

from prag_asp import TaskSpace, load_domain

ANSWERS = """
import pickle, sys
answers = [eval(code, {"found": pickle.loads(given)}) for given, code in pickle.load(sys.stdin.buffer)]
pickle.dump(answers, sys.stdout.buffer)
"""


def elsewhere(*questions: tuple[object, str]) -> list[Any]:
    """Return the value of each expression in another process, which has what is sent with it as `found`."""
    sent = pickle.dumps([(pickle.dumps(given), code) for given, code in questions])
    done = subprocess.run([sys.executable, "-c", ANSWERS], input=sent, capture_output=True, check=True)
    answers: list[Any] = pickle.loads(done.stdout)
    return answers


def test_a_space_counts_and_draws_the_same_in_another_process() -> None:
    used = [TaskSpace(load_domain(name), length=3) for name in ("tabletop", "hanoi")]
    expected = [(space.count(), [str(task) for task in space.sample(3, seed=1)]) for space in used]
    fresh = [TaskSpace(space.domain, length=3) for space in used]
    code = "(found.count(), [str(task) for task in found.sample(3, seed=1)])"
    assert elsewhere(*((space, code) for space in (*fresh, *used))) == 2 * expected


def test_conditions_and_lengths_go_with_it() -> None:
    space = TaskSpace(load_domain("tabletop"), range(1, 4)).where("uses can_1", "ends inside(can_1,bin_1)")
    single = TaskSpace(space.domain, length=2).where("uses can_1").at(3)
    assert space.count() > 0
    questions = (space, "found.count()"), (single, "(found.length, found.count())")
    assert elsewhere(*questions) == [space.count(), (3, single.count())]


def test_terms_of_all_kinds_get_there() -> None:
    terms = [clingo.parse_term(text) for text in ('f(a,-2,"b c\\"d\\n")', "#sup", "-g(1)", "(x,)", "h")]
    assert TaskSpace  # what knows how symbols are sent
    assert elsewhere((terms, "list(map(str, found))")) == [list(map(str, terms))]

"""Authors may use every name that the contract does not document: counts stay those of brute force."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise, product

import pytest

from prag_asp import DomainError, TaskSpace, load_domain
from prag_asp.program.parse import parse_sources
from prag_asp.program.paths import data_folder
from prag_asp.program.sources import read_sources

ENGINES = ("automaton", "clingo", "sat", "symbolic")

NAMES = (
    "sought", "reached", "asked", "tested", "condition", "other", "forces", "supposed", "named", "may_hold",
    "may_stand", "may_occur", "impossible_with", "ruled_out", "barred", "propagates", "entails", "never", "bound",
    "never_without",
    "some_impossible", "never_possible", "impossible_matters", "names_unit_late", "unit_named", "times",
    "introduces_late", "mentioned", "requires", "reverts", "differs", "undoes", "hierarchical", "ahead", "last_stage",
    "worded_before", "wording", "unit", "unit_end", "splits", "concatenation", "covers", "expected", "goes_on",
    "spared", "opposite", "known", "state", "successor", "joint_unit", "next_unit", "left_out",
)  # fmt: skip
"""Names that the encodings once had for themselves."""

SWITCHES = """
class(switch). entity((s1;s2), switch).
fluent(on(S)) :- is_a(S,switch).
initially(on(S),false) :- is_a(S,switch).
action(press(S)) :- is_a(S,switch).
action(wait).
precondition(press(S),on(S),false) :- action(press(S)).
postcondition(press(S),on(S),true) :- action(press(S)).
"""
ACTIONS = ("press(s1)", "press(s2)", "wait")


def rules(name: str) -> str:
    """Return rules of every part, which forbid to wait twice in a row and to end with a wait, with 1 to 4 arguments."""
    return f"""
{name}(wait). {name}(A,B) :- {name}(A), {name}(B). {name}(X,Y,Z,X) :- {name}(X,Y), Z = X.
#program step(t).
{name}(A,true,t) :- occurs(A,t), {name}(A,A,A,A), {name}(A,A).
:- {name}(A,true,t), {name}(A,true,t-1).
#program check(t).
:- {name}(wait,V,t), V = true.
"""


def text(names: Iterable[str]) -> str:
    """Return the domain with the rules of some names."""
    return SWITCHES + "".join(f"#program base.{rules(name)}" for name in names)


def is_plan(word: tuple[str, ...]) -> bool:
    pressed = [action for action in word if action != "wait"]
    waits = any(pair == ("wait", "wait") for pair in pairwise(word))
    return len(set(pressed)) == len(pressed) and not waits and word[-1:] != ("wait",)


COUNTS = [sum(map(is_plan, product(ACTIONS, repeat=length))) for length in range(5)]


@pytest.mark.parametrize("engine", ENGINES)
def test_all_everyday_names_at_once_change_no_count(engine: str) -> None:
    space = TaskSpace(load_domain(text=text(NAMES)), 0, engine=engine)
    assert [space.at(length).count("plan") for length in range(5)] == COUNTS
    assert space.at(3).count("task") * 2 == COUNTS[3] and space.at(3).count("skeleton") == 2


@pytest.mark.parametrize("names", [NAMES[first::8] for first in range(8)], ids=" ".join)
def test_everyday_names_mean_what_their_author_says(names: tuple[str, ...]) -> None:
    space = TaskSpace(load_domain(text=text(names)), 3)
    assert space.count("plan") == COUNTS[3]
    met = space.where("ends on(s1)", "nontrivial", "has at least 1 press", "uses at least 2 switch")
    assert met.count("plan") == COUNTS[3]


def test_the_encodings_have_no_plain_name_but_those_of_the_contract() -> None:
    encodings = data_folder("encodings")
    files = {file for path in encodings.rglob("*.lp") for file in read_sources(path, encodings)}
    statements, problems = parse_sources((file, False) for file in files)
    plain = {atom.name for each in statements for atom in (*each.heads, *each.body) if not atom.name.startswith("_")}
    contract = (encodings / "contract.lp").read_text(encoding="utf-8")
    assert not problems and {name for name in plain if f"#defined {name}/" not in contract} == set()


@pytest.mark.parametrize("head", ["_known(on(s1),true,t)", "_mine(t)", "-_step_name(press,t)", "__kept(1,t)"])
def test_names_of_the_library_are_refused_by_line(head: str) -> None:
    rule = f"#program step(t).\n{head} :- occurs(wait,t).\n:- {head}, occurs(wait,t-1)."
    with pytest.raises(DomainError, match=r":10: names that begin with _ are reserved for the library; rename"):
        load_domain(text=f"{SWITCHES}{rule}")

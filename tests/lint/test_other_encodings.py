"""Copies of the encodings with other rules: counts follow them, and what is assumed of them is told."""

from __future__ import annotations

from pathlib import Path
from shutil import copytree

import clingo
import pytest

from prag_asp import Domain, EngineError, TaskSpace, load_domain
from prag_asp.program.paths import data_folder
from prag_asp.program.sources import Program, Source

TEXT = """
fluent(on). initially(on,false). action((go; no; up)). postcondition(go,on,true).
precondition(no,on,true). precondition(up,on,false).
"""
NEEDS = ":- occurs(A,t), precondition(A,F,V), _opposite(V,W), holds(F,W,t-1)."
ONE = "1 { occurs(A,t) : action(A), not _pruned(A) } 1."
ENGINES = ("automaton", "symbolic", "clingo", "sat")


BOTH = """
fluent((on;dark)). initially((on;dark),false). action((go;no;up)). precondition(no,on,true). precondition(up,on,false).
postcondition(go,dark,true).
"""
TRIVIAL = ":- not _finding(differs,t)."
LIGHTS = """
#program step(t).
holds(on,true,t) :- occurs(up,t).
changed(on,t) :- occurs(up,t).
"""


def plans(domain: Domain, length: int) -> int:
    """Count the plans by clingo alone: the answer sets of all parts, ground at once."""
    names = " ".join(f"name({action},{action})." for action in ("go", "no", "up"))
    control = clingo.Control(["0", "--warn=none"])
    files = [*domain.program.sources, Source(Path("names.lp"), names)]
    control.add("base", [], Program(tuple(files)).text)
    times = map(clingo.Number, range(1, length + 1))
    control.ground([("base", []), *(("step", [time]) for time in times), ("check", [clingo.Number(length)])])
    found = set()
    with control.solve(yield_=True) as models:
        for model in models:
            found.add(tuple(sorted(str(atom) for atom in model.symbols(atoms=True) if atom.match("occurs", 2))))
    return len(found)


def copied(folder: Path, file: str, old: str, new: str) -> Path:
    """Return a copy of the encodings in which a text of one file is replaced."""
    copytree(data_folder("encodings"), folder / "copy")
    path = folder / "copy" / file
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new), encoding="utf-8")
    return folder / "copy"


def test_comments_and_blanks_are_no_difference(tmp_path: Path) -> None:
    domain = load_domain(text=TEXT, encodings=copied(tmp_path, "step.lp", NEEDS, f"% Preconditions\n\n{NEEDS}"))
    assert not domain.warnings


def test_nothing_is_pruned_by_rules_that_are_others(tmp_path: Path) -> None:
    """Without the test of preconditions, a plan is any sequence, and `no` may begin it."""
    text = TEXT.replace("postcondition(go,on,true).", "")
    assert [TaskSpace(load_domain(text=text), n).count("plan") for n in (1, 2)] == [2, 4]
    domain = load_domain(text=text, encodings=copied(tmp_path, "step.lp", NEEDS, "% none"))
    (warning,) = domain.warnings
    assert (warning.path.name, warning.name) == ("step.lp", "other-encoding") and warning.line > 1
    expected = [1, 3, 9]
    for engine in ENGINES:
        assert [TaskSpace(domain, n, engine=engine).count("plan") for n in range(3)] == expected


def test_engines_that_assume_one_action_a_step_refuse_another_rule(tmp_path: Path) -> None:
    domain = load_domain(text=TEXT, encodings=copied(tmp_path, "step.lp", ONE, ONE.replace("} 1.", "} 2.")))
    assert [each.name for each in domain.warnings] == ["other-encoding"]
    # go, up, or both at once; no begins no plan.
    assert {engine: TaskSpace(domain, 1, engine=engine).count("plan") for engine in ("auto", "clingo")} == {
        "auto": 3, "clingo": 3,
    }  # fmt: skip
    for engine in ("automaton", "symbolic"):
        with pytest.raises(EngineError, match=r"step\.lp:\d+: this rule lets actions occur otherwise"):
            TaskSpace(domain, 1, engine=engine).count("plan")


def test_a_domain_may_have_a_rule_of_a_shipped_name(tmp_path: Path) -> None:
    (tmp_path / "rules").mkdir()
    (tmp_path / "rules" / "closed_world.lp").write_text("initially(F,true) :- fluent(F), not initially(F,false).\n")
    (tmp_path / "domain.lp").write_text(f'#include "rules/closed_world.lp".\n{TEXT}fluent(wet).\n')
    domain = load_domain(tmp_path)
    assert [(each.path.name, each.line) for each in domain.warnings if each.name == "other-encoding"] == [
        ("closed_world.lp", 1)
    ]


@pytest.mark.parametrize(
    ("file", "old", "new", "line"),
    [
        ("contract.lp", "#defined mentions/3.\n", f"#defined mentions/3.\n{LIGHTS}", 64),
        ("contract.lp", "#defined mentions/3.\n", "#defined mentions/3.\n#defined mine/2.\n", 0),
        ("contract.lp", "#defined mentions/3.\n", "#program step(t).\n:- occurs(A,t), name(A,up).\n", 62),
        ("skeleton.lp", "name(A,N).\n", f"name(A,N).\n{LIGHTS}", 9),
        ("reachable.lp", "not _pruned(A), _may_stand", "A = go, _may_stand", 23),
        ("step.lp", NEEDS, NEEDS.replace(" V,", " true,").replace("V)", "true)"), 29),
        ("hindsight.lp", "\n", "\r\n", 0),
    ],
    ids=["contract", "defined", "names", "skeleton", "reachable", "guard", "line-ends"],
)
def test_all_engines_count_as_clingo_alone_by_edited_files(
    tmp_path: Path, file: str, old: str, new: str, line: int
) -> None:
    domain = load_domain(text=BOTH, encodings=copied(tmp_path, file, old, new))
    found = [(each.path.name, each.line) for each in domain.warnings if each.name == "other-encoding"]
    assert found == ([(file, line)] if line else [])
    for length in (1, 2):
        counts = {TaskSpace(domain, length, engine=engine).count("plan") for engine in ENGINES}
        assert counts == {plans(domain, length)}


def test_an_edited_condition_may_set_fluents(tmp_path: Path) -> None:
    """Without the test of its own, the condition only turns the light on, and `no` may follow `up`."""
    domain = load_domain(text=BOTH, encodings=copied(tmp_path, "conditions/nontrivial.lp", TRIVIAL, LIGHTS))
    assert [(each.path.name, each.name) for each in domain.warnings] == [("nontrivial.lp", "other-encoding")]
    # after up: go and no; after go: go and up
    assert {TaskSpace(domain, 2, engine=each).where("nontrivial").count("plan") for each in ENGINES} == {4}


def test_files_that_a_copy_lacks_are_told(tmp_path: Path) -> None:
    folder = copied(tmp_path, "step.lp", NEEDS, "")
    (folder / "step.lp").rename(folder / "moves.lp")
    domain = load_domain(text=BOTH, encodings=folder)
    assert [(each.path.name, each.line) for each in domain.warnings] == [("step.lp", 1)]
    assert {TaskSpace(domain, 2, engine=each).count("plan") for each in ENGINES} == {plans(domain, 2)} == {9}
    (folder / "moves.lp").unlink()
    domain = load_domain(text=BOTH, encodings=folder)
    assert TaskSpace(domain, 2).count("plan") == plans(domain, 2) == 1  # no action at all
    for engine in ("automaton", "symbolic"):
        with pytest.raises(EngineError, match=r"step\.lp:1: no rule lets exactly one action occur"):
            TaskSpace(domain, 2, engine=engine).count("plan")


def test_an_added_file_reads_the_names_of_actions_that_never_occur(tmp_path: Path) -> None:
    folder = copied(tmp_path, "step.lp", "% Test", "% Tests")
    text = "#program base.\nbad :- name(no,no).\n#program step(t).\n:- bad, occurs(go,t).\n"
    (folder / "mine.lp").write_text(text, encoding="utf-8")
    domain = load_domain(text=BOTH, encodings=folder)
    assert TaskSpace(domain, 2).count("plan") == plans(domain, 2) == 1

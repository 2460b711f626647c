"""Copies of the encodings with other rules: counts follow them, and what is assumed of them is told."""

from __future__ import annotations

from pathlib import Path
from shutil import copytree

import pytest

from prag_asp import EngineError, TaskSpace, load_domain
from prag_asp.program.paths import data_folder

TEXT = """
fluent(on). initially(on,false). action((go; no; up)). postcondition(go,on,true).
precondition(no,on,true). precondition(up,on,false).
"""
NEEDS = ":- occurs(A,t), precondition(A,F,V), _opposite(V,W), holds(F,W,t-1)."
ONE = "1 { occurs(A,t) : action(A), not _pruned(A) } 1."
ENGINES = ("automaton", "symbolic", "clingo", "sat")


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

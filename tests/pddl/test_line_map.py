"""What is said of an imported task names the line of PDDL that it comes from."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

from hypothesis import given, settings
from hypothesis.strategies import integers

from prag_asp import TaskSpace, load_domain, why_empty
from prag_asp.pddl import read
from prag_asp.program.parse import parse_sources
from prag_asp.program.sources import Source
from tests.chance import examples
from tests.pddl.imports import written
from tests.pddl.random_tasks import random_task

DOMAIN = """(define (domain d)
 (:types a
   unused)
 (:predicates (p ?x - a) (q ?x)
   (wet ?x))
 (:constants k - a)
 (:action act
  :parameters (?x - a)
  :precondition (and (p ?x)
     (not (q ?x)))
  :effect (and (not (p ?x))
     (q ?x)))
 (:action other :parameters (?x)
  :precondition (or (p ?x)
     (wet ?x))
  :effect (when (p ?x) (not (q ?x)))))
"""
PROBLEM = """(define (problem e) (:domain d)
 (:objects o - a)
 (:init (p o)
   (wet o))
 (:goal (and (q o)
   (p o)))
)
"""


def test_warnings_and_reasons_name_lines_of_pddl(tmp_path: Path) -> None:
    domain = load_domain(*written(tmp_path, DOMAIN, PROBLEM))
    assert domain.name == "d_e"
    assert [str(each).removeprefix(f"{tmp_path}/") for each in domain.warnings] == [
        "domain.pddl:3: warning: class unused has no entity; add entity(..., unused), or remove it [empty-class]"
    ]
    plain = f"{DOMAIN.partition(' (:action other')[0]})"
    reasons = why_empty(TaskSpace(load_domain(*written(tmp_path, plain, PROBLEM)), 2))
    assert reasons is not None
    told = {f"{Path(line.path).name}:{line.line}" for line in reasons.lines}
    assert {"domain.pddl:11", "problem.pddl:6"} <= told
    unreached = load_domain(*written(tmp_path, plain, PROBLEM.replace("(p o)))", "(p k)))")))
    assert [f"{each.path.name}:{each.line}" for each in unreached.warnings if each.name == "no-plan"] == [
        "problem.pddl:6"
    ]


@settings(max_examples=examples(10))
@given(seed=integers(0, 10**6))
def test_the_lines_hold_the_whole_program(seed: int, folder: Path) -> None:
    texts = random_task(seed)
    domain, problem = written(folder, *texts)
    found = read(domain, problem)
    assert statements(found.sources[:-1]) == statements([Source(Path("all"), found.text.replace("#include", "%"))])
    assert {source.path for source in found.sources[:-1]} <= {domain, problem}
    ends = {path: text.count("\n") + 1 for path, text in zip((domain, problem), texts, strict=True)}
    assert all(source.text.count("\n") <= ends[source.path] for source in found.sources[:-1])


def statements(sources: list[Source] | tuple[Source, ...]) -> Counter[tuple[str, str]]:
    """Return the statements of files, each with its part of the program."""
    found, problems = parse_sources((source, True) for source in sources)
    assert not problems
    return Counter((each.part, str(each.node)) for each in found if not str(each.node).startswith("#program"))

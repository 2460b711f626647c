"""Atoms that are added between parts are read by those that are ground later."""

from __future__ import annotations

from pathlib import Path

import clingo

from prag_asp.program.grounding import Grounder
from prag_asp.program.sources import Program, Source

RULES = """asked(0..1). takes(0,0). takes(1,2). at(0..1,0,0).
#program check(t).
:- asked(K), not at(K,Q,t) : takes(K,Q).
"""


def test_no_constraint_is_lost() -> None:
    """The second of two is, where atoms come by clingo's backend."""
    grounder = Grounder(Program((Source(Path("rules.lp"), RULES),)))
    grounder.ground([("base", [])])
    grounder.leave_open([clingo.parse_term(text) for text in ("at(0,0,5)", "at(1,0,5)")])
    grounder.ground([("check", [clingo.Number(5)])])
    assert grounder.control.is_conflicting


def test_added_atoms_may_be_any_term() -> None:
    grounder = Grounder(Program((Source(Path("rules.lp"), "p(0)."),)))
    terms = [clingo.parse_term(text) for text in ('q("a\\"b\\n% c")', "q((1,))", "q(#inf)", "q(-f(x))", "-q(1)")]
    grounder.state(terms)
    grounder.state([])
    grounder.leave_open([clingo.parse_term("p(1)")])
    found = {atom.symbol: atom.is_fact for atom in grounder.control.symbolic_atoms}
    assert found == dict.fromkeys(terms, True) | {clingo.parse_term("p(1)"): False}

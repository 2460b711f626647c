"""Facts whose terms are written out are read from their text, which gives what clingo's syntax tree gives."""

from __future__ import annotations

from pathlib import Path

import clingo

from prag_asp.program.parse import parse_sources
from prag_asp.program.sources import Program, Source
from prag_asp.program.syntax import head_atoms
from prag_asp.reduction.alike_entities import find_alike

PLAIN = "p. p(a). p(a,f(b,1)). p((1,2),q). p((1,)). _p(__a). p(aB,x'). p(c). p(f(c)). q(n,7)."
OTHERS = 'p(1..2). p(a;b). p(-1). -p(a). p(1+1). p("a.b"). {p(e)}. p(a) :- p. p(A) :- q(A,_). not p(z).'


def test_facts_that_are_written_out_have_the_atoms_and_values_of_the_syntax_tree(tmp_path: Path) -> None:
    source = Source(tmp_path / "facts.lp", f"#const n = 2. #const c = d.\n{PLAIN}\n{OTHERS}")
    statements, problems = parse_sources([(source, True)])
    assert not problems
    plain = [each for each in statements if each.is_plain_fact]
    assert " ".join(each.text for each in plain) == PLAIN
    for each in plain:
        (atom,) = each.heads
        ((other,), _) = head_atoms(each.node.head)
        assert (atom.signature, atom.arguments, each.literals) == (other.signature, other.arguments, ())
    control = clingo.Control()
    control.add("base", [], source.text)
    control.ground([("base", [])])
    facts = {atom.symbol for atom in control.symbolic_atoms if atom.is_fact}
    found = find_alike(Program((source,)), [each for each in statements if each.line == 2 or not each.is_rule])
    assert {fact for instances in found.stated.values() for fact in instances} <= facts
    assert {str(fact) for each in plain for fact in found.stated[each]} >= {"p(d)", "p(f(d))", "q(2,7)", "p((1,))"}

"""Ground atoms are read the same by clingo's C interface as by its package, whatever they are."""

from __future__ import annotations

import clingo
import pytest

from prag_asp.program import atom_arrays

PROGRAM = """p. q(1). q(a). q(f(a,"b c")). q(-a). q(()). q((1,2)). q(#inf). q(#sup). { q(chosen) }.
-q(no). #external q(open). r(X,Y,Z) :- q(X), q(Y), q(Z), X < Y. { s }. :- not s, q(chosen).
"""


@pytest.mark.parametrize(
    ("name", "arity", "many"), [("p", 0, 1), ("q", 1, 10), ("r", 3, 450), ("s", 0, 1), ("t", 2, 0)]
)
def test_both_ways_to_read_atoms_agree(name: str, arity: int, many: int, monkeypatch: pytest.MonkeyPatch) -> None:
    control = clingo.Control(["--warn=none"])
    control.add("base", [], PROGRAM)
    control.ground([("base", [])])
    fast = list(atom_arrays.ground_atoms(control, name, arity))
    monkeypatch.setattr(atom_arrays, "internal", None)
    assert list(atom_arrays.ground_atoms(control, name, arity)) == fast
    assert len(fast) == many

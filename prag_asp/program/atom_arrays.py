"""Fast iteration over the ground atoms of a predicate, of which a domain may have 100,000.

The Python package of clingo makes a dozen wrapper calls for each atom. This module calls the functions of the C
interface directly if the installed version of the package has all of them.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import clingo

internal: Any
try:
    from clingo import _internal as internal
except ImportError:
    internal = None

OF_ATOMS = ("begin", "is_valid", "next", "symbol", "literal", "is_fact")
NEEDED = ("clingo_signature_create", "clingo_symbol_arguments", *(f"clingo_symbolic_atoms_{each}" for each in OF_ATOMS))
"""The required functions of the C interface."""

GroundAtom = tuple[list[clingo.Symbol], int, bool]
"""The arguments of an atom, its literal, and whether it is a fact."""


def ground_atoms(control: clingo.Control, name: str, arity: int) -> Iterator[GroundAtom]:
    """Yield the ground atoms of a predicate in no particular order."""
    symbolic_atoms = control.symbolic_atoms
    library, ffi = (getattr(internal, each, None) for each in ("_lib", "_ffi"))
    address = getattr(symbolic_atoms, "_rep", None)
    if ffi is None or address is None or not all(hasattr(library, each) for each in NEEDED):
        return (
            (atom.symbol.arguments, atom.literal, atom.is_fact) for atom in symbolic_atoms.by_signature(name, arity)
        )
    return _read(library, ffi, address, name, arity)


def _read(library: Any, ffi: Any, atoms: Any, name: str, arity: int) -> Iterator[GroundAtom]:
    """Yield the atoms in the C object `atoms`; the calls cannot fail here, so their results are not checked."""
    signature, place = ffi.new("clingo_signature_t*"), ffi.new("clingo_symbolic_atom_iterator_t*")
    symbol, literal, size = ffi.new("clingo_symbol_t*"), ffi.new("clingo_literal_t*"), ffi.new("size_t*")
    arguments, flag = ffi.new("clingo_symbol_t**"), ffi.new("bool*")
    terms: dict[int, clingo.Symbol] = {}
    library.clingo_signature_create(name.encode(), arity, True, signature)
    library.clingo_symbolic_atoms_begin(atoms, signature, place)
    is_valid, following = library.clingo_symbolic_atoms_is_valid, library.clingo_symbolic_atoms_next
    while is_valid(atoms, place[0], flag) and flag[0]:
        at = place[0]
        library.clingo_symbolic_atoms_symbol(atoms, at, symbol)
        library.clingo_symbol_arguments(symbol[0], arguments, size)
        library.clingo_symbolic_atoms_literal(atoms, at, literal)
        library.clingo_symbolic_atoms_is_fact(atoms, at, flag)
        row = []
        for term in ffi.unpack(arguments[0], arity) if arity else ():
            symbol_of_term = terms.get(term)
            if symbol_of_term is None:
                symbol_of_term = terms[term] = clingo.Symbol(term)  # type: ignore[no-untyped-call]
            row.append(symbol_of_term)
        yield row, literal[0], flag[0]
        following(atoms, at, place)

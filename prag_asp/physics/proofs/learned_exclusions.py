"""Exclusions proved from the geometry and physics of a scene: fluents that never hold, alone or in pairs.

They come only from proofs and only forbid fluents to hold, so they are Horn clauses, like all invariants of a domain:
they exclude exactly the plans with a state that is known to satisfy the premises of a proof, and each of these plans is
proved infeasible. Exclusions of three or more fluents are left to the physics checks: in partially known states,
clauses of three literals cannot be propagated exactly.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from itertools import combinations

import clingo

from prag_asp.atom import Atom, atom_of
from prag_asp.domain.load import Domain
from prag_asp.physics.proofs.prover import Prover
from prag_asp.physics.symbolic_facts import facts
from prag_asp.processes.progress_events import stage
from prag_asp.program.facts import Facts
from prag_asp.program.invariants import Graph, conflict, entailed, invariant_graph
from prag_asp.scene.scene import Scene

Fluents = tuple[Atom, ...]
"""One or two fluents, in the order of the domain."""

Proofs = Mapping[Fluents, str | None]
"""The reasons why fluents cannot hold together; a reason is None if the domain itself excludes them."""


def prove_exclusions(domain_facts: Facts, scene: Scene, tell: Callable[[str], None] = lambda words: None) -> Proofs:
    """Return the single fluents that never hold, and the pairs that never hold together.

    For pairs that the domain itself excludes, there is no reason. Only pairs that share an argument can exclude each
    other, because all proofs link facts by bodies.

    Raises:
        SceneError: the scene lacks the shape or the yaw of an entity in a spatial fluent.
    """
    stage("proving")
    prover, graph = Prover(scene), invariant_graph(domain_facts)
    proofs: dict[Fluents, str | None] = {}
    possible = []
    for symbol in domain_facts.fluents:
        fluent = atom_of(symbol)
        for fact in facts(scene, {fluent: True}):
            reason = prover.refutation([fact])
            if _excluded(graph, symbol):
                proofs[(fluent,)] = None
            elif reason is not None:
                proofs[(fluent,)] = reason
            else:
                possible.append((symbol, fluent, fact))
    for number, ((one, first, fact), (two, second, other)) in enumerate(combinations(possible, 2)):
        if number % 10_000 == 0:
            tell(f"{number} pairs of fluents tried, {len(proofs)} proofs")
        if set(first.arguments).isdisjoint(second.arguments):
            continue
        if _excluded(graph, one, two):
            proofs[first, second] = None
            continue
        reason = prover.refutation([fact, other])
        if reason is not None:
            proofs[first, second] = reason
    return proofs


def unproved_exclusions(domain: Domain, scene: Scene) -> Iterator[Fluents]:
    """Yield the learned exclusions of a domain that are not proved, for example because the scene has changed.

    Raises:
        SceneError: the scene lacks the shape or the yaw of an entity in a spatial fluent.
    """
    prover, graph = Prover(scene), invariant_graph(domain.facts)
    for pair in domain.learned:
        fluents = tuple(dict.fromkeys(atom_of(fluent) for fluent in pair))
        if not _excluded(graph, *pair) and prover.refutation(facts(scene, dict.fromkeys(fluents, True))) is None:
            yield fluents


def _excluded(graph: Graph, *fluents: clingo.Symbol) -> bool:
    """Return whether the invariants of a domain prevent fluents from holding together."""
    return conflict(entailed([(fluent, True) for fluent in fluents], graph)) is not None

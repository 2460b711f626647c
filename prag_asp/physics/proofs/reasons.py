"""State in words why facts cannot hold: impossible facts, exclusions, and lack of room.

Room is expressed by difference constraints, which are lower bounds on differences of coordinates. They are
unsatisfiable if and only if their graph has a cycle of positive length, which the Bellman-Ford algorithm finds.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence

from prag_asp.physics.predicates.gaps import ORIGIN, ROUNDING, Gap, Node, centre
from prag_asp.physics.predicates.predicate import words
from prag_asp.physics.proofs.placement_demands import bodies
from prag_asp.physics.situation import Situation, fixed_pose
from prag_asp.physics.symbolic_facts import Fact
from prag_asp.scene.scene import Scene

AXES = ("x", "y", "z")


def own_reasons(fact: Fact, scene: Scene) -> Iterator[str]:
    """Yield reasons why a fact can never hold."""
    predicate = fact.predicate
    if fact.value and len(set(fact.arguments)) < len(fact.arguments):
        yield f"it is impossible that {fact.sentence()}, because nothing is in a relation to itself"
        return
    if fact.value and predicate.impossible is not None:
        yield from predicate.impossible(scene, fact.arguments)
    entities = () if predicate.of_gripper or predicate.looks_around else bodies(fact, scene)
    traits = {entity: scene.shapes[entity].traits for entity in scene.fixed}
    still = [entity for entity, kind in traits.items() if kind.body and not kind.furniture]
    situation = Situation(scene, {entity: fixed_pose(scene, entity) for entity in still})
    if entities and all(entity in still for entity in entities) and not fact.is_satisfied(situation):
        yield f"it is impossible that {fact.sentence()}, because none of these bodies can move"


def gap_reasons(true: Sequence[Fact]) -> Iterator[str]:
    """Yield a sentence for each pair of facts one of which requires two objects to be closer than the other allows."""
    close = [fact for fact in true if fact.predicate.apart[1] < math.inf]
    for fact in true if close else ():
        least = fact.predicate.apart[0]
        for other in close:
            if other.predicate.apart[1] < least and {*other.arguments[:2]} == {*fact.arguments[:2]}:
                if all(each.predicate.inverse == each.predicate.name for each in (other, fact)):
                    ways = f"{words(other.predicate.name)} and {words(fact.predicate.name)}"
                    yield f"{' and '.join(map(words, fact.arguments))} cannot be {ways} at once"
                else:
                    yield _never_together((other, fact))


def exclusions(true: Sequence[Fact], scene: Scene) -> Iterator[str]:
    """Yield reasons why two facts exclude each other for all poses, according to the predicate of one of them."""
    for fact in true:
        if fact.predicate.excludes is not None:
            for other in true:
                reason = fact.predicate.excludes(scene, fact.arguments, other.predicate, other.arguments)
                if reason is not None:
                    yield reason


def room_reasons(true: Sequence[Fact], axis: int, gaps: Sequence[Gap]) -> Iterator[str]:
    """Yield reasons for a lack of room: cyclic relations, rows that are too long, positions that exclude each other."""
    row = impossible_row(gaps)
    if not row:
        return
    names = ", ".join(dict.fromkeys(words(entity) for entity, _ in row if entity))
    beside = [fact.predicate.direction is not None for fact in true]
    if ORIGIN not in row and all(aside or fact.predicate.supports for fact, aside in zip(true, beside, strict=True)):
        yield f"the relations along {AXES[axis]} form a cycle: {names}"
    elif any(beside):
        yield f"there is no room along {AXES[axis]} for the row {names}"
    else:
        yield _never_together(true)


def reach_reasons(true: Sequence[Fact], scene: Scene, gaps: Sequence[Iterable[Gap]]) -> Iterator[str]:
    """Yield the reasons why the facts leave no position for a body, for example within reach of a gripper."""
    if not any(fact.predicate.places and fact.arguments[-1] in scene.fixed for fact in true):
        return
    least = [lowest(gaps[axis], ORIGIN) for axis in (0, 1)]
    most = [lowest((Gap(high, low, length) for low, high, length in gaps[axis]), ORIGIN) for axis in (0, 1)]
    for fact in true:
        if fact.predicate.nowhere is not None:
            node = centre(fact.arguments[fact.predicate.subject])
            low = (least[0].get(node, -math.inf), least[1].get(node, -math.inf))
            high = (-most[0].get(node, -math.inf), -most[1].get(node, -math.inf))
            if fact.predicate.nowhere(scene, fact.arguments, low, high):
                yield _never_together(true)


def _never_together(facts: Iterable[Fact]) -> str:
    """Return a sentence that states one or more facts, and that they cannot hold together."""
    *others, last = [fact.sentence() for fact in facts]
    if not others:
        return f"it is impossible that {last}"
    return f"{', '.join(others)} and {last}, but these facts cannot hold together"


def impossible_row(gaps: Sequence[Gap]) -> tuple[Node, ...]:
    """Return a cycle of positive length: nodes, each of which must be above the previous one, or () if there is none.

    The cycle begins at the origin if it contains the origin.
    """
    heights = dict.fromkeys((node for gap in gaps for node in gap[:2]), 0.0)
    last: dict[Node, Gap] = {}
    node = ORIGIN
    for _ in range(len(heights) + 1):
        changed = False
        for gap in gaps:
            low, high, least = gap
            if heights[low] + least > heights[high] + ROUNDING:
                heights[high], last[high], node, changed = heights[low] + least, gap, high, True
        if not changed:
            return ()
    # Following the last gaps backwards from the node that was raised last leads into a cycle.
    for _ in heights:
        if node not in last:
            return ()
        node = last[node].low
    row, length, current = [node], last[node].least, last[node].low
    while current != node:
        row.append(current)
        length += last[current].least
        current = last[current].low
    if length <= ROUNDING:
        return ()
    row.reverse()
    turn = row.index(ORIGIN) if ORIGIN in row else 0
    return (*row[turn:], *row[:turn])


def lowest(gaps: Iterable[Gap], start: Node) -> Mapping[Node, float]:
    """Return the lower bounds that gaps imply on the differences between each coordinate and that of `start`.

    The gaps have to be satisfiable.
    """
    gaps = list(gaps)
    bounds = {start: 0.0}
    changed = True
    while changed:
        changed = False
        for low, high, least in gaps:
            if low in bounds and bounds[low] + least > bounds.get(high, float("-inf")) + ROUNDING:
                bounds[high] = bounds[low] + least
                changed = True
    return bounds

"""Random domains for hypothesis."""

from __future__ import annotations

from dataclasses import replace

from hypothesis import strategies as st

from tests.brute_force import Action, Toy

MAX_FLUENTS = 5


@st.composite
def toys(draw: st.DrawFn, *, closed: bool) -> Toy:
    """Draw a ground domain, open or closed, with invariants, unknown effects, goals and rules across time."""
    fluents = draw(st.integers(1, MAX_FLUENTS))
    fluent = st.integers(0, fluents - 1)
    pair = st.tuples(fluent, fluent)
    known = st.dictionaries(fluent, st.booleans(), max_size=3)
    effects = st.dictionaries(fluent, st.sampled_from([True, False, True, False, None]), max_size=3)
    actions = draw(
        st.lists(st.builds(Action, st.sampled_from(["a", "b", "c"]), known, effects), min_size=1, max_size=4)
    )
    if closed:
        actions = [Action(a.name, a.before, {f: v for f, v in a.after.items() if v is not None}) for a in actions]
    number = st.integers(0, len(actions) - 1)
    initially = {f: draw(st.booleans()) for f in range(fluents)} if closed else draw(known)
    return Toy(
        fluents,
        tuple(actions),
        initially,
        tuple(draw(st.lists(pair, max_size=3))),
        tuple(draw(st.lists(pair, max_size=3))),
        draw(st.one_of(st.just({}), known)),
        tuple(draw(st.lists(st.tuples(number, number), max_size=2))),
        draw(st.dictionaries(st.sampled_from(["a", "b"]), st.integers(0, 2), max_size=1)),
        tuple(draw(st.lists(st.tuples(number, fluent, fluent), max_size=2))) if closed else (),
    )


@st.composite
def hierarchies(draw: st.DrawFn, *, closed: bool) -> Toy:
    """Draw a ground domain with composites, some of them parts of others, and free actions."""
    toy = draw(toys(closed=closed))
    actions = len(toy.actions)
    composites: list[tuple[int, ...]] = []
    for _ in range(draw(st.integers(1, 4))):
        part = st.integers(0, actions + len(composites) - 1)
        composites.append(tuple(draw(st.lists(part, min_size=1, max_size=3))))
    free = draw(st.lists(st.integers(0, actions - 1), max_size=2, unique=True))
    return replace(toy, composites=tuple(composites), free=tuple(free))

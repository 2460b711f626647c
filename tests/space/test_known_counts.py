"""Every engine meets the known counts of every shipped domain."""

from __future__ import annotations

from pathlib import Path
from typing import cast

import pytest

from prag_asp import TaskSpace, load_domain
from prag_asp.program.paths import shipped_domains
from prag_asp.program.settings import read_table
from prag_asp.space.engines.engine import Level
from tests.known_counts import known_counts
from tests.spaces import with_engine

ENUMERABLE, FOUND_ONE_BY_ONE = 2000, 300
"""Above it, counting by enumeration, or by finding words one by one, takes too long for a test."""

UNROLLED, OF_SMALL = 5, 8
"""Lengths up to which words are found one by one: each step more repeats what those before it say. Formulas of small
domains are made for longer ones."""

DIAGRAMS, OF_MANY = 3, 2
"""Lengths up to which diagrams are made of the states: they are for regular worlds, and these are many. The household
with its 26 entities has the most."""


Row = tuple[str, str, int, tuple[str, ...], int]
"""A domain, a level such as ``task`` or ``flat.task``, a length, a prefix, and the count."""

Spaces = dict[tuple[str, bool, str], TaskSpace]


def known_rows() -> list[Row]:
    rows: list[Row] = []
    for domain, folder in shipped_domains().items():
        for level, counts in known_counts(folder).items():
            rows += [(domain, level, length, (), count) for length, count in counts.items()]
        for name, counts in read_table(folder / "counts.toml").get("skeleton_prefix", {}).items():
            rows += [(domain, "skeleton", int(n), (name,), count) for n, count in counts.items()]
    return sorted(rows, key=lambda row: (row[0], row[1].startswith("flat."), row[2]))  # levels of a length share much


COUNTS = known_rows()


@pytest.fixture(scope="module")
def spaces() -> Spaces:
    whole = {(row[0], row[1].startswith("flat.")) for row in COUNTS}
    loaded = {(domain, flat): TaskSpace(load_domain(domain, flat=flat), 0) for domain, flat in whole}
    return {
        (*key, engine): with_engine(space, engine)
        for key, space in loaded.items()
        for engine in ("automaton", "clingo", "sat", "symbolic")
    }


def every_other(rows: list[Row]) -> list[Row]:
    """Leave out every second length before the longest one of a level: the longer formulas contain the shorter ones."""
    longest = {(domain, level): length for domain, level, length, *_ in sorted(rows, key=lambda row: row[2])}
    return [row for row in rows if row[2] == 0 or (longest[row[0], row[1]] - row[2]) % 2 == 0]


def counted(spaces: Spaces, engine: str, row: Row) -> int:
    domain, level, length, prefix, _ = row
    flat, _, by = level.rpartition(".")
    return spaces[domain, bool(flat), engine].at(length).count(cast(Level, by), prefix)


@pytest.mark.parametrize("row", COUNTS, ids=str)
def test_the_automaton_meets_the_known_count(spaces: Spaces, row: Row) -> None:
    assert counted(spaces, "automaton", row) == row[4]


@pytest.mark.parametrize("row", every_other([row for row in COUNTS if row[4] <= ENUMERABLE]), ids=str)
def test_clingo_meets_the_known_count(spaces: Spaces, row: Row) -> None:
    assert counted(spaces, "clingo", row) == row[4]


@pytest.mark.parametrize(
    "row",
    every_other(
        [
            row
            for row in COUNTS
            if row[4] <= FOUND_ONE_BY_ONE and row[2] <= (OF_SMALL if row[0] in ("prag", "hanoi") else UNROLLED)
        ]
    ),
    ids=str,
)
def test_sat_meets_the_known_count(spaces: Spaces, row: Row) -> None:
    assert counted(spaces, "sat", row) == row[4]


@pytest.mark.parametrize(
    "row", [row for row in COUNTS if row[2] <= (OF_MANY if row[0] == "household" else DIAGRAMS)], ids=str
)
def test_diagrams_meet_the_known_count(spaces: Spaces, row: Row) -> None:
    assert counted(spaces, "symbolic", row) == row[4]


def test_every_shipped_domain_has_known_counts() -> None:
    assert {row[0] for row in COUNTS} == set(shipped_domains()) >= {"prag", "tabletop", "blocks", "hanoi"}
    assert {row[0] for row in COUNTS if row[1] == "flat.plan"} == {"kitchen", "two_arms", "household"}


def test_a_count_of_a_thousand_actions_is_exact() -> None:
    count = TaskSpace(load_domain("prag"), 1000).count("skeleton")
    assert len(str(count)) == 629
    assert count % (10**9 + 7) == 450993787


def test_plans_of_hanoi_are_walks_in_the_hanoi_graph() -> None:
    """Counted here by hand: a state is the peg of each disc, and a disc moves if no smaller one is on its pegs."""
    space = TaskSpace(load_domain("hanoi"), 0)
    walks = {(0, 0, 0): 1}
    for length in range(30):
        assert space.at(length).count("plan") == sum(walks.values())
        following: dict[tuple[int, ...], int] = {}
        for state, number in walks.items():
            for disc in range(3):
                for peg in {0, 1, 2} - {state[disc]}:
                    if not {state[disc], peg} & set(state[:disc]):
                        after = (*state[:disc], peg, *state[disc + 1 :])
                        following[after] = following.get(after, 0) + number
        walks = following


def test_the_closed_domain_of_the_measurements_has_the_measured_counts(tmp_path: Path) -> None:
    """3 objects, 2 locations, all at the first one; several counters agreed on these numbers."""
    text = (load_domain("prag").folder / "domain.lp").read_text()
    text = text.replace("entity((apple_1; apple_2), apple).", "entity((apple_1; apple_2; apple_3), apple).")
    text = text.replace("entity(box_1, box).", "").replace("entity(can_1, can).", "")
    text = text.replace("class(box, graspable).", "").replace("class(can, graspable).", "")
    start = '\n#include "rules/closed_world.lp".\ninitially(open(panda), true).\n'
    start += "initially(located(O,bowl_1), true) :- is_a(O,graspable).\n"
    start += "initially(rotated(O,straight), true) :- is_a(O,graspable).\n"
    (tmp_path / "domain.lp").write_text(text + start)
    space = TaskSpace(load_domain(tmp_path), 0)
    assert space.at(7).count("plan") == 125_568
    assert space.at(15).count("skeleton") == 191_264_896
    assert len(str(space.at(30).count("plan"))) == 27

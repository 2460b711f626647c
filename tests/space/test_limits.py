"""Limits end with what is known: a lower bound that says so."""

from __future__ import annotations

import itertools
import re
from pathlib import Path

import pytest

from prag_asp import QueryError, TaskSpace, load_domain
from prag_asp.errors import LimitReached
from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.space import limits
from prag_asp.space.automaton.bounded_count import count_within
from prag_asp.space.engines.automaton_engine import AutomatonEngine
from prag_asp.space.limits import Limits, memory_in_use, parse_memory, parse_time
from prag_asp.stop_reason import StopKind, StopReason
from tests.domains import domain_of
from tests.space.automaton.test_exploration import LAMPS

AT_ONCE = Limits(seconds=0)

TOGETHER = "#program step(t). :- holds(F,true,t) : fluent(F).\n"
"""A rule that all lamps have part in, so that they cannot be counted apart."""


@pytest.mark.parametrize(("engine", "by"), [("automaton", "plan"), ("automaton", "task"), ("automaton", "skeleton")])
def test_a_time_limit_gives_a_lower_bound_on_the_count(engine: str, by: str) -> None:
    space = TaskSpace(domain_of(LAMPS.replace("K", "16")), 14, engine=engine)
    with pytest.raises(
        LimitReached, match=rf"the time limit of 0 s was reached .* at least \d+ {by}s of length 14"
    ) as e:
        TaskSpace(space.domain, 14, engine=engine, limits=AT_ONCE).count(by)
    assert 0 <= e.value.at_least <= space.count(by)


def test_a_limit_is_looked_at_in_every_layer_so_that_more_time_finds_more(monkeypatch: pytest.MonkeyPatch) -> None:
    """The clock advances by 5 ms whenever it is looked at."""
    monkeypatch.setattr(limits, "monotonic", itertools.count(0, 0.005).__next__)
    domain = domain_of(LAMPS.replace("K", "17"))
    found = []
    for seconds in (0.015, 0.06):
        with pytest.raises(LimitReached) as reached:
            TaskSpace(domain, 17, limits=Limits(seconds=seconds)).count("plan")
        found.append(reached.value.at_least)
    assert 0 <= found[0] < found[1] < 17**17


def test_a_memory_limit_below_what_is_in_use_stops_at_once() -> None:
    domain = domain_of(LAMPS.replace("K", "12"))
    with pytest.raises(LimitReached, match=r"the memory limit of [\d,]+ MB was reached") as reached:
        TaskSpace(domain, 12, limits=Limits(memory_bytes=memory_in_use() // 2)).count("plan")
    assert reached.value.at_least < 12**12
    assert TaskSpace(domain, 12, limits=Limits(memory_bytes=memory_in_use() + 10**9)).count("plan") == 12**12


def test_words_and_ranks_are_refused_where_some_are_missing() -> None:
    space = TaskSpace(domain_of(LAMPS.replace("K", "16")), 14, limits=AT_ONCE)
    with pytest.raises(LimitReached):
        next(space.enumerate("plan"))
    with pytest.raises(LimitReached):
        space.sample(1, seed=0)


def test_clingo_says_how_many_it_has_enumerated() -> None:
    domain = domain_of(LAMPS.replace("K", "12"))

    def found(seconds: float) -> int:
        with pytest.raises(LimitReached, match=r"at least \d+ plans of length 12") as reached:
            TaskSpace(domain, 12, engine="clingo", limits=Limits(seconds=seconds)).count("plan")
        return reached.value.at_least

    # A machine that stands still finds none in the first half second.
    some = (at_least for seconds in (0.5, 5, 50, 500) if (at_least := found(seconds)))
    assert 0 < next(some) < 12**12


TIME = StopReason(StopKind.TIME, 1.0)


@pytest.mark.parametrize("stop_after", [0, 1, 5, 29])
def test_counting_that_is_stopped_knows_the_words_that_begin_with_one_path(stop_after: int) -> None:
    engine = AutomatonEngine(DomainLogic(load_domain("prag")), "plan")
    completions, calls = engine.explored(30).completions, iter(range(100))
    found, stop = count_within(completions, 30, lambda: TIME if next(calls) >= stop_after else None)
    assert stop == TIME and 0 < found < engine.count(30)
    assert found >= engine.count(stop_after) // 48  # at least what completes some state that 48 actions lead to
    assert count_within(completions, 30, lambda: None) == (engine.count(30), None)


def test_a_count_that_is_stopped_follows_its_path_to_the_end_however_long_that_is() -> None:
    completions = AutomatonEngine(DomainLogic(load_domain("prag")), "plan").explored(40).completions
    automaton, calls = completions.automaton, iter(range(1000))
    for length in range(6, 40):
        until = next(calls) + 5
        found, _ = count_within(completions, length, lambda until=until: TIME if next(calls) >= until else None)
        row, state = completions.row(4), 0
        for _ in range(length - 4):
            edges = range(int(automaton.offsets[state]), int(automaton.offsets[state + 1]))
            state = int(automaton.targets[max(edges, key=lambda edge: int(row[automaton.targets[edge]]))])
        assert found == int(row[state])
    begun = next(calls)
    far, stop = count_within(completions, 10**18, lambda: TIME if next(calls) >= begun + 100 else None)
    assert stop == TIME and far > 10**90


def test_a_long_count_says_how_far_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("prag_asp.space.engines.automaton_engine.count_by_recurrence", lambda *_: None)
    told: list[str] = []
    space = TaskSpace(load_domain("hanoi"), 12_000, progress=told.append, limits=Limits(cached=False))
    reach = AutomatonEngine(DomainLogic(load_domain("hanoi")), "plan").explored(12_000)
    assert space.count("plan") == int(reach.completions.last_row(12_000)[0])
    assert "counted 8,192 of 12,000 actions" in told


@pytest.mark.parametrize(
    ("text", "number"), [("4GB", 4 * 10**9), ("512 MiB", 2**29), ("1.5k", 1500), ("2gib", 2**31), ("77", 77)]
)
def test_memory_is_written_with_a_unit(text: str, number: int) -> None:
    assert parse_memory(text) == number


@pytest.mark.parametrize(("text", "seconds"), [("60s", 60), ("1.5m", 90), ("2h", 7200), ("7", 7), ("3min", 180)])
def test_time_is_written_with_a_unit(text: str, seconds: float) -> None:
    assert parse_time(text) == seconds


@pytest.mark.parametrize("text", ["", "GB", "-1", "4 GX", "0", "1e9", "4GB4"])
def test_what_is_no_limit_is_refused(text: str) -> None:
    with pytest.raises(QueryError, match="write a number of bytes"):
        parse_memory(text)
    with pytest.raises(QueryError, match="write a time above 0"):
        parse_time(text)


def test_the_command_prints_the_lower_bound_and_exits_with_its_own_code(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    from prag_asp.cli import cli

    folder = tmp_path / "lamps"
    folder.mkdir()
    (folder / "domain.lp").write_text(LAMPS.replace("K", "40") + TOGETHER)
    assert cli.main(["count", str(folder), "--length", "40", "--by", "plan", "--time", "0.1s"]) == 3
    out, err = capfd.readouterr()
    assert re.fullmatch(r"at least \d+\n", out) and "the time limit of 0.1 s was reached" in err
    assert cli.main(["count", str(folder), "--length", "40", "--by", "plan", "--time", "0.1s", "--upto"]) == 3
    out, _ = capfd.readouterr()
    assert out.startswith("length  plans\n") and re.fullmatch(r" +\d+  at least \d+", out.splitlines()[-1])
    assert cli.main(["sample", str(folder), "--length", "40", "--time", "0.1s"]) == 3

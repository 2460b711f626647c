"""Parts of whole skeletons are disjoint, are all together, and have the shares asked for or a warning."""

from __future__ import annotations

from pathlib import Path

import pytest

from prag_asp import QueryError, TaskSpace, load_domain
from prag_asp.space.conditions.clause_kinds import Part
from prag_asp.space.conditions.condition import Condition
from prag_asp.space.conditions.whole_skeletons import SharesWarning
from tests.commands import run
from tests.domains import domain_of

SKEWED = "fluent(f). initially(f,true). action(a(1..9)). action(b(1..3)). action(c). action(d(1..2))."
LARGE = "fluent(f). initially(f,true). action(a(1..40)). action(b)."


@pytest.mark.parametrize("shares", [{"train": 0.8, "test": 0.2}, {"a": "1/2", "b": "3/10", "c": "1/5"}])
def test_shares_are_met_by_whole_skeletons_and_different_seeds_choose_different_ones(
    shares: dict[str, float | str],
) -> None:
    space = TaskSpace(domain_of(SKEWED), 3)
    tasks, last = set(space.enumerate("task")), set[frozenset[tuple[str, ...]]]()
    for seed in range(5):
        parts = space.split_skeletons(shares, seed=seed)
        words = [set(part.enumerate("task")) for part in parts.values()]
        assert sum(map(len, words)) == len(tasks) == space.count() and set().union(*words) == tasks
        skeletons = [frozenset(part.enumerate("skeleton")) for part in parts.values()]
        assert sum(map(len, skeletons)) == len(frozenset().union(*skeletons)) == space.count("skeleton")
        for part, share in zip(parts.values(), (0.8, 0.2) if len(shares) == 2 else (0.5, 0.3, 0.2), strict=True):
            assert abs(part.count() / space.count() - share) <= 0.02
            assert {part.index(part[rank]) for rank in range(0, part.count(), 97)} == set(range(0, part.count(), 97))
        last.add(skeletons[-1])
    assert len(last) > 2


def test_nine_skeletons_of_a_shipped_domain_meet_their_shares() -> None:
    space = TaskSpace(load_domain("tabletop"), 4)
    test = space.split_skeletons({"train": 0.8, "test": 0.2}, seed=3)["test"]
    assert abs(test.count() / space.count() - 0.2) <= 0.02


@pytest.mark.parametrize("seed", [0, 7])
def test_the_skeletons_of_a_part_are_those_that_engines_find(seed: int) -> None:
    space = TaskSpace(domain_of(SKEWED), 3)
    skeletons = list(space.enumerate("skeleton"))
    for residues in ((0,), (1, 2, 4), ()):
        part = Part(residues, 5, seed)
        found = set(space.part(Condition((part,))).enumerate("skeleton"))
        assert [skeleton in found for skeleton in skeletons] == part.includes(skeletons)


def test_the_nearest_that_whole_skeletons_allow_comes_with_a_warning() -> None:
    space = TaskSpace(domain_of(LARGE), 1)
    said = (
        r"^train has 97\.6 %, test has 2\.4 % of the tasks, not 80 %, 20 %: no choice of whole skeletons comes closer"
    )
    with pytest.warns(SharesWarning, match=said):
        parts = space.split_skeletons({"train": 0.8, "test": 0.2})
    assert {name: part.count() for name, part in parts.items()} == {"train": 40, "test": 1}
    with pytest.warns(SharesWarning, match=r"a has 0\.0 %, b has 100\.0 %|a has 100\.0 %, b has 0\.0 %"):
        empty = space.at(0).split_skeletons({"a": "1/2", "b": "1/2"})
    assert sorted(part.count() for part in empty.values()) == [0, 1]


def test_classes_are_adjusted_where_there_are_too_many_skeletons_to_list(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("prag_asp.space.conditions.whole_skeletons.MOST_SKELETONS", 3)
    space = TaskSpace(domain_of(SKEWED), 4)
    for seed in range(3):
        parts = space.split_skeletons({"train": 0.8, "test": 0.2}, seed=seed)
        assert sum(part.count() for part in parts.values()) == space.count() == 15**4
        assert abs(parts["test"].count() / space.count() - 0.2) <= 0.02
        assert all("part" in str(part.condition) for part in parts.values())


def test_the_command_warns_on_standard_error(tmp_path: Path) -> None:
    file = tmp_path / "large.lp"
    file.write_text(LARGE, encoding="utf-8")
    done = run("split", str(file), "--length", "1", "train=0.8", "test=0.2", "--skeletons")
    assert done.returncode == 0
    assert done.stdout == "train  40\ntest   1\n"
    assert "warning: train has 97.6 %, test has 2.4 % of the tasks, not 80 %, 20 %" in done.stderr


@pytest.mark.parametrize("digits", [6, 60])
def test_shares_with_many_digits_need_no_more_classes(digits: int) -> None:
    space = TaskSpace(domain_of(SKEWED), 3)
    third = int("3" * digits)
    shares = {"a": f"{third}/{10**digits}", "b": f"{10**digits - third}/{10**digits}"}
    parts = space.split_skeletons(shares)
    assert parts["a"].count() + parts["b"].count() == space.count()
    assert abs(parts["a"].count() / space.count() - 1 / 3) <= 0.02
    assert not set(parts["a"].enumerate("skeleton")) & set(parts["b"].enumerate("skeleton"))


def test_a_share_below_one_class_of_many_is_refused() -> None:
    space = TaskSpace(domain_of(SKEWED), 2)
    with pytest.raises(QueryError, match="share of 'b': parts of whole skeletons have shares of at least 1/1000"):
        space.split_skeletons({"a": "0.99999", "b": "0.00001"})
    with pytest.raises(QueryError, match="there are at most 10,000 classes of skeletons"):
        space.where("part 0-1 of 2000000000 by seed 1")


def test_bounds_far_above_the_length_take_no_more_states() -> None:
    space = TaskSpace(domain_of(SKEWED), 2)
    whole, bounded = space.count("plan"), space.where("has at most 1000000000 a", "has at most 2000000000 c")
    assert bounded.count("plan") == whole
    assert bounded.at(3).count("plan") == space.at(3).count("plan")
    assert space.where("has exactly 1000000000 a").count("plan") == 0
    some = space.at(120).where("has at most 110 c")
    assert space.at(120).count("plan") - some.count("plan") == space.at(120).where("has at least 111 c").count("plan")

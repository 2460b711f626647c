"""A scenario id makes the same task and the same initial state again, in any process, or is refused."""

from __future__ import annotations

import json
from itertools import islice
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from prag_asp import Dataset, Domain, QueryError, TaskSpace, load_domain
from prag_asp.dataset import Scenario, Scenarios, SearchStart, exclude, feasible, generate, read_scenarios
from prag_asp.dataset.scenarios import searched, start_of
from prag_asp.dataset.scenes import scene_of
from prag_asp.physics import Budget, Staging, Tier, Witness, open_validator
from tests.commands import ok, ok_apart, run

NAMES = st.text(st.characters(min_codepoint=32, max_codepoint=0x2FFF), min_size=1, max_size=12)
STARTS = st.builds(
    SearchStart.of,
    st.integers(0, 2**63 - 1), st.integers(0, 2**62),
    st.none() | st.builds(Budget, st.integers(1, 99), st.integers(1, 99), st.sampled_from(Tier)),
    st.none() | st.just(Staging(vary=("friction", "colour"))),
)  # fmt: skip


@given(
    st.builds(
        Scenario, NAMES, st.from_regex("[0-9a-f]{10}", fullmatch=True), st.integers(0, 10**9 - 1),
        st.integers(0, 10**300), st.none() | STARTS, st.lists(NAMES, max_size=2).map(tuple),
        st.dictionaries(NAMES, NAMES, max_size=2),
    )
)  # fmt: skip
def test_an_id_is_one_plain_word_from_which_the_scenario_is_parsed(scenario: Scenario) -> None:
    text = str(scenario)
    assert Scenario.parse(text) == scenario
    assert text.isascii() and text.isprintable() and not set(text) & set(" '\"$`\\&|;<>()*?[]{}!#")


@pytest.mark.parametrize(
    "text",
    [
        "", "tabletop", "tabletop:461e70e6a4:2", "tabletop:461E70E6A4:2:1", "tabletop:461e70e6a4:02:1",
        "tabletop:461e70e6a4:2:-1", "tabletop:461e70e6a4:2:1:", "tabletop:461e70e6a4:2:1:7",
        "tabletop:461e70e6a4:2:1:7.1.10x10-kinematics", "tabletop:461e70e6a4:2:1:7.1.10x10-no_tier",
        "tabletop:461e70e6a4:2:1:7.1.5x5-kinematics-friction", "tabletop:461e70e6a4:2:1~uses can_1",
        "tabletop:461e70e6a4:2:1~%75ses+can_1", "tabletop:461e70e6a4:2:1~", " tabletop:461e70e6a4:2:1",
        "tabletop:461e70e6a4:2:1\n", "tabletop:461e70e6a4:2:\N{ARABIC-INDIC DIGIT ONE}",
    ],
)  # fmt: skip
def test_any_other_spelling_is_refused_in_one_line(text: str) -> None:
    with pytest.raises(QueryError, match="is not a scenario id") as error:
        Scenario.parse(text)
    assert "\n" not in str(error.value)


@pytest.fixture(scope="module")
def dataset(tmp_path_factory: pytest.TempPathFactory, tabletop: Domain) -> Dataset:
    space = TaskSpace(tabletop, range(1, 3)).where("uses can_1")
    return generate(
        space, tmp_path_factory.mktemp("scenarios") / "data", tasks=3, starts=2, seed=3, budget=Budget(5, 9)
    )


def test_scenarios_of_a_dataset_make_its_tasks_and_witnesses_again(dataset: Dataset) -> None:
    domain = load_domain("tabletop")
    scenarios, ids = Scenarios(domain), set[str]()
    with open_validator(scene_of(domain)) as validator:
        for number, (entry, start, witness) in enumerate(dataset.witnesses()):
            scenario = Scenario.parse(str(dataset.scenario(number // 2, start)))
            assert scenario.start is not None and scenario.where == ("uses can_1",)
            assert scenarios.task(scenario).actions == entry.task.actions
            record = searched(scenarios.task(scenario), scenario.start, validator)
            assert Witness.from_json(record.witness or {}) == witness
            ids.add(str(scenario))
    assert len(ids) == 6 and len({scenario.task for scenario in map(Scenario.parse, ids)}) == 3


def test_a_fresh_process_prints_the_sampled_task_and_witness() -> None:
    sampled = ["sample", "tabletop", "-n", "2", "--count", "2", "--seed", "5", "--budget", "8x9"]
    records = ok(*sampled, "--format", "jsonl").splitlines()
    ids = ok(*sampled, "--format", "scenario").split()
    again = ok_apart("scenario", *ids, "--format", "jsonl").splitlines()
    for one, two in zip(map(json.loads, records), map(json.loads, again), strict=True):
        assert one.pop("log_probability") is not None and two.pop("log_probability") is None
        assert one == two
    assert ok("scenario", ids[0], "--format", "scenario").split() == [ids[0].rpartition(":")[0]]


def test_each_task_of_a_space_has_its_own_id() -> None:
    ids = ok("enumerate", "tabletop", "-n", "0..1", "--where", "uses can_1", "--format", "scenario").split()
    tasks = ok("enumerate", "tabletop", "-n", "0..1", "--where", "uses can_1").splitlines()
    assert len({*ids}) == len(tasks)
    assert ok("scenario", *ids, "--format", "text").splitlines() == tasks
    assert run("enumerate", "tabletop", "-n", "1", "--by", "plan", "--format", "scenario").returncode == 2


def test_the_tasks_of_a_part_have_the_ids_of_the_whole_space() -> None:
    space = TaskSpace(load_domain("tabletop"), 1)
    parts = space.hold_out("bin_1")
    scenarios = Scenarios(space.domain)
    found = [scenarios.of(part, task) for part in parts for task in part]
    assert sorted(each.rank for each in found) == [*range(space.count())]
    assert all(scenarios.task(each) == space[each.rank] for each in found)


def test_another_state_of_the_domain_is_refused(tmp_path: Path) -> None:
    folder = tmp_path / "mine"
    folder.mkdir()
    original = load_domain("tabletop").folder
    assert original is not None
    logic, settings = ((original / name).read_text(encoding="utf-8") for name in ("domain.lp", "domain.toml"))

    def digest(logic: str = logic, settings: str = settings) -> str:
        (folder / "domain.lp").write_text(logic, encoding="utf-8")
        (folder / "domain.toml").write_text(settings, encoding="utf-8")
        return Scenarios(load_domain(folder)).digest

    assert digest() == Scenarios(load_domain("tabletop")).digest == digest(logic + "\n% a comment\n")
    assert digest(settings=settings.replace("size = [0.05, 0.05, 0.05]", "size = [0.05, 0.05, 0.04]")) != digest()
    (identity,) = ok("sample", str(folder), "-n", "1", "--count", "1", "--no-physics", "--format", "scenario").split()
    assert ok("scenario", identity, cwd=tmp_path).startswith(f"id     {identity}\n")
    digest(logic + "\nentity(cube_9, cube).\n")
    done = run("scenario", identity, cwd=tmp_path)
    assert done.returncode == 2 and "has changed since" in done.stderr and done.stderr.count("\n") == 1


def test_a_later_sample_without_the_tasks_of_an_earlier_one_has_all_others(tmp_path: Path) -> None:
    sample = ["sample", "tabletop", "-n", "1", "--no-physics", "--distinct"]
    file = tmp_path / "ids"
    file.write_text(ok(*sample, "--count", "6", "--seed", "1", "--format", "scenario"), encoding="utf-8")
    earlier = set(ok(*sample, "--count", "6", "--seed", "1").splitlines())
    whole = ok("enumerate", "tabletop", "-n", "1").splitlines()
    later = ok(*sample, "--count", str(len(whole) - 6), "--seed", "2", "--except", str(file)).splitlines()
    assert set(later) == set(whole) - earlier and len(later) == len(whole) - 6
    assert run(*sample, "--count", str(len(whole) - 5), "--except", str(file)).returncode == 1
    assert run(*sample[:-1], "--except", str(file)).returncode == 2, "with replacement"
    done = run(*sample, "--where", "uses can_1", "--except", str(file))
    assert done.returncode == 2 and "the scenario has other conditions" in done.stderr
    space = TaskSpace(load_domain("tabletop"), 1)
    keep = exclude(space, read_scenarios(file))
    assert not earlier & {str(record.task) for record in islice(feasible(space, seed=3, distinct=True, keep=keep), 5)}


def test_a_record_without_a_verdict_has_no_search(tabletop: Domain) -> None:
    (record,) = islice(feasible(TaskSpace(tabletop, 1), seed=3, budget=Budget(2, 8)), 1)
    assert str(start_of(record)).startswith("3.") and str(start_of(record)).endswith(".2x8-kinematics")
    assert start_of(type(record)(record.task)) is None

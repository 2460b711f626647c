"""Datasets as they are made: what is drawn, what is kept, and that it goes on where it was broken off."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

import pyarrow.parquet as pq
import pytest

from prag_asp import Dataset, OutputError, QueryError, TaskSpace, load_domain
from prag_asp.dataset import InstructionWriter, generate, instruction, instruction_writer_of, validation_jobs, verify
from prag_asp.dataset.language.appearance import BASIC, color_terms
from prag_asp.dataset.making.executors import LocalExecutor
from prag_asp.dataset.making.run import JOURNAL
from prag_asp.dataset.scenes import scene_of
from prag_asp.dataset.store import instructions, shard_writer
from prag_asp.dataset.validation_jobs import JobResult, ValidationJob, ValidationSetup, initial_state_key
from prag_asp.errors import NotFound
from prag_asp.physics import Budget, Staging, check_demonstration
from tests.dataset.conftest import HALVES, POOR, SHARES, SMALL
from tests.output.faults import Disk, content, killed

SAMPLES = 8
"""At how many moments a run is broken off, of all at which it asks something of the disk."""


@pytest.fixture(scope="module")
def plain(kitchen: TaskSpace, tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Path]:
    """Return what makes a dataset without physics, in a folder."""

    def make(folder: Path, tasks: int) -> Path:
        generate(kitchen, folder, tasks=tasks, seed=3, weights={}, physics=False, shard=2, split=HALVES)
        return folder

    return make


def test_tasks_are_different_feasible_and_have_their_ranks_and_shares(small: Dataset, spaces: TaskSpace) -> None:
    manifest = small.manifest
    assert [(part.name, part.tasks) for part in manifest.parts] == [("train", 9), ("test", 3)]
    entries = list(small.entries())
    assert len({(len(entry.task), entry.rank) for entry in entries}) == 12
    for entry in entries:
        assert spaces.at(len(entry.task)).index(entry.task) == entry.rank
        assert entry.verdict is not None and entry.verdict.feasible and entry.verdict.budget == POOR
        assert (entry.verdict.seed, entry.verdict.index) == (5, entry.draw)
        assert list(entry.instruction) == ["vague", "default", "exact"] and not entry.named
        assert len(entry.subgoals) == len(entry.task)
    assert sum(int(space.tasks) for space in manifest.spaces) == spaces.count() == manifest.size
    assert manifest.covered is not None
    assert int(manifest.covered.denominator) * manifest.rows("tasks") == spaces.count() * int(
        manifest.covered.numerator
    )


def test_rejected_tasks_are_kept_with_their_causes_and_each_draw_is_one_or_the_other(small: Dataset) -> None:
    rejected = list(small.rejected())
    assert rejected and all(entry.verdict is not None and not entry.verdict.feasible for entry in rejected)
    assert all(entry.verdict is not None and entry.verdict.reason for entry in rejected)
    for part in small.manifest.parts:
        kept = [entry.draw for entry in small.part(part.name).entries()]
        others = [entry.draw for entry in rejected if entry.part == part.name]
        assert sorted(kept + others) == list(range(part.draws))
        assert sum(each.drawn for each in part.lengths) == part.draws
        assert sum(reason.count for each in part.lengths for reason in each.reasons) == len(others)


def test_several_workers_and_going_on_make_the_same_bytes(small: Dataset, spaces: TaskSpace, tmp_path: Path) -> None:
    for tasks, workers in ((5, 1), (12, 2)):
        generate(spaces, tmp_path / "same", **{**SMALL, "tasks": tasks}, workers=workers)
    assert content(tmp_path / "same") == content(small.folder)


def test_the_same_request_writes_nothing_and_more_tasks_leave_full_shards_untouched(
    plain: Callable[..., Path], tmp_path: Path
) -> None:
    folder = plain(tmp_path / "grown", 6)
    times = {path: path.stat().st_mtime_ns for path in folder.rglob("*")}
    plain(folder, 6)
    assert {path: path.stat().st_mtime_ns for path in folder.rglob("*") if path != folder} == times
    before = {path: path.stat().st_mtime_ns for path in folder.rglob("*-0000[01].parquet") if path.name[-9] == "0"}
    assert len(before) == 3  # also a shard of rejected tasks, the trivial ones
    assert content(plain(folder, 12)) == content(plain(tmp_path / "whole", 12))
    assert {path: path.stat().st_mtime_ns for path in before} == before


def test_another_version_of_the_program_goes_on_and_is_noted(
    plain: Callable[..., Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = plain(tmp_path / "grown", 6)
    monkeypatch.setattr(shard_writer, "versions", lambda: "prag_asp 9.9")
    (part, _) = Dataset.open(plain(folder, 12)).manifest.parts
    whole, grown, *new = (set(shard.versions.split("; ")) for shard in part.shards)
    assert whole.isdisjoint({"prag_asp 9.9"}) and grown == whole | {"prag_asp 9.9"} and new == [{"prag_asp 9.9"}]


def test_recordings_stand_beside_their_witnesses(spaces: TaskSpace, tmp_path: Path) -> None:
    staging = Staging(("front",), (32, 32), rate=1)
    data = generate(
        spaces.at(1), tmp_path / "shown", tasks=2, seed=2, starts=2, demonstrate=True, staging=staging, language="de"
    )
    assert all(set(entry.instruction) == {"vague", "default", "exact"} for entry in data.entries())
    assert "den" in " ".join(data.entry(0).instruction.values()).split()
    found = [(entry.number, start, demonstration) for entry, start, demonstration in data.demonstrations()]
    assert [key[:2] for key in found] == [(0, 0), (0, 1), (1, 0), (1, 1)]
    scene = scene_of(spaces.domain)
    for number, start, demonstration in found:
        assert demonstration == data.demonstration(number, start)
        assert demonstration.success and check_demonstration(data.task(number), demonstration, scene) == []
        assert demonstration.footage is not None


def test_instructions_name_the_colours_of_the_recording(spaces: TaskSpace, tmp_path: Path) -> None:
    staging = Staging(("front",), (16, 16), 1, ("colour",))
    stacks = spaces.at(2).where("uses exactly 2 cube", "has stack")
    data = generate(stacks, tmp_path / "data", tasks=3, seed=3, demonstrate=True, staging=staging)
    usual, other = instruction_writer_of(spaces.domain), 0
    for entry, _, demonstration in data.demonstrations():
        assert demonstration.variation is not None
        shown = {**scene_of(spaces.domain).colors, **demonstration.variation.colours}
        terms = {term for name in entry.task.entities if name in shown for term in color_terms(shown[name])}
        said = {term for term in BASIC if f" {term} " in entry.instruction["default"]}
        assert said <= terms
        teller = instruction_writer_of(spaces.domain, colors=demonstration.variation.colours)
        told = teller.instructions(entry.task, seed=3)
        assert told.default == entry.instruction["default"] and told.subgoals == entry.subgoals
        assert teller.read(entry.task, entry.instruction["exact"]).actions == entry.task.actions
        other += usual.instructions(entry.task, seed=3).default != entry.instruction["default"]
    assert other and [*verify(tmp_path / "data")] == []
    with pytest.raises(QueryError, match="2 starts have 2; request 1 start, or do not vary colour"):
        generate(spaces, tmp_path / "none", tasks=1, demonstrate=True, staging=staging, starts=2)
    assert not (tmp_path / "none").exists()


def test_a_search_without_a_new_initial_state_is_replaced(spaces: TaskSpace, tmp_path: Path) -> None:
    data = generate(spaces.at(2), tmp_path / "by_1", tasks=2, seed=5, starts=6, budget=POOR)
    for entry in data.entries():
        assert entry.number is not None
        rows = [*data.part("train").witnesses()]
        states = [initial_state_key(witness) for each, _, witness in rows if each.number == entry.number]
        numbers = [start for each, start, _ in rows if each.number == entry.number]
        assert len(set(states)) == len(states) == entry.starts and numbers == [*range(entry.starts)]
    assert {entry.starts for entry in data.entries()} == {6}
    table = pq.read_table(tmp_path / "by_1" / "witnesses").to_pylist()
    searches = [(row["index"] - data.entry(row["task"]).draw) // validation_jobs.START for row in table]
    assert max(searches) > 5 and max(searches) < validation_jobs.TRIES * 6


def test_a_task_with_fewer_initial_states_than_requested_counts_them(
    spaces: TaskSpace, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(validation_jobs, "initial_state_key", lambda witness: "the same")
    data = generate(spaces.at(1), tmp_path / "data", tasks=1, seed=5, starts=3)
    assert [entry.starts for entry in data.entries()] == [1] and data.manifest.rows("witnesses") == 1


def test_a_task_without_an_unambiguous_text_is_described_by_names(
    spaces: TaskSpace, monkeypatch: pytest.MonkeyPatch
) -> None:
    def unsure(self: object, *_: object) -> None:
        raise QueryError("it could mean something else")

    task = spaces.at(1)[0]
    monkeypatch.setattr(InstructionWriter, "instructions", unsure)
    found = instructions.captioner_of(spaces.domain, "en", 0)(task, {})
    assert found.whole == (("plain", instruction(task, spaces.domain.settings.language)),)
    assert found.subgoals == (found.whole[0][1],) and set(found.named) == set(task.entities)


def test_at_each_failure_of_the_disk_the_same_command_goes_on_to_the_same_bytes(
    plain: Callable[..., Path], tmp_path: Path
) -> None:
    whole = content(plain(tmp_path / "whole", 8))
    with Disk().working() as counted:
        plain(tmp_path / "counted", 8)
    for number in range(1, len(counted.asked), len(counted.asked) // SAMPLES):
        folder = tmp_path / str(number)
        with Disk(number).working(), pytest.raises(OutputError):
            plain(folder, 8)
        assert content(plain(folder, 8)) == whole
        shutil.rmtree(folder)


def test_at_each_moment_of_a_kill_the_same_command_goes_on_to_the_same_bytes(
    plain: Callable[..., Path], tmp_path: Path
) -> None:
    first = content(plain(tmp_path / "before", 4))
    whole = content(plain(tmp_path / "whole", 10))
    folder = Path(shutil.copytree(tmp_path / "before", tmp_path / "counted"))
    with Disk().working() as counted:
        plain(folder, 10)
    for number in range(2, len(counted.asked), len(counted.asked) // SAMPLES):
        folder = Path(shutil.copytree(tmp_path / "before", tmp_path / str(number)))
        assert killed(number, partial(plain, folder, 10))
        for name, text in content(folder).items():
            assert name in whole or name.endswith(".part") or first.get(name) == text
        assert content(plain(folder, 10)) == whole
        shutil.rmtree(folder)


def test_a_resumed_run_does_not_validate_draws_of_the_journal_again(
    small: Dataset, spaces: TaskSpace, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[int] = []
    really = LocalExecutor.run

    def counted(self: LocalExecutor, jobs: Iterator[ValidationJob], setup: ValidationSetup) -> Iterator[JobResult]:
        def noted() -> Iterator[ValidationJob]:
            for job in jobs:
                asked.append(job.number)
                if len(asked) == 9:
                    raise KeyboardInterrupt
                yield job

        return really(self, noted(), setup)

    monkeypatch.setattr(LocalExecutor, "run", counted)

    def make() -> None:
        generate(spaces, tmp_path / "broken", **SMALL)

    with pytest.raises(KeyboardInterrupt):
        make()
    assert (tmp_path / "broken" / JOURNAL).is_file()
    with pytest.raises(QueryError, match="has not ended; resume it with"):
        Dataset.open(tmp_path / "broken")
    make()
    assert content(tmp_path / "broken") == content(small.folder)
    assert all(entry.starts == 2 for entry in small.entries())
    assert len(asked) == sum(part.draws for part in small.manifest.parts) + 1  # the draw that was broken off


def test_all_tasks_of_a_space_are_a_dataset_and_one_more_is_reported_missing(
    kitchen: TaskSpace, tmp_path: Path
) -> None:
    def make(tasks: int) -> Dataset:
        return generate(kitchen, tmp_path / "all", tasks=tasks, weights={}, physics=False, trivial=True)

    assert make(14).count() == 14 and {*make(14).tasks()} == {*make(14).tasks()}
    with pytest.raises(NotFound, match="only 14 of 15 tasks for train found in 14 draws, the whole space"):
        make(15)
    assert Dataset.open(tmp_path / "all").count() == 14


def test_tasks_that_end_in_their_initial_state_are_left_out_unless_requested(
    kitchen: TaskSpace, tmp_path: Path
) -> None:
    with pytest.raises(
        NotFound, match=r"only 12 of 13 tasks .* 2 of them trivial: the final state is the initial state"
    ):
        generate(kitchen, tmp_path / "some", tasks=13, weights={}, physics=False)
    some = Dataset.open(tmp_path / "some")
    others = {str(entry.task) for entry in some.rejected()}
    assert others == {str(task) for task in kitchen} - {str(task) for task in kitchen.where("nontrivial")}
    assert list(verify(some.folder)) == [] and sum(each.trivial for each in some.manifest.parts[0].lengths) == 2
    writer = instruction_writer_of(kitchen.domain)
    for task in some.tasks():
        goal = writer.goal(task)
        assert goal and not goal.items() <= task.initial.items()


def test_tasks_that_few_draws_find_are_kept_and_more_draws_find_more(spaces: TaskSpace, tmp_path: Path) -> None:
    def make(draws: int) -> Dataset:
        return generate(spaces.at(1), tmp_path / "few", tasks=3, seed=1, max_draws=draws)

    with pytest.raises(NotFound, match=r"only 1 of 3 tasks for train found in 1 draw; raise --max-draws"):
        make(1)
    assert Dataset.open(tmp_path / "few").count() == 1
    assert make(9).count() == 3


def test_a_wrong_request_is_refused_in_one_line(kitchen: TaskSpace, numbers: Path, tmp_path: Path) -> None:
    def refused(match: str, folder: Path = tmp_path / "none", **more: object) -> None:
        with pytest.raises((QueryError, OutputError), match=match) as error:
            generate(kitchen, folder, **{"tasks": 3, "physics": False, "weights": {}, **more})  # type: ignore[arg-type]
        assert len(error.value.lines) == 1

    refused("needs at least 1", tasks=0)
    refused("give one from 0 to 9223372036854775807", seed=2**63)
    refused("uniform", evenly=True, weights={"open": 2})
    refused("add up to 1", split={"train": 0.5})
    refused("need physics", starts=2)
    refused("need physics", demonstrate=True)
    refused("cameras record demonstrations; request them", staging=Staging(("front",)))
    refused("has no sentences in", language="xx")
    refused("shard 0: give a number from 1 to 20000", shard=0)
    refused("shard 1000000: give a number from 1 to 20000", shard=10**6)
    refused("need physics", budget=Budget())
    refused("whole skeletons need shares", skeletons=True)
    refused("leave one of them out", skeletons=True, hold_out="open", split=SHARES)
    refused("the parts are train and test", hold_out="open", split={"a": "0.5", "b": "0.5"})
    refused("write a name of letters", split={"../a": "0.5", "b": "0.5"})
    refused("nosuch", hold_out="nosuch")
    assert not (tmp_path / "none").exists()
    refused("is a dataset made with a different value of seed .1.; give", numbers, tasks=6, seed=2, weights=None)
    refused("has 6 tasks already; request at least as many", numbers, seed=1, shard=4, weights=None)
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "letter.txt").write_text("dear")
    refused("holds letter.txt, and is not a dataset; give a new folder", tmp_path / "mine")
    refused("cannot be created", Path("/dev/null/folder"))
    refused("is not a folder; name a new folder", numbers / "dataset.json")
    with pytest.raises(OutputError, match="is a dataset of kitchen, not of blocks"):
        generate(TaskSpace(load_domain("blocks"), 2), numbers, tasks=1)


def test_a_folder_that_another_run_writes_is_refused(
    kitchen: TaskSpace, numbers: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from prag_asp.output import Journal

    monkeypatch.setattr("prag_asp.output.atomic_file.PATIENCE", 0.0)
    other = Journal(numbers / JOURNAL, "other")
    try:
        with pytest.raises(OutputError, match="another run is writing it"):
            generate(kitchen, numbers, tasks=6, seed=1, physics=False, shard=4)
    finally:
        other.close()

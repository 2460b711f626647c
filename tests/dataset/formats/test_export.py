"""What all forms have in common: what is refused, what is chosen, and that nothing half stands there as whole."""

from __future__ import annotations

import re
import resource
import shutil
import sys
from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest

from prag_asp import Dataset, OutputError, QueryError, TaskSpace, load_domain
from prag_asp.dataset import export, generate
from prag_asp.dataset.formats.episode_source import EpisodeSource
from prag_asp.dataset.formats.export_format import FORMS as ALL_FORMS
from prag_asp.physics import Staging
from tests.commands import ok, run
from tests.dataset.formats.conftest import of
from tests.dataset.formats.published import Published
from tests.output.faults import Disk, forked, killed

FORMS = [form for form in ALL_FORMS if form != "rerun"]
"""The formats whose files have the same bytes each time; test_rerun.py has the other one."""

OUT = {form: "out.hdf5" if form == "robomimic" else "out" for form in FORMS}
RECORDED = [form for form in FORMS if form != "bddl"]


def content(path: Path) -> dict[str, bytes]:
    """Return what stands at a path, a file or a folder."""
    return of(path) if path.is_dir() else {path.name: path.read_bytes()}


@pytest.fixture(scope="module")
def whole(arms: Dataset, tmp_path_factory: pytest.TempPathFactory) -> dict[str, dict[str, bytes]]:
    """Return what each form has of a dataset."""
    folder = tmp_path_factory.mktemp("whole")
    return {form: content(export(arms, form, folder / f"{form} {OUT[form]}")) for form in FORMS}


@pytest.mark.parametrize("form", FORMS)
def test_a_kill_at_any_moment_leaves_nothing_that_looks_whole_and_the_next_run_is_well(
    form: str, arms: Dataset, whole: dict[str, dict[str, bytes]], tmp_path: Path
) -> None:
    with Disk().working() as counted:
        export(arms, form, tmp_path / "counted" if form != "robomimic" else tmp_path / "counted.hdf5")
    moments = len(counted.asked)
    assert moments >= 3
    for number in {1, 2, moments // 2, moments - 1, moments}:
        out = tmp_path / str(number) / f"{form} {OUT[form]}"
        out.parent.mkdir()
        assert killed(number, partial(export, arms, form, out))
        if out.exists():
            assert content(out) == whole[form]
            shutil.rmtree(out) if out.is_dir() else out.unlink()
        assert content(export(arms, form, out)) == whole[form]
        assert [path.name for path in out.parent.iterdir()] == [out.name]


@pytest.mark.parametrize("form", FORMS)
def test_an_interruption_and_a_full_disk_leave_nothing(form: str, arms: Dataset, tmp_path: Path) -> None:
    def stop(*_: object) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        export(arms, form, tmp_path / OUT[form], progress=stop)
    assert not list(tmp_path.iterdir())
    with Disk(2, 10**6).working(), pytest.raises(OutputError, match=r"cannot be (written|made): No space"):
        export(arms, form, tmp_path / OUT[form])
    assert not (tmp_path / OUT[form]).exists()


@pytest.mark.parametrize("form", RECORDED)
def test_a_file_that_may_not_grow_is_told_in_one_line(form: str, arms: Dataset, tmp_path: Path) -> None:
    """The system itself refuses: HDF5 would end the process."""

    def limited() -> tuple[int, str]:
        sys.dont_write_bytecode = True  # Python would cut it, and believe it later
        resource.setrlimit(resource.RLIMIT_FSIZE, (2000, 2000))
        done = run("export", form, str(arms.folder), "-o", str(tmp_path / OUT[form]))
        return done.returncode, done.stderr

    code, err = forked(limited)
    assert (code, err.count("\n")) == (4, 1), err
    assert "cannot be written: " in err and "File too large; free some space" in err
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("form", FORMS)
def test_a_dataset_without_recordings_or_without_such_a_task_is_refused(
    form: str, told: Dataset, arms: Dataset, tmp_path: Path
) -> None:
    if form in RECORDED:
        with pytest.raises(
            QueryError, match=r"has no recordings; generate a dataset with recordings: .* --demonstrate$"
        ):
            export(told, form, tmp_path / OUT[form])
    none = arms.where(*(f"lacks {name}" for name in {action.name for action in arms.task(0).actions}))
    with pytest.raises(QueryError, match="has no such task"):
        export(none, form, tmp_path / OUT[form])
    assert not list(tmp_path.iterdir())


def test_a_place_that_is_taken_is_refused_and_untouched(arms: Dataset, tmp_path: Path) -> None:
    (tmp_path / "out").mkdir()
    (tmp_path / "out/mine").write_text("mine")
    with pytest.raises(OutputError, match="already exists"):
        export(arms, "lerobot", tmp_path / "out")
    (tmp_path / "new.part").mkdir()
    (tmp_path / "new.part/mine").write_text("mine")
    with pytest.raises(OutputError, match="holds mine, but has to be empty"):
        export(arms, "lerobot", tmp_path / "new")
    assert (tmp_path / "out/mine").read_text() == (tmp_path / "new.part/mine").read_text() == "mine"
    for place in (arms.folder / "out", arms.folder, arms.folder / "dataset.json"):
        with pytest.raises(OutputError, match="lies in the dataset"):
            export(arms, "robomimic", place)
    for place in (Path(), Path("..")):
        with pytest.raises(OutputError, match="name a new folder"):
            export(arms, "bddl", place)


@pytest.mark.parametrize(("form", "package"), [("lerobot", "av"), ("minari", "h5py"), ("robomimic", "h5py")])
def test_a_package_that_is_missing_is_told_in_one_line(
    form: str, package: str, arms: Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in [each for each in sys.modules if each.startswith("prag_asp.dataset.formats.")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, package, None)
    done = run("export", form, str(arms.folder), "-o", str(tmp_path / "out"))
    told = f'the format {form} needs {package}; install it: pip install "prag_asp[formats]"\n'
    assert (done.returncode, done.stderr) == (2, told)


def test_an_unknown_form_level_or_part_is_told(arms: Dataset, tmp_path: Path) -> None:
    with pytest.raises(QueryError, match="no form 'lerobt'; did you mean lerobot"):
        export(arms, "lerobt", tmp_path / "out")
    with pytest.raises(QueryError, match="there are no instructions loud"):
        export(arms, "bddl", tmp_path / "out", level="loud")
    done = run("export", "bddl", str(arms.folder), "--where", "", "-o", str(tmp_path / "out"))
    assert done.returncode == 2 and done.stderr.startswith("condition ''")
    done = run("export", "bddl", str(arms.folder), "--part", "tset", "-o", str(tmp_path / "out"))
    assert (done.returncode, done.stderr) == (2, "no part 'tset'; there are train\n")


def test_wrong_cameras_are_reported(filmed: Dataset, tmp_path: Path) -> None:
    copy = Path(shutil.copytree(filmed.folder, tmp_path / "copy"))
    text = (copy / "dataset.json").read_text()
    for old, new, message in (
        ('"front",', "", "the recording of task 0 of train: is not from the cameras"),
        ('"wrist"', '"wirst"', "the scene has no camera wirst"),
        ('"rate": 5', '"rate": 0', "an episode has 20 frames per second"),
        ("\n    48,", "\n    4,", "16 to 2048 pixels"),
        ("\n    48,", "", "spec.staging.size: needs a list of 2"),
    ):
        assert old in text
        (copy / "dataset.json").write_text(text.replace(old, new, 1))
        with pytest.raises(QueryError, match=message):
            export(copy, "lerobot", tmp_path / "out")


def test_a_part_of_a_stranger_does_not_lead_out_of_the_folder(told: Dataset, tmp_path: Path) -> None:
    copy = Path(shutil.copytree(told.folder, tmp_path / "copy"))
    text = (copy / "dataset.json").read_text()
    (copy / "dataset.json").write_text(text.replace('"train"', '"../../train"'))
    with pytest.raises(OutputError, match="leads out of the folder"):
        export(copy, "bddl", tmp_path / "deep/out")
    assert not list(tmp_path.glob("*.bddl")) and not list((tmp_path / "deep").iterdir())


def test_words_that_are_too_long_for_hdf5_are_told_in_one_line(
    arms: Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(EpisodeSource, "instruction", lambda *_: "word " * 20_000)
    for form in ("minari", "robomimic"):
        with pytest.raises(QueryError, match="is too long for HDF5"):
            export(arms, form, tmp_path / OUT[form])
    assert not list(tmp_path.iterdir())


def test_a_recording_that_does_not_show_its_task_is_told(arms: Dataset, tmp_path: Path) -> None:
    (entry, start, shown), *_ = arms.demonstrations()
    copy = Path(shutil.copytree(arms.folder, tmp_path / "copy"))
    replace(shown, ends=shown.ends[:-1]).save(copy / f"demonstrations/{entry.part}/{start + 1:06d}.npz")
    with pytest.raises(QueryError, match="the recording of task 0 of train: does not show the states of its task"):
        export(copy, "minari", tmp_path / "out")


def test_a_task_without_an_action_has_no_words(tmp_path: Path) -> None:
    still = TaskSpace(load_domain("tabletop"), 0)
    filmed = Staging(("front",), (16, 16), 5)
    data = generate(still, tmp_path / "still", tasks=1, trivial=True, demonstrate=True, staging=filmed)
    read = Published(export(data, "lerobot", tmp_path / "out"))
    assert [*read.tasks.index] == [*read.subtasks.index] == [""] and {*read.frames(0)["subgoal_index"]} == {0}
    text = (export(data, "bddl", tmp_path / "bddl") / "train-000000.bddl").read_text()
    assert "(:language )" in text
    with pytest.raises(QueryError, match="the video of task 0 of train has one image; record at a higher --rate"):
        slow = Staging(("front",), (16, 16), 1)
        few = generate(still, tmp_path / "slow", tasks=1, trivial=True, demonstrate=True, staging=slow)
        export(few, "robomimic", tmp_path / "out.hdf5")


def test_the_command_writes_parts_tasks_and_levels(filmed: Dataset, tmp_path: Path) -> None:
    options = ("--part", "test", "--level", "exact")
    assert ok("export", "lerobot", str(filmed.folder), *options, "-o", "out", cwd=tmp_path) == "out\n"
    read = Published(tmp_path / "out")
    (entry,) = filmed.part("test").entries()
    assert [*read.tasks.index] == [entry.instruction["exact"]] and read.info["splits"] == {"test": "0:1"}
    first = str(next(filmed.tasks()).actions[0])
    done = ok("export", "bddl", str(filmed.folder), "--where", f"begins {first}", "-o", "some", cwd=tmp_path)
    assert done == "some\n" and (tmp_path / "some/train-000000.bddl").is_file()


def test_the_formula_of_a_task_space_needs_no_name_of_its_form() -> None:
    lines = ok("export", "dimacs", "blocks", "-n", "1")
    assert lines == ok("export", "blocks", "-n", "1") == ok("export", "-n", "1", "blocks")
    assert re.match(r"c the tasks of blocks of length 1", lines)
    done = run("export", "blocks")
    assert done.returncode == 64 and "Missing option '-n'" in done.stderr
    done = run("export", "lerobt", "data", "-o", "out")
    assert (done.returncode, done.stderr.partition(";")[0]) == (64, "prag-asp export: no format 'lerobt'")
    assert "tabletp: no such domain" in run("export", "tabletp", "-n", "1").stderr
    assert {*FORMS, "dimacs"} <= {*ok("export", "--help").split()}

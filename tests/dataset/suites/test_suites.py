"""Suites: exact figures beside brute force, leaks refused, the same bytes however they are made."""

from __future__ import annotations

import re
import shutil
from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from pathlib import Path

import pytest

from prag_asp import Dataset, DomainError, OutputError, QueryError, TaskSpace
from prag_asp.dataset import Suite, count_suite, generate_suite, load_suite, verify
from prag_asp.dataset.suites import suite_builder, verifying
from prag_asp.dataset.suites.counting import Figures, Overlap, refuse_leaks
from tests.dataset.conftest import with_json
from tests.output.faults import content

LOGIC = """
class(thing). class(cup, thing). class(jar, thing). class(shelf).
entity((cup_1; cup_2), cup). entity(jar_1, jar). entity((low; high), shelf).
fluent(at(T,S)) :- is_a(T,thing), is_a(S,shelf).
fluent(held(T)) :- is_a(T,thing).
exclusive(at(T,low), at(T,high)) :- is_a(T,thing).
exclusive(held(T), at(T,S))      :- fluent(at(T,S)).
exclusive(held(T), held(U))      :- fluent(held(T)), fluent(held(U)), T < U.
initially(held(T), false)        :- fluent(held(T)).
action(take(T,S)) :- fluent(at(T,S)).
action(put(T,S))  :- fluent(at(T,S)).
action(wash(T))   :- is_a(T,thing).
precondition(take(T,S), at(T,S), true)       :- action(take(T,S)).
precondition(take(T,S), held(U), false)      :- action(take(T,S)), fluent(held(U)).
postcondition(take(T,S), at(T,S), false)     :- action(take(T,S)).
postcondition(take(T,S), held(T), true)      :- action(take(T,S)).
precondition((put(T,S);wash(T)), held(T), true) :- action(put(T,S)).
postcondition(put(T,S), at(T,S), true)       :- action(put(T,S)).
postcondition(put(T,S), held(T), false)      :- action(put(T,S)).
"""
WORDS = """
[language.en.actions]
take = ["take {0} from {1}", "fetch {0} from {1}"]
put = ["put {0} onto {1}", "place {0} on {1}"]
wash = ["wash {0}", "clean {0}"]
"""
SMALL = """
domain = "shelves"
lengths = "1..3"
phrasings = "1 of 2"

[parts.train]
tasks = 12

[parts.objects]
unseen = "jar_1"
tasks = 4

[parts.pairs]
lengths = "2..3"
unseen = "take>wash"
tasks = 4

[parts.start]
unseen = "starts at(cup_1,high)"
where = "uses cup_1"
tasks = 4

[parts.words]
of = "train"
phrasings = "2 of 2"
tasks = 4
"""


def suite_of(folder: Path, text: str) -> Suite:
    (folder / "shelves").mkdir(exist_ok=True)
    (folder / "shelves" / "domain.lp").write_text(LOGIC)
    (folder / "shelves" / "domain.toml").write_text(WORDS)
    (folder / "suite.toml").write_text(text)
    return load_suite(folder / "suite.toml")


@pytest.fixture(scope="module")
def small(tmp_path_factory: pytest.TempPathFactory) -> Suite:
    return suite_of(tmp_path_factory.mktemp("small"), SMALL)


@pytest.fixture(scope="module")
def figures(small: Suite) -> Figures:
    return count_suite(small)


@pytest.fixture(scope="module")
def made(small: Suite, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("made") / "bench"
    generate_suite(small, folder)
    return folder


def has(plan: Sequence[str]) -> tuple[bool, bool, bool]:
    """Tell whether a plan has the jar, has something washed right after it was taken, and names cup 1."""
    names = [action.partition("(")[0] for action in plan]
    pair = ("take", "wash") in pairwise(names)
    return any("jar_1" in action for action in plan), pair, any("cup_1" in action for action in plan)


def begins_high(plan: Sequence[str], thing: str) -> bool | None:
    """Tell whether a thing has to begin on the high shelf, None where the plan leaves that open."""
    first = next((action for action in plan if action.startswith(f"take({thing},")), None)
    return None if first is None else first == f"take({thing},high)"


def test_sizes_and_shared_tasks_are_those_of_lists_of_all_plans(small: Suite, figures: Figures) -> None:
    """All plans come from clingo without a condition, and Python judges each of them here."""
    space = {length: TaskSpace(small.domain, length, engine="clingo") for length in (1, 2, 3)}
    plans = {length: [*each.enumerate("plan")] for length, each in space.items()}
    wanted: dict[str, Callable[[Sequence[str]], bool]] = {
        "train": lambda plan: has(plan)[:2] == (False, False) and begins_high(plan, "cup_1") is not True,
        "objects": lambda plan: has(plan)[:2] == (True, False) and begins_high(plan, "cup_1") is not True,
        "pairs": lambda plan: has(plan)[:2] == (False, True) and begins_high(plan, "cup_1") is not True,
        "start": lambda plan: has(plan) == (False, False, True) and begins_high(plan, "cup_1") is not False,
    }
    for name, fits in wanted.items():
        part = small.parts[name]
        assert figures.sizes[name] == {length: sum(map(fits, plans[length])) for length in part.lengths}
    assert figures.sizes["words"] == figures.sizes["train"]
    shared = {(each.one, each.other): each for each in figures.shared}
    assert shared.pop(("train", "words")) == Overlap("train", "words", str(figures.size("train")), True)
    assert len(shared) == 9 and {each.tasks for each in shared.values()} == {0}
    assert figures.leaks == () and {each.tasks for each in figures.unseen} == {0} and len(figures.unseen) == 12


def test_only_its_own_part_has_what_is_held_out_and_paraphrases_share_no_text_with_training(made: Path) -> None:
    entries = {name: [*Dataset.open(made / name).entries()] for name in ("train", "objects", "pairs", "start", "words")}
    for name, found in entries.items():
        for entry in found:
            first = {str(fluent): value for fluent, value in entry.task.initial.items()}
            jar, pair, _ = has([str(action) for action in entry.task.actions])
            assert (jar, pair) == (name == "objects", name == "pairs")
            assert first["at(cup_1,high)"] == (name == "start")
    assert [each.task for each in entries["words"]] == [each.task for each in entries["train"]][:4]
    assert [len(found) for found in entries.values()] == [12, 4, 4, 4, 4]
    train, other = (
        {text for entry in entries[name] for text in (*entry.instruction.values(), *entry.subgoals)}
        for name in ("train", "words")
    )
    assert train.isdisjoint(other) and any("fetch" in text for text in other)
    assert not any("fetch" in text or "Please" in text for text in train)


def test_a_suite_is_verified_and_the_bytes_are_those_of_a_run_that_was_broken_off(
    small: Suite, made: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert [*verify(made)] == []
    generate_suite(small.at_most(3), tmp_path / "bench")
    real = suite_builder.generate

    def broken(space: object, folder: Path, *request: object, **options: object) -> object:
        if folder.name == "pairs":
            raise KeyboardInterrupt
        return real(space, folder, *request, **options)  # type: ignore[arg-type]

    monkeypatch.setattr(suite_builder, "generate", broken)
    with pytest.raises(KeyboardInterrupt):
        generate_suite(small, tmp_path / "bench")
    with pytest.raises(QueryError, match="the run that writes it has not ended"):
        next(verify(tmp_path / "bench"))
    monkeypatch.undo()
    generate_suite(small, tmp_path / "bench")
    assert content(tmp_path / "bench") == content(made)
    with pytest.raises(QueryError, match="has 12 tasks already"):
        generate_suite(small.at_most(3), tmp_path / "bench")
    assert content(tmp_path / "bench") == content(made)


def edited(name: str, change: Callable[[str], str]) -> Callable[[Path], object]:
    return lambda folder: (folder / name).write_text(change((folder / name).read_text()))


FORGERIES: Mapping[str, tuple[Callable[[Path], object], str]] = {
    "a file more": (lambda folder: (folder / "more.txt").write_text("x"), "more.txt: is not a file of the suite"),
    "the card": (edited("README.md", lambda text: text.replace("Separation", "Alike")), "README.md: does not match"),
    "a size": (
        with_json("suite.json", lambda value: value["parts"][1].update(size="7")),
        "parts, objects: size differs from a new count",
    ),
    "what is shared": (
        with_json("suite.json", lambda value: value["shared"][0].update(tasks="3")),
        "shared differs from a new count",
    ),
    "the suite": (edited("suite.toml", lambda text: text.replace('"jar_1"', '"jar"')), "suite.toml: has "),
    "a dataset": (lambda folder: (folder / "pairs" / "README.md").write_text("x"), "pairs/README.md: does not match"),
    "a task of another part": (
        lambda folder: (shutil.rmtree(folder / "objects"), shutil.copytree(folder / "train", folder / "objects")),
        "objects: row 0: has the same task as train, row 0",
    ),
    "words of training": (
        lambda folder: (shutil.rmtree(folder / "words"), shutil.copytree(folder / "train", folder / "words")),
        "words: row 0: has the same text as train",
    ),
    "a part that is gone": (lambda folder: shutil.rmtree(folder / "start"), "start: "),
}


@pytest.mark.parametrize("name", FORGERIES)
def test_what_was_changed_is_found(
    made: Path, figures: Figures, tmp_path: Path, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    change, finding = FORGERIES[name]
    folder = Path(shutil.copytree(made, tmp_path / "bench"))
    change(folder)
    if name != "a dataset":
        monkeypatch.setattr(verifying, "wrong_dataset", lambda *_: iter(()))
    if name not in ("a size", "what is shared", "the suite"):
        monkeypatch.setattr(verifying, "count_suite", lambda *_, **__: figures)
    assert any(finding in str(each) for each in verify(folder, physics=False))


PART = "[parts.train]\ntasks = 3\n"
HEAD = f'domain = "shelves"\nlengths = 2\n{PART}'
MISTAKES: Mapping[str, tuple[str, str]] = {
    "no such domain": (f'domain = "tabeltop"\n{PART}', r":1: domain: no domain 'tabeltop'; did you mean tabletop"),
    "no TOML": ('domain = "tabletop\n', r":1: not TOML"),
    "no parts": ('domain = "shelves"\n[parts]\n', r":2: parts: a suite needs parts"),
    "no domain": (PART, r": domain: is missing"),
    "unknown key": (f'domain = "shelves"\nsede = 3\n{PART}', r":2: sede: unknown key; did you mean seed"),
    "unknown key of a part": (f'domain = "shelves"\n{PART}lenghts = 3\n', r":4: .*lenghts: unknown key; did you"),
    "a wrong kind": (f'{HEAD}where = 3\n', r":5: parts.train.where: needs"),
    "no lengths": (f'domain = "shelves"\n{PART}', r":2: parts.train.lengths: missing; write"),
    "wrong lengths": (f'domain = "shelves"\n{PART}lengths = "3..1"\n', r":4: parts.train.lengths: lengths '3..1'"),
    "huge lengths": (f'domain = "shelves"\n{PART}lengths = "1..99999999999"\n', r":4: .*none above 1000"),
    "wrong condition": (f'{HEAD}where = "has wahs"\n', r":5: .*: no action 'wahs'"),
    "wrong thing": (f'{HEAD}unseen = "unicorn"\n', r":5: .*unicorn"),
    "interchangeable": (f'{HEAD}unseen = "cup_1"\n', r":5: .*interchangeable"),
    "wrong start": (f'{HEAD}unseen = "starts juggling"\n', r":5: .*juggling"),
    "several starts": (f'{HEAD}unseen = "starts at(cup_1,high), at(cup_2,high)"\n', r":5: .*several fluents"),
    "wrong name": ('domain = "shelves"\nlengths = 2\n[parts."a/b"]\ntasks = 1\n', r":3: parts.a/b: is not a valid"),
    "no tasks": (
        'domain = "shelves"\nlengths = 2\n[parts.train]\ntasks = 0\n',
        r":4: parts.train.tasks: needs a whole number from 1; got 0",
    ),
    "half a task": ('domain = "shelves"\nlengths = 2\n[parts.train]\ntasks = 1.5\n', r":4: .* whole .*; got 1.5"),
    "too many starts": (f'{HEAD}starts = 1001\n', r":5: .*up to 1000; got 1001"),
    "a large seed": (f'domain = "shelves"\nseed = 9223372036854775808\n{PART}', r":2: seed: needs .*up to 9223372036"),
    "a domain without a name": (f'domain = ""\n{PART}', r":1: domain: no domain ''"),
    "a copy of none": (f'{HEAD}[parts.b]\nof = "c"\ntasks = 1\n', r":6: .*\bc\b"),
    "a copy of itself": ('domain = "shelves"\nlengths = 2\n[parts.b]\nof = "b"\ntasks = 1\n', r":4: "),
    "a copy in the same words": (f'{HEAD}[parts.b]\nof = "train"\ntasks = 1\n', r":6: .*shares phrasings with it"),
    "a copy with more": (f'{HEAD}[parts.b]\nof = "train"\ntasks = 9\nphrasings = "2 of 2"\n', r":6: .*request at most"),
    "a copy of other lengths": (f'{HEAD}[parts.b]\nof = "train"\ntasks = 1\nlengths = 3\n', r":6: .*leave lengths out"),
    "unknown shares": (f'{HEAD}shares = "b"\n', r":5: .*b"),
    "wrong shares of a split": (f'{HEAD}split = {{ a = 0.5 }}\n', r":5: .*add up"),
    "too many phrasings": (f'{HEAD}phrasings = "3 of 3"\n', r":5: .*has only 2"),
    "no language": (f'{HEAD}language = "fr"\n', r":5: .*fr"),
    "no scene": (f'domain = "hanoi"\nphysics = true\nlengths = 2\n{PART}', r":2: .*has no scene"),
    "wrong budget": (f'domain = "kitchen"\nlengths = 2\n{PART}[physics]\nbudget = "0x2"\n', r":6: .*budget '0x2'"),
    "a large budget": (f'domain = "kitchen"\nlengths = 2\n{PART}[physics]\nbudget = "1x{"9" * 20}"\n', r":6: .*from 1"),
    "wrong tier": (f'domain = "kitchen"\nlengths = 2\n{PART}[physics]\ntier = "transti"\n', r":6: .*transti"),
    "cameras alone": (f'domain = "kitchen"\nlengths = 2\n{PART}[physics]\ncameras = ["front"]\n', r":6: .*demonstrate"),
}  # fmt: skip


@pytest.mark.parametrize("name", MISTAKES)
def test_a_mistake_in_the_file_is_told_with_its_line(tmp_path: Path, name: str) -> None:
    text, told = MISTAKES[name]
    with pytest.raises((QueryError, DomainError)) as error:
        suite_of(tmp_path, text)
    assert re.search(told, str(error.value)) and str(error.value).startswith(f"{tmp_path / 'suite.toml'}:")
    assert len(error.value.lines) == 1


def test_all_mistakes_of_a_file_are_told_at_once(tmp_path: Path) -> None:
    text = 'domain = "shelves"\nlengths = "3..1"\nsede = 3\n[parts.train]\ntasks = 0\n[parts.test]\nwhere = 3\n'
    with pytest.raises(QueryError) as error:
        suite_of(tmp_path, text)
    places = [line.removeprefix(f"{tmp_path}/suite.toml:").partition(": ")[0] for line in error.value.lines]
    assert sorted(places) == ["3", "5", "7"], error.value
    text = f'domain = "shelves"\n{PART}where = "has wahs"\n[parts.test]\ntasks = 2\nlengths = "1..2"\nshares = "b"\n'
    with pytest.raises(QueryError) as error:
        suite_of(tmp_path, text)
    keys = [line.split(": ")[1] for line in error.value.lines]
    assert keys == ["parts.train.lengths", "parts.test.shares"]


def test_a_leak_is_refused_unless_it_is_declared(tmp_path: Path) -> None:
    leaky = 'domain = "shelves"\nlengths = 2\n[parts.train]\ntasks = 3\n[parts.test]\ntasks = 2\n'
    found = suite_of(tmp_path, leaky)
    size = TaskSpace(found.domain, 2).count()
    with pytest.raises(QueryError, match=f"suite.toml:5: train and test have {size} tasks in common"):
        generate_suite(found, tmp_path / "bench")
    assert not (tmp_path / "bench").exists()
    declared = suite_of(tmp_path, f'{leaky}shares = "train"\n')
    refuse_leaks(declared, count_suite(declared))
    (tmp_path / "bench").mkdir()
    (tmp_path / "bench" / "mine").write_text("mine")
    with pytest.raises(OutputError, match="holds mine, and is not a suite"):
        generate_suite(declared, tmp_path / "bench")


def test_a_part_cannot_have_more_tasks_than_its_space(tmp_path: Path) -> None:
    found = suite_of(tmp_path, 'domain = "shelves"\nlengths = 1\n[parts.train]\ntasks = 900\n')
    with pytest.raises(QueryError, match=r"suite.toml:4: 900 tasks requested for train, but its space has \d+"):
        count_suite(found)


def test_skeletons_of_one_part_of_a_condition_are_no_leak(tmp_path: Path) -> None:
    text = 'domain = "prag"\nlengths = 4\n'
    text += '[parts.train]\ntasks = 3\nwhere = "part 0-3 of 5 by seed 1"\n'
    text += '[parts.test]\ntasks = 2\nwhere = "part 4-4 of 5 by seed 1"\n'
    suite = suite_of(tmp_path, text)
    figures, whole = count_suite(suite), TaskSpace(suite.domain, 4).count()
    assert figures.leaks == () and figures.size("train") + figures.size("test") == whole

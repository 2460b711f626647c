"""`prag-asp similarity` explains the distance between two tasks, and compares all tasks of a file."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from prag_asp import TaskSpace, load_domain
from prag_asp.dataset import Record, write_line
from tests.commands import ok, run

DOMAIN = """
class(gripper). class(fruit). class(apple,fruit). class(lemon,fruit). class(table).
entity(panda,gripper). entity((apple_1;apple_2),apple). entity(lemon_1,lemon). entity(table_1,table).
fluent(held(O)) :- is_a(O,fruit). fluent(clean(table_1)).
action(pick(panda,O)) :- is_a(O,fruit). precondition(pick(panda,O),held(O),false) :- is_a(O,fruit).
postcondition(pick(panda,O),held(O),true) :- is_a(O,fruit).
action(wipe). postcondition(wipe,clean(table_1),true).
"""


@pytest.fixture(scope="module")
def kitchen(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, TaskSpace]:
    file = tmp_path_factory.mktemp("similarity") / "kitchen.lp"
    file.write_text(DOMAIN)
    return file, TaskSpace(load_domain(file), 2)


def test_two_tasks_are_compared_in_words(kitchen: tuple[Path, TaskSpace]) -> None:
    file, space = kitchen
    one, other = (space.index(plan) for plan in (["pick(panda,apple_1)", "wipe"], ["pick(panda,lemon_1)", "wipe"]))
    words = ["similarity", "--domain", str(file), "--length", "2", str(one), str(other)]
    assert ok(*words, "--metric", "levenshtein-classes").splitlines() == [
        "levenshtein-classes: distance 0.4, similarity 0.818",
        "1  replace pick(panda,apple_1) by pick(panda,lemon_1): 0.4 (fruit)",
    ]
    values = json.loads(ok(*words, "--metric", "goal", "--format", "json"))
    assert (values["distance"], values["normalised"]) == ("2", "2/3")
    assert [(edit["old"], edit["new"]) for edit in values["edits"]] == [
        ("held(apple_1)", None),
        (None, "held(lemon_1)"),
    ]
    parts = ok(*words).splitlines()[2:7]
    assert [line.split()[0] for line in parts] == ["part", "levenshtein-classes", "goal", "links", "states"]


def test_a_renaming_is_named(kitchen: tuple[Path, TaskSpace]) -> None:
    file, space = kitchen
    task = next(space.tasks_of_plans([["pick(panda,apple_2)", "wipe"]]))
    other = write_line(Record(space[space.index(["pick(panda,apple_1)", "wipe"])]))
    words = ["similarity", write_line(Record(task)), other, "--metric", "hamming"]
    lines = ok(*words, "--domain", str(file)).splitlines()
    assert lines == ["hamming: distance 0, similarity 1.000", "renamed in B: apple_1 to apple_2"]
    names = ok(*words, "--up-to", "names")
    assert names.startswith("hamming: distance 1,")


def test_all_tasks_of_a_file_are_compared_and_written(kitchen: tuple[Path, TaskSpace], tmp_path: Path) -> None:
    file, space = kitchen
    tasks = [*space, next(space.tasks_of_plans([["pick(panda,apple_2)", "wipe"]]))]
    lines = tmp_path / "tasks.jsonl"
    lines.write_text("".join(f"{write_line(Record(task))}\n" for task in tasks))
    files = {name: str(tmp_path / name) for name in ("m.npz", "n.npz", "d.npz", "tree.json", "map.json")}
    found = ok(
        "similarity", str(lines), "--domain", str(file), "--metric", "levenshtein", "-o", files["m.npz"],
        "--nearest", files["n.npz"], "-k", "1", "--duplicates", files["d.npz"], "--dendrogram", files["tree.json"],
        "--map", files["map.json"],
    )  # fmt: skip
    same = space.index(["pick(panda,apple_1)", "wipe"])
    summary = found.splitlines()
    assert summary[0].split() == ["tasks", str(len(tasks))] and summary[1].split() == ["distinct", str(len(tasks) - 1)]
    assert summary[-1] == f"  {same} and {len(tasks) - 1}: 0"
    with np.load(files["d.npz"]) as arrays:
        assert arrays["other"].tolist() == [len(tasks) - 1]
    with np.load(files["n.npz"]) as arrays:
        assert arrays["other"][same] == len(tasks) - 1
    assert len(json.loads(Path(files["tree.json"]).read_text())["merges"]) == len(tasks) - 1
    assert len(json.loads(Path(files["map.json"]).read_text())["points"]) == len(tasks)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["3", "4"], "3: a rank needs --domain and --length"),
        (["a:b", "c:d", "--where", "uses x"], "--where 'uses x' is for ranks and datasets"),
        (["a.jsonl", "--where", "uses x"], "--where 'uses x' is for ranks and datasets"),
        (["nothing", "4"], "nothing: no such file, and neither a rank nor a scenario id"),
        (["a", "b", "c"], "a b c: give two tasks, or one dataset or file"),
        (["a", "b", "-o", "m.npz"], "m.npz: files are written for a dataset or a file of tasks"),
        (["a", "-o", "m.csv"], "m.csv: distances are written to a file that ends in .npz or .parquet"),
        (["a", "--map", "m.gif"], "m.gif: give a file that ends in .png, .svg, .pdf or .json"),
        (["a", "--metric", "levenstein"], "no metric 'levenstein'; did you mean levenshtein?"),
    ],
)
def test_a_wrong_request_is_answered_in_one_line(words: list[str], message: str) -> None:
    found = run("similarity", *words)
    assert found.returncode == 2 and found.stderr.startswith(message) and found.stderr.count("\n") == 1


def test_tasks_far_apart_are_chosen_and_written(kitchen: tuple[Path, TaskSpace], tmp_path: Path) -> None:
    file, space = kitchen
    tasks = tmp_path / "tasks.jsonl"
    tasks.write_text("".join(f"{write_line(Record(task))}\n" for task in space))
    words = ("similarity", str(tasks), "--domain", str(file), "--metric", "levenshtein", "--diverse", "2")
    chosen = tmp_path / "chosen.jsonl"
    lines = ok(*words, "--chosen", str(chosen)).splitlines()[-2:]
    numbers = [int(word) for word in lines[0].removeprefix("chosen tasks  ").split()]
    assert lines[1].startswith("they are at least 2 apart; all others are within ")
    written = [json.loads(line)["actions"] for line in chosen.read_text().splitlines()]
    assert written == [json.loads(tasks.read_text().splitlines()[number])["actions"] for number in numbers]
    assert json.loads(ok(*words, "--format", "json"))["diverse"]["tasks"] == numbers
    assert "choose at least 1 and at most" in run(*words[:-1], "99").stderr
    assert "say how many tasks to choose with --diverse K" in run(*words[:-2], "--chosen", str(chosen)).stderr


def test_the_novelty_of_tasks_against_others_is_printed(kitchen: tuple[Path, TaskSpace], tmp_path: Path) -> None:
    file, space = kitchen
    tasks = list(space)
    for name, some in (("given", tasks[:4]), ("new", tasks[3:5])):
        (tmp_path / name).write_text("".join(f"{write_line(Record(task))}\n" for task in some))
    words = ["similarity", "--domain", str(file), str(tmp_path / "new"), "--against", str(tmp_path / "given")]
    found = json.loads(ok(*words, "--metric", "levenshtein", "--format", "json"))
    assert found[0] == {"distance": 0, "nearest": 3} and found[1]["distance"] > 0
    assert ok(*words, "--metric", "levenshtein").splitlines()[4:6] == [
        "tasks with novelty 0       1",
        "  0 is 0 from given task 3",
    ]
    assert "without other files to write" in run(*words, "--diverse", "2").stderr
    known = next(TaskSpace(load_domain("blocks"), 2).tasks())
    (tmp_path / "given").write_text(f"{write_line(Record(known))}\n")
    assert run(*words).returncode == 2

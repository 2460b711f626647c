"""Values show themselves in notebooks: as HTML that is well formed and small, and without computing anything."""

from __future__ import annotations

from base64 import b64decode
from html.parser import HTMLParser
from io import BytesIO
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from prag_asp import TaskSpace, answer_sets, load_domain
from prag_asp.dataset import generate
from prag_asp.html.markup import VOID
from prag_asp.physics import Budget, Verdict
from prag_asp.physics.demonstration.footage_strip import strip_url
from prag_asp.space.domain_engines import DomainEngines


class Reader(HTMLParser):
    """Reads HTML whose elements must be nested correctly, and keeps the texts of its cells."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.cells: list[str] = []
        self.feed(text)
        assert not self.open

    def handle_starttag(self, tag: str, attrs: Any) -> None:
        if tag not in VOID:
            self.open.append(tag)
        if tag in ("td", "th"):
            self.cells.append("")

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if self.open and self.open[-1] in ("td", "th"):
            self.cells[-1] += data


def shown(value: Any) -> list[str]:
    """Return the cells of the tables of a value in a notebook."""
    text = value._repr_html_()
    assert len(text) < 100_000 and "<script" not in text
    return Reader(text).cells


def test_a_task_shows_its_plan_and_its_states() -> None:
    task = TaskSpace(load_domain("hanoi"), 7)[0]
    cells = shown(task)
    assert all(str(action) in cells for action in task.actions)
    assert cells.count("true") == sum(value for state in (task.initial, *task.states) for value in state.values())
    assert "after 7" in cells and "on(disc(1),middle)" in task._repr_html_()
    assert shown(TaskSpace(load_domain("hanoi"), 0)[0])


def test_a_space_shows_the_counts_that_are_known_and_counts_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    space = TaskSpace(load_domain("prag"), "2..3").where("uses apple")
    with monkeypatch.context() as patched:
        patched.setattr(DomainEngines, "engine", None)
        assert shown(space) == [] and "<code>uses apple</code>" in space._repr_html_()
    assert shown(space)[:2] != ["length", "tasks"]
    counts = {length: space.at(length).count() for length in (2, 3)}
    assert space.count() == sum(counts.values())
    assert shown(space) == ["length", "tasks", *(text for pair in counts.items() for text in map("{:,}".format, pair))]


def test_a_condition_shows_its_clauses() -> None:
    space = TaskSpace(load_domain("prag"), 1)
    assert "every task" in space.condition._repr_html_()
    condition = space.where("uses apple", "has at least 1 grasp").condition
    assert "<li><code>uses apple</code></li><li><code>has at least 1 grasp" in condition._repr_html_()


def test_a_verdict_shows_why_attempts_failed() -> None:
    verdict = Verdict("not_found", Budget(), 1, 2, "no grasp", {"no grasp": 7, "not reached": 9}, nearest="at action 2")
    cells = shown(verdict)
    assert cells[cells.index("not found") - 1] == "status" and cells[-4:] == ["not reached", "9", "no grasp", "7"]


def test_a_dataset_shows_its_parts_and_its_first_tasks(tmp_path: Path) -> None:
    pytest.importorskip("pyarrow")
    data = generate(TaskSpace(load_domain("tabletop"), 2), tmp_path / "data", tasks=8, seed=1, physics=False)
    cells = shown(data)
    assert cells[4:8] == ["train", "8", "360", "8"] and str(data.task(4)) in cells and str(data.task(5)) not in cells
    assert data.entry(0).instruction["default"] in cells


def test_answer_sets_show_their_number_once_they_are_compiled() -> None:
    answers = answer_sets(text="{ a(1..40) }. #show a/1.", engine="diagram")
    assert "answer sets" not in shown(answers)
    assert answers.count() == 2**40
    assert shown(answers)[-2:] == ["answer sets", f"{2**40:,}"]


def test_an_episode_shows_the_first_image_and_the_end_of_each_subgoal() -> None:
    image_of = pytest.importorskip("PIL.Image")
    rgb = np.zeros((6, 20, 400, 3), dtype=np.uint8)
    rgb[:] = np.arange(6, dtype=np.uint8)[:, None, None, None]
    footage = SimpleNamespace(videos={"front": SimpleNamespace(rgb=rgb)}, subgoals=np.array([0, 0, 0, 1, 1, 1]))
    url = strip_url(footage)  # type: ignore[arg-type]
    assert url is not None
    image = image_of.open(BytesIO(b64decode(url.partition(",")[2])))
    assert image.size == (3 * (134 + 4), 7)
    assert [image.getpixel((column * 138, 0))[0] for column in range(3)] == [0, 2, 5]
    assert strip_url(SimpleNamespace(videos={})) is None  # type: ignore[arg-type]

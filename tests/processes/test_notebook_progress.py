"""The progress line of notebooks: with a stand-in display, and in a real kernel if there is one."""

from __future__ import annotations

import sys
import threading
from types import SimpleNamespace

import pytest

import prag_asp
from prag_asp.processes import notebook_progress, progress_events
from prag_asp.processes.notebook_progress import GAP, PATIENCE, CellWatch, NotebookProgress, is_inside, show_progress
from prag_asp.processes.progress_events import Note, report_progress, stage


class StandIn(list):
    """A display that keeps what it shows: the text, and whether it replaces the one before."""

    def __call__(self, value, again) -> None:
        assert value["text/html"].count("<") == (2 if value["text/plain"] else 0)
        self.append((value["text/plain"], again))


def test_a_line_appears_after_two_seconds_says_what_is_done_and_is_removed():
    shown = StandIn()
    line = NotebookProgress(shown)
    line.hear("grounding <prag>", 0.1)
    for now in (0.0, 0.5, PATIENCE - 0.1):
        line.look(True, now)
    assert shown == []
    line.look(True, PATIENCE)
    line.look(True, PATIENCE + 0.1)
    line.hear(Note("a hint"), 2.5)
    line.hear("counting\nmore", 2.9)
    line.look(True, 3.0)
    line.look(False, 3.2)
    line.look(False, 3.1 + GAP)
    assert shown == [("grounding <prag> ... 2 s", False), ("counting ... 3 s", True), ("", True)]


def test_the_steps_of_an_iterator_are_one_call_and_old_events_describe_nothing():
    shown = StandIn()
    line = NotebookProgress(shown)
    line.hear("an earlier call", 0.0)
    for now in (5.0, 5.5, 6.0, 6.5, 7.0):
        line.look(True, now)
        line.look(False, now + 0.2)
    assert shown == [("working ... 2 s", False)]
    line.look(False, 7.3 + GAP)
    for now in (10.0, 11.0):
        line.look(True, now)
    assert shown[1:] == [("", True)], "a new call begins anew"


def test_code_of_the_package_is_found_on_a_stack():
    assert not is_inside(sys._getframe())
    seen = []
    listeners = list(progress_events._listeners)
    progress_events.hear(lambda words: seen.append(is_inside(sys._getframe())))
    try:
        stage("anything")
    finally:
        progress_events._listeners[:] = listeners
    assert seen == [True]


@pytest.fixture
def notebook(monkeypatch):
    """A stand-in for a kernel: callbacks of its cells, and what it displays."""
    shown, callbacks = StandIn(), {}
    shell = SimpleNamespace(kernel=None, events=SimpleNamespace(register=callbacks.__setitem__))
    monkeypatch.setitem(sys.modules, "IPython", SimpleNamespace(get_ipython=lambda: shell))
    monkeypatch.setattr(notebook_progress, "_ipython_display", lambda: shown)
    monkeypatch.setattr(notebook_progress, "_watch", None)
    monkeypatch.setattr(notebook_progress, "PATIENCE", 0.02)
    monkeypatch.setattr(notebook_progress, "LOOK", 0.01)
    monkeypatch.setattr(progress_events, "_listeners", [])
    notebook_progress.watch_notebook()
    yield shown, callbacks
    callbacks["post_run_cell"]()


def test_a_cell_is_watched_from_its_beginning_to_its_end_unless_progress_is_off(notebook):
    shown, callbacks = notebook
    reached = threading.Event()
    progress_events.hear(lambda words: reached.wait(5.0) if "of 9" in words else None)

    def run() -> None:
        callbacks["pre_run_cell"]()
        threading.Timer(0.2, reached.set).start()
        report_progress("sampling", 3, 9)
        callbacks["post_run_cell"](None)

    run()
    assert "sampling, 3 of 9" in shown[0][0] and shown[-1] == ("", True)
    shown.clear()
    show_progress(False)
    run()
    assert shown == []


def test_outside_of_a_notebook_nothing_is_watched(monkeypatch):
    monkeypatch.setattr(notebook_progress, "_watch", None)
    monkeypatch.setitem(sys.modules, "IPython", SimpleNamespace(get_ipython=lambda: None))
    notebook_progress.watch_notebook()
    show_progress(False)
    assert notebook_progress._watch is None and prag_asp.show_progress is show_progress
    assert CellWatch().enabled


def test_a_real_kernel_shows_the_line_below_its_cell(tmp_path, monkeypatch):
    nbclient, nbformat = pytest.importorskip("nbclient"), pytest.importorskip("nbformat")
    pytest.importorskip("ipykernel")
    slow = "from prag_asp.processes import progress_events\nprogress_events.hear(lambda words: time.sleep(0.9))\n"
    cells = [
        "import time, prag_asp\nfrom prag_asp.processes import notebook_progress\nnotebook_progress.PATIENCE = 0.1",
        f"{slow}progress_events.stage('sampling')",
        "prag_asp.show_progress(False)\nprogress_events.stage('sampling')",
    ]
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(cell) for cell in cells])
    spec = tmp_path / "kernels" / "this"
    spec.mkdir(parents=True)
    command = [sys.executable, "-m", "ipykernel_launcher", "-f", "{connection_file}"]
    (spec / "kernel.json").write_text(f'{{"argv": {command}, "display_name": "this"}}'.replace("'", '"'))
    monkeypatch.setenv("JUPYTER_PATH", str(tmp_path))
    updates = []

    class Client(nbclient.NotebookClient):
        def process_message(self, message, cell, index):
            if message["msg_type"] in ("display_data", "update_display_data"):
                updates.append((index, message["content"]["data"]["text/plain"]))
            return super().process_message(message, cell, index)

    Client(notebook, timeout=60, kernel_name="this").execute()
    assert {index for index, _ in updates} == {1}, "only the cell in which progress is on"
    assert updates[0][1].startswith("sampling ... ") and updates[-1] == (1, "")
    assert [len(cell["outputs"]) for cell in notebook.cells] == [0, 1, 0]

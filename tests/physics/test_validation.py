from __future__ import annotations

import math
import os
import signal
import subprocess
import sys
import time
from dataclasses import replace
from itertools import chain, count, islice, repeat
from pathlib import Path

import pytest

from prag_asp.dataset.jsonl import Record, write_line
from prag_asp.errors import PragError, QueryError, SceneError
from prag_asp.physics import Budget, WorkerError, validate_tasks
from prag_asp.processes import worker_pool
from prag_asp.scene.scene import Mount, Shape
from tests.physics.random_tasks import random_tasks
from tests.physics.scenarios import stacking, state, task
from tests.processes import children, gone, interrupt, interruptible

ROOT = Path(__file__).parents[2]


def test_workers_give_the_verdicts_of_one_process_even_if_they_are_killed_and_leave_nothing(
    tabletop, chance, started, capfd
):
    tasks, seed = list(islice(random_tasks("tabletop", 4, chance.seed(3)), 24)), chance.seed(7)
    alone = list(validate_tasks(tasks, tabletop, seed=seed, workers=1))
    assert [verdict.index for verdict in alone] == list(range(24))
    assert sum(verdict.feasible for verdict in alone) > 20
    verdicts = validate_tasks(tasks, tabletop, seed=seed, workers=2)
    found = [next(verdicts)]
    os.kill(started()[0], signal.SIGKILL)
    found += islice(verdicts, 12)
    os.kill(started()[-1], signal.SIGKILL)
    found += verdicts
    assert _lines(tasks, found) == _lines(tasks, alone)
    assert not started()
    assert capfd.readouterr().out == "", "results go to standard output, and nothing of the simulator"


def _lines(tasks, verdicts):
    """Return the bytes that a file of these tasks has, witnesses and all."""
    found = [verdict.to_json() for verdict in verdicts]
    records = [Record(task, data, data.pop("witness")) for task, data in zip(tasks, found, strict=True)]
    return "\n".join(map(write_line, records)).encode()


@pytest.mark.parametrize("name", ["tabletop", "prag"])
def test_the_order_of_the_tasks_does_not_change_a_byte(name, request, chance):
    scene, validator = request.getfixturevalue(name), request.getfixturevalue(f"{name}_validator")
    tasks = list(islice(random_tasks(name, 4, chance.seed(9)), 12))
    in_order = list(validate_tasks(tasks, scene, seed=chance.seed(5)))
    # The session's validator has seen many other tasks before.
    for order in (range(11, -1, -1), chance.generator(1).sample(range(12), 12)):
        found = {index: validator.validate(tasks[index], seed=chance.seed(5), index=index) for index in order}
        assert _lines(tasks, [found[index] for index in range(12)]) == _lines(tasks, in_order)


def test_an_endless_stream_of_tasks_is_read_a_little_ahead_only(tabletop, started):
    read = count()

    def endless():
        while True:
            next(read)
            yield stacking()

    for workers in (1, 2):
        verdicts = validate_tasks(endless(), tabletop, seed=1, workers=workers, budget=Budget(2, 3))
        assert len(list(islice(verdicts, 6))) == 6
        verdicts.close()
    assert next(read) < 60
    assert not started()


@pytest.mark.parametrize(("last", "how"), [("exit 3", "with code 3"), ("kill -9 $$", "by SIGKILL")])
def test_workers_that_always_die_end_in_a_clear_error(tabletop, monkeypatch, tmp_path, last, how, started):
    dying = tmp_path / "python"
    dying.write_text(f"#!/bin/sh\n{last}\n")
    dying.chmod(0o755)
    monkeypatch.setattr(sys, "executable", str(dying))
    monkeypatch.setattr(worker_pool, "REPLACEMENTS", 1)
    with pytest.raises(WorkerError, match=f"workers died 2 times in a row around task 0, the last {how}; is there"):
        list(validate_tasks([stacking()], tabletop, seed=0, workers=2))
    assert issubclass(WorkerError, PragError)
    assert not started()


def test_a_worker_that_cannot_be_started_is_a_clear_error(tabletop, monkeypatch):
    monkeypatch.setattr(sys, "executable", "/no/such/python")
    with pytest.raises(WorkerError, match="a worker ended before it began: No such file or directory; is there"):
        list(validate_tasks([stacking()], tabletop, seed=0, workers=2))


def test_an_error_comes_after_the_verdicts_on_the_tasks_before_however_many_workers(tabletop, started):
    unknown = task(state("on_top(apple_1,table_1)"), ("x(panda)", state("-on_top(apple_1,table_1)")))
    tasks = [_hopeless(), *[stacking()] * 7, unknown, *[stacking()] * 12]
    for workers in (1, 2):
        verdicts = validate_tasks(tasks, tabletop, seed=0, workers=workers, budget=Budget(100, 10))
        assert [verdict.index for verdict in islice(verdicts, 8)] == list(range(8))
        with pytest.raises(SceneError, match="apple_1"):
            next(verdicts)
    assert not started()


def test_no_workers_are_refused(tabletop):
    with pytest.raises(QueryError, match="at least 1 worker"):
        validate_tasks([], tabletop, seed=0, workers=0)


def test_nothing_of_the_simulator_reaches_standard_output():
    code = """
from prag_asp.physics import validate_tasks
from tests.physics.random_tasks import shipped_scene
from tests.physics.scenarios import stacking
assert all(verdict.feasible for verdict in validate_tasks([stacking()] * 2, shipped_scene("tabletop"), seed=0))
"""
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, check=True)
    assert done.stdout == b""


@pytest.mark.parametrize("killed", [False, True])
def test_an_interrupt_ends_all_processes_and_so_does_killing_the_first(killed, tmp_path):
    script = tmp_path / "endless.py"
    script.write_text(
        "import itertools, sys\n"
        f"sys.path.insert(0, {str(ROOT)!r})\n"
        "from prag_asp.physics import validate_tasks\n"
        "from tests.physics.random_tasks import shipped_scene\n"
        "from tests.physics.scenarios import stacking\n"
        "scene = shipped_scene('tabletop')\n"
        "for verdict in validate_tasks(itertools.repeat(stacking()), scene, seed=0, workers=2):\n"
        "    print(verdict.index, flush=True)\n"
    )
    with interruptible([sys.executable, str(script)], tmp_path) as running:
        assert running.stdout is not None
        running.stdout.readline()
        workers = children(running.pid)
        if killed:
            running.kill()
            running.wait()
        else:
            interrupt(running)
        assert running.returncode != 0
        assert len(workers) == 2 and gone(workers)


def test_a_scene_that_cannot_be_built_is_one_clear_error_however_many_workers(tabletop, started):
    broken = replace(tabletop, shapes={**tabletop.shapes, "cube_1": Shape("box", (math.nan, 0.05, 0.05))})
    for workers in (1, 2):
        with pytest.raises(SceneError) as caught:
            list(validate_tasks([stacking()] * 20, broken, seed=0, workers=workers))
        assert "cube_1" in str(caught.value) and "\n" not in str(caught.value)
    assert not started()
    unknown = replace(tabletop, robots={"panda": Mount("no_such_robot")})
    with pytest.raises(SceneError, match=r"the scene cannot be built: KeyError: 'no_such_robot'"):
        list(validate_tasks([stacking()], unknown, seed=0))


def _hopeless():
    """Return a task that takes the whole budget: three cubes' worth of things in a tray that is full."""
    crowd = ["cube_1", "cube_2", "brick_1", "brick_2", "can_1"]
    initial = state(*[f"inside({name},tray_1)" for name in crowd], *[f"left_of({name},bin_1)" for name in crowd])
    return task(initial, ("x(panda)", state("right_of(can_1,tray_1)")))


@pytest.mark.parametrize("way", ["close", "interrupt"])
def test_an_iterator_that_is_left_ends_its_workers_at_once(tabletop, way, started):
    endless = chain([stacking()] * 4, repeat(_hopeless()))
    verdicts = validate_tasks(endless, tabletop, seed=0, workers=2, budget=Budget(100_000, 100))
    next(verdicts)
    assert started()
    begun = time.monotonic()
    if way == "close":
        verdicts.close()
    else:
        with pytest.raises(KeyboardInterrupt):
            _consume(verdicts)
        del verdicts
    assert time.monotonic() - begun < 60
    assert not started()


def _consume(verdicts):
    for _ in verdicts:
        raise KeyboardInterrupt

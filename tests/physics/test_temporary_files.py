"""What is written for PyBullet is gone once it is read, however its process ends."""

from __future__ import annotations

import errno
import itertools
import os
import subprocess
import sys
from pathlib import Path
from threading import Thread
from types import FrameType

import pytest

from prag_asp.errors import OutputError
from prag_asp.physics import temporary_files
from prag_asp.physics.temporary_files import temporary_folder

WORKERS = """
import multiprocessing, os, time
from contextlib import ExitStack
from tempfile import gettempdir
from prag_asp.physics.filming.studio import open_studio
from prag_asp.physics.world.dynamics import open_dynamics
from prag_asp.physics.world.primitives import mesh_file, open_shapes
from prag_asp.physics.world.simulator import open_simulator
from prag_asp.physics.witness import Arm, Moment
from prag_asp.scene.scene import Scene, Shape, Solid
from prag_asp.scene.robots import Mount

SCENE = Scene({"arm": Shape("robot")}, robots={"arm": Mount("panda")})
MESH = Solid("mesh", (1.0, 1.0, 1.0), mesh="mesh.obj")
HOME = Moment({}, {"arm": Arm((0.0,) * 7, 0.04)})

def work(loaded=None, until=None):
    with ExitStack() as worlds:
        simulator = worlds.enter_context(open_simulator(SCENE))
        with open_shapes([MESH, MESH], simulator.client, "#808080") as shapes:
            assert min(shapes) >= 0
        worlds.enter_context(open_dynamics(SCENE)).begin((), HOME)
        worlds.enter_context(open_studio(SCENE, ())).show(HOME)
        assert os.listdir(gettempdir()) == [], "loaded, and still there"
        if loaded:
            loaded.set()
            until.wait()

processes = multiprocessing.get_context("fork")
work()
for end in ("regular", "terminate", "kill"):
    loaded, until = processes.Event(), processes.Event()
    worker = processes.Process(target=work, args=(loaded, until))
    worker.start()
    loaded.wait()
    until.set() if end == "regular" else getattr(worker, end)()
    worker.join()
    assert (worker.exitcode == 0) == (end == "regular")
    assert os.listdir(gettempdir()) == [], end
"""


@pytest.fixture
def temporary(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Make a folder for what is temporary."""
    folder = tmp_path / "temporary"
    folder.mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(folder))
    return folder


def test_workers_that_end_and_that_are_terminated_or_killed_leave_no_file(tmp_path: Path, temporary: Path) -> None:
    (tmp_path / "mesh.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n")
    environment = {**os.environ, "TMPDIR": str(temporary)}
    subprocess.run([sys.executable, "-c", WORKERS], cwd=tmp_path, env=environment, check=True, timeout=600)


def test_each_thread_has_one_place_that_is_there_while_it_is_used(temporary: Path) -> None:
    def use() -> None:
        for content in (b"one", b"two"):
            with temporary_folder({"mesh.obj": content}) as folder:
                places.append(folder)
                assert (folder / "mesh.obj").read_bytes() == content
                if len(places) == 1:
                    other = Thread(target=use)
                    other.start()
                    other.join()

    places: list[Path] = []
    use()
    assert places[0] == places[3] != places[1] == places[2] and not any(temporary.iterdir())


def test_what_cannot_be_loaded_leaves_no_file_either(temporary: Path) -> None:
    with pytest.raises(ValueError, match="not to be loaded"), temporary_folder({"mesh.obj": b""}):
        raise ValueError("not to be loaded")
    with temporary_folder({}) as folder:
        assert not folder.exists()
    assert not any(temporary.iterdir())


def test_what_an_interruption_leaves_anywhere_bars_no_later_use(temporary: Path) -> None:
    """Interrupt a use at each of its lines, as Ctrl-C may."""

    class Interrupting:
        def __init__(self, line: int) -> None:
            self.left = line

        def __call__(self, frame: FrameType, event: str, argument: object) -> Interrupting | None:
            if frame.f_code.co_filename != temporary_files.__file__:
                return None
            if event == "line":
                self.left -= 1
                if self.left == 0:
                    raise KeyboardInterrupt
            return self

    for line in itertools.count(1):
        interrupting = Interrupting(line)
        before = sys.gettrace()
        sys.settrace(interrupting)
        try:
            with temporary_folder({"mesh.obj": b"one"}):
                pass
        except KeyboardInterrupt:
            pass
        finally:
            sys.settrace(before)
        with temporary_folder({"mesh.obj": b"two"}) as folder:
            assert [each.read_bytes() for each in folder.iterdir()] == [b"two"]
        assert not any(temporary.iterdir())
        if interrupting.left > 0:
            break
    assert line > 8


def test_what_cannot_be_written_is_reported_in_one_line_and_leaves_nothing(
    temporary: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(path: Path, content: bytes) -> int:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))  # a write names no file, opening does

    with monkeypatch.context() as patch:
        patch.setattr(Path, "write_bytes", full)
        with (
            pytest.raises(OutputError, match=r"^/.*: No space left on device; set TMPDIR"),
            temporary_folder({"mesh.obj": b""}),
        ):
            pass
    assert not any(temporary.iterdir())
    monkeypatch.setattr("tempfile.tempdir", str(temporary / "gone"))
    with pytest.raises(OutputError, match=r"gone/prag_asp_.*: No such file"), temporary_folder({"mesh.obj": b""}):
        pass
    monkeypatch.setattr("tempfile.tempdir", None)
    monkeypatch.setattr("tempfile._candidate_tempdir_list", lambda: [str(temporary / "gone")])
    with (
        pytest.raises(OutputError, match=r"^No usable temporary directory .*; set TMPDIR"),
        temporary_folder({"mesh.obj": b""}),
    ):
        pass

"""Human rendering: a window shows the camera after each reset and step, or one line says what is missing."""

from __future__ import annotations

import sys
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest

from prag_asp import QueryError
from prag_asp.rl import TaskEnv


class TclError(Exception):
    """The error of Tk."""


def toolkit(shown: list[bytes], fails: list[str]) -> ModuleType:
    """Return a module in the place of tkinter, which keeps what it shows and fails as told."""

    def root() -> Any:
        if fails:
            raise TclError(fails[0])
        return SimpleNamespace(title=lambda text: None, update=lambda: None, destroy=lambda: shown.append(b"closed"))

    module: Any = ModuleType("tkinter")
    module.TclError, module.Tk = TclError, root
    module.Label = lambda root: SimpleNamespace(pack=lambda: None, configure=lambda image: None)
    module.PhotoImage = lambda master, data, **_: shown.append(data)
    return module  # type: ignore[no-any-return]


def test_a_window_shows_each_moment_and_closes(monkeypatch: pytest.MonkeyPatch) -> None:
    shown: list[bytes] = []
    monkeypatch.setitem(sys.modules, "tkinter", toolkit(shown, []))
    env = TaskEnv(domain="tabletop", length=1, render_mode="human", size=(48, 32))
    env.reset(seed=0)
    env.step(env.action_space.sample())
    assert env.render() is None
    assert [each[:13] for each in shown] == [b"P6 48 32 255\n"] * 2
    assert {len(each) for each in shown} == {13 + 48 * 32 * 3}
    env.close()
    assert shown.pop() == b"closed"


def test_what_is_missing_is_said_in_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "tkinter", toolkit([], ["no display name and no $DISPLAY environment variable"]))
    with pytest.raises(QueryError, match=r"needs a display: no display name .* use render_mode=\"rgb_array\""):
        TaskEnv(domain="tabletop", length=1, render_mode="human")
    monkeypatch.setitem(sys.modules, "tkinter", None)
    with pytest.raises(QueryError, match="needs Tk, which this Python lacks"):
        TaskEnv(domain="tabletop", length=1, render_mode="human")

"""The engines, and their selection by name."""

from __future__ import annotations

from importlib import import_module

from prag_asp.errors import EngineError, QueryError
from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.processes.progress_events import Note
from prag_asp.space import ENGINES
from prag_asp.space.engines.engine import LEVELS, Draw, Engine, Level, MakeEngine, Progress
from prag_asp.space.limits import UNLIMITED, Limits

AUTO = "auto"
CHOICE, OTHERWISE = (
    "prag_asp.space.engines.auto_engine.AutoEngine",
    "prag_asp.space.engines.auto_engine.searching_engine",
)
"""The class that ``auto`` tries first, and the function that returns clingo if a step is not a function of the state.
"""


def select(
    name: str, model: DomainLogic, level: Level, progress: Progress | None = None, limits: Limits = UNLIMITED
) -> Engine:
    """Return the engine with a given name.

    ``auto`` selects the automaton; if the automaton would have too many states, diagrams; and if a step is not a
    function of the state, clingo with a parallel model counter.

    Raises:
        QueryError: there is no such engine.
        EngineError: the requested engine cannot express the domain.
    """
    if name == AUTO:
        try:
            return _load(CHOICE)(model, level, progress, limits)
        except EngineError as error:
            if progress:
                progress(Note(f"note: engine clingo, because {error}"))
            return _load(OTHERWISE)(model, level, progress, limits)
    if name not in ENGINES:
        raise QueryError(f"no engine {name!r}; there are {', '.join((AUTO, *ENGINES))}")
    return engine_class(name)(model, level, progress, limits)


def engine_class(name: str) -> MakeEngine:
    """Return the class or function that `ENGINES` names."""
    return _load(ENGINES[name])


def _load(path: str) -> MakeEngine:
    module, _, own = path.rpartition(".")
    make: MakeEngine = getattr(import_module(module), own)
    return make


__all__ = ["ENGINES", "LEVELS", "Draw", "Engine", "Level", "engine_class", "select"]

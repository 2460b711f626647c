"""The engines, by name; `select` takes the best one that can express a domain."""

from __future__ import annotations

from prag_asp.errors import EngineError, QueryError
from prag_asp.logic.model import Model
from prag_asp.space.engines.automaton import AutomatonEngine
from prag_asp.space.engines.protocol import LEVELS, Draw, Engine, Level, MakeEngine, Progress
from prag_asp.space.limits import UNLIMITED, Limits


def _clingo(model: Model, level: Level, progress: Progress | None, limits: Limits) -> Engine:
    from prag_asp.space.engines.clingo import ClingoEngine

    return ClingoEngine(model, level, progress, limits)


def _sat(model: Model, level: Level, progress: Progress | None, limits: Limits) -> Engine:
    from prag_asp.space.engines.sat import SatEngine

    return SatEngine(model, level, progress, limits)


def _sharp(model: Model, level: Level, progress: Progress | None, limits: Limits) -> Engine:
    from prag_asp.space.engines.sharp import SharpEngine

    return SharpEngine(model, level, progress, limits)


ENGINES: dict[str, MakeEngine] = {"automaton": AutomatonEngine, "clingo": _clingo, "sat": _sat, "sharp": _sharp}
AUTO = "auto"


def select(
    name: str, model: Model, level: Level, progress: Progress | None = None, limits: Limits = UNLIMITED
) -> Engine:
    """Return the engine of a name; ``auto`` is the automaton, or clingo where a step is no function of the state.

    Raises:
        QueryError: there is no such engine.
        EngineError: the engine asked for cannot express the domain.
    """
    if name == AUTO:
        try:
            return AutomatonEngine(model, level, progress, limits)
        except EngineError as error:
            if progress:
                progress(f"engine clingo, because {error}")
            return _clingo(model, level, progress, limits)
    if name not in ENGINES:
        raise QueryError(f"no engine {name!r}; there are {', '.join((AUTO, *ENGINES))}")
    return ENGINES[name](model, level, progress, limits)


__all__ = ["ENGINES", "LEVELS", "Draw", "Engine", "Level", "select"]

"""Predicates that a domain defines in a Python file, which runs only if the user trusts the domain.

Like the modules of this package, the file defines `PREDICATES`, which maps names to predicates. Every error in the file
becomes a `SceneError` that names the file and the line.
"""

from __future__ import annotations

import math
import sys
import traceback
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache, partial, wraps
from importlib.util import module_from_spec, spec_from_file_location
from inspect import unwrap
from numbers import Real
from pathlib import Path
from typing import Any, NamedTuple

from prag_asp.errors import PragError, SceneError
from prag_asp.physics.predicates.gaps import Gap
from prag_asp.physics.predicates.predicate import Predicate
from prag_asp.physics.predicates.volume import Volume
from prag_asp.scene.scene import Own
from prag_asp.wording import plural


def load_predicate(own: Own) -> Predicate:
    """Return a predicate that a trusted Python file defines; the file runs once per process.

    Raises:
        SceneError: the file fails, or does not define the predicate.
    """
    predicates = _run(own.file)
    predicate = predicates.get(own.name)
    if predicate is None:
        raise SceneError(
            f"{own.file}:1: PREDICATES has no {own.name}; it has {', '.join(map(str, predicates)) or 'nothing'}"
        )
    if not isinstance(predicate, Predicate) or predicate.name != own.name:
        got = f"one named {predicate.name}" if isinstance(predicate, Predicate) else repr(predicate)
        raise SceneError(f"{own.file}:1: PREDICATES[{own.name!r}] needs a Predicate of that name; got {got}")
    if not 0 <= predicate.subject < len(own.roles):
        count = plural(len(own.roles), "argument")
        raise SceneError(f"{own.file}:1: {own.name} has the subject {predicate.subject} of {count}; count from 0")
    parts = {part: getattr(predicate, part) for part in RESULTS}
    functions = {part: function for part, function in parts.items() if function is not None or part in NEEDED}
    for part, function in functions.items():
        if not callable(function):
            raise SceneError(f"{own.file}:1: {own.name}: its {part} has to be a function; got {function!r}")
    guarded: dict[str, Any] = {part: _guarded(own, part, function) for part, function in functions.items()}
    return replace(predicate, **guarded, looks_around=True)


@cache
def _run(file: str) -> Mapping[Any, Any]:
    """Return the `PREDICATES` of a Python file."""
    name = f"prag_asp_predicates_{abs(hash(file)):x}"
    spec = spec_from_file_location(name, file)
    if spec is None or spec.loader is None:
        raise SceneError(f"{file}:1: is not a Python file; give it a name that ends in .py")
    module = module_from_spec(spec)
    sys.modules[name] = module
    try:
        spec.loader.exec_module(module)
    except (Exception, SystemExit) as error:
        del sys.modules[name]
        raise SceneError(f"{_place(file, error)}: {_error_line(error)}; fix the file") from error
    predicates = getattr(module, "PREDICATES", None)
    if not isinstance(predicates, Mapping):
        raise SceneError(f'{file}:1: defines no PREDICATES; write PREDICATES = {{"name": Predicate(...)}}')
    return predicates


def _place(file: str, error: BaseException) -> str:
    """Return the position in a file, as ``file:line``, from the traceback of an error."""
    if isinstance(error, SyntaxError) and error.filename == file:
        return f"{file}:{error.lineno or 1}"
    lines = [frame.lineno for frame in traceback.extract_tb(error.__traceback__) if Path(frame.filename) == Path(file)]
    return f"{file}:{lines[-1] if lines else 1}"


def _error_line(error: BaseException) -> str:
    """Return an error as one line of text."""
    text = error.msg if isinstance(error, SyntaxError) else str(error)
    return f"{type(error).__name__}: {' '.join(str(text).split())}"


def _guarded(own: Own, part: str, function: Callable[..., Any]) -> Callable[..., Any]:
    """Return a function from a predicate file, wrapped to raise a `SceneError` for an error or an invalid result."""
    fine, needed, yielded = RESULTS[part]
    inner = unwrap(function)
    while isinstance(inner, partial):
        inner = unwrap(inner.func)
    code = getattr(inner if hasattr(inner, "__code__") else type(inner).__call__, "__code__", None)
    line = code.co_firstlineno if code is not None and Path(code.co_filename) == Path(own.file) else 1
    place = f"{own.file}:{line}"

    @wraps(function)
    def guarded(*arguments: Any, **options: Any) -> Any:
        try:
            result = function(*arguments, **options)
            if yielded:
                result = list(result)
        except PragError:
            raise
        except (Exception, SystemExit) as error:
            raise SceneError(f"{_place(own.file, error)}: {own.name}: {_error_line(error)}; fix the file") from error
        if not fine(result):
            got = " ".join(repr(result).split())
            raise SceneError(f"{place}: {needed.format(own.name)}; got {got}; fix the function")
        return iter(result) if yielded else result

    return guarded


def _is_volume(result: object) -> bool:
    """Return whether a value is a volume whose bounds are not NaN."""
    return isinstance(result, Volume) and not any(map(math.isnan, (*result.low, *result.high, *result.width)))


def _are_numbers(result: list[Any]) -> bool:
    """Return whether there are values and all are numbers; a predicate without violations would always hold."""
    return bool(result) and all(isinstance(value, Real) and not math.isnan(value) for value in result)


def _are_demands(result: list[Any]) -> bool:
    """Return whether all values are pairs of an axis and a gap."""
    return all(
        isinstance(value, tuple) and len(value) == 2 and value[0] in range(3) and isinstance(value[1], Gap)
        for value in result
    )


def _is_text(result: object) -> bool:
    """Return whether a value is a string."""
    return isinstance(result, str)


class Result(NamedTuple):
    """The requirement for a function's result: a test, a message, and whether the function yields its values."""

    fine: Callable[[Any], bool]
    needed: str
    yielded: bool = False


RESULTS: Mapping[str, Result] = {
    "violations": Result(_are_numbers, "the violations of {} have to be numbers, at least one", yielded=True),
    "way": Result(lambda found: _are_numbers([found]), "the way to {} has to be a number"),
    "volume": Result(_is_volume, "the volume of {} has to be a Volume, with numbers as its bounds"),
    "sentence": Result(_is_text, "the sentence of {} has to be a string"),
    "robot_sentence": Result(_is_text, "the robot_sentence of {} has to be a string"),
    "otherwise": Result(_is_volume, "the volume `otherwise` of {} has to be a Volume, with numbers as its bounds"),
    "impossible": Result(
        lambda found: all(map(_is_text, found)), "the reasons why {} is impossible have to be strings", yielded=True
    ),
    "demands": Result(_are_demands, "the demands of {} have to be pairs of an axis (0 to 2) and a Gap", yielded=True),
    "excludes": Result(
        lambda found: found is None or _is_text(found), "the reason why {} excludes another has to be a string, or None"
    ),
    "nowhere": Result(lambda found: isinstance(found, bool), "the result of `nowhere` of {} has to be True or False"),
}
"""The requirement for each function of a predicate."""

NEEDED = ("violations", "volume", "sentence")

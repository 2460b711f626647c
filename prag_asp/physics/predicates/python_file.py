"""Predicates that a domain defines in a Python file of its own, which is run only where the user trusts it.

The file defines `PREDICATES`, the predicates by their names, as `prag_asp.physics` has them. Whatever goes wrong in
it, then or later, is an error of the scene with the file and the line.
"""

from __future__ import annotations

import math
import sys
import traceback
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import cache, partial, wraps
from importlib.util import module_from_spec, spec_from_file_location
from inspect import unwrap
from numbers import Real
from pathlib import Path
from typing import Any

from prag_asp.errors import PragError, SceneError
from prag_asp.physics.predicates.predicate import Arguments, Predicate
from prag_asp.physics.predicates.volume import Volume
from prag_asp.physics.situation import Situation
from prag_asp.scene.model import Own
from prag_asp.wording import plural


def defined(own: Own) -> Predicate:
    """Return a predicate that a trusted Python file defines; the file is run once in a process.

    Raises:
        SceneError: the file fails, or does not define the predicate.
    """
    found = _run(own.file)
    predicate = found.get(own.name)
    if predicate is None:
        raise SceneError(
            f"{own.file}:1: PREDICATES has no {own.name}; it has {', '.join(map(str, found)) or 'nothing'}"
        )
    if not isinstance(predicate, Predicate) or predicate.name != own.name:
        got = f"one of the name {predicate.name}" if isinstance(predicate, Predicate) else repr(predicate)
        raise SceneError(f"{own.file}:1: PREDICATES[{own.name!r}] has to be a Predicate of that name; got {got}")
    if not 0 <= predicate.subject < len(own.roles):
        count = plural(len(own.roles), "argument")
        raise SceneError(
            f"{own.file}:1: {own.name} has the subject {predicate.subject}, but {count}; count them from 0"
        )
    for part in ("violations", "volume", "sentence"):
        if not callable(getattr(predicate, part)):
            raise SceneError(f"{own.file}:1: {own.name}: its {part} is no function; got {getattr(predicate, part)!r}")
    return replace(
        predicate,
        violations=_guarded_violations(own, predicate.violations),
        volume=_guarded(own, "volume", predicate.volume),
        sentence=_guarded(own, "sentence", predicate.sentence),
        looks_around=True,
    )


@cache
def _run(file: str) -> Mapping[Any, Any]:
    """Return the `PREDICATES` of a Python file."""
    name = f"prag_asp_predicates_{abs(hash(file)):x}"
    spec = spec_from_file_location(name, file)
    if spec is None or spec.loader is None:
        raise SceneError(f"{file}:1: is no Python file; give it a name that ends in .py")
    module = module_from_spec(spec)
    sys.modules[name] = module
    try:
        spec.loader.exec_module(module)
    except (Exception, SystemExit) as error:
        del sys.modules[name]
        raise SceneError(f"{_place(file, error)}: {_told(error)}; mend the file") from error
    found = getattr(module, "PREDICATES", None)
    if not isinstance(found, Mapping):
        raise SceneError(f'{file}:1: defines no PREDICATES; write PREDICATES = {{"name": Predicate(...)}}')
    return found


def _place(file: str, error: BaseException) -> str:
    """Return the last line of a file that an error came through."""
    if isinstance(error, SyntaxError) and error.filename == file:
        return f"{file}:{error.lineno or 1}"
    lines = [frame.lineno for frame in traceback.extract_tb(error.__traceback__) if Path(frame.filename) == Path(file)]
    return f"{file}:{lines[-1] if lines else 1}"


def _told(error: BaseException) -> str:
    """Return an error in one line."""
    text = error.msg if isinstance(error, SyntaxError) else str(error)
    return f"{type(error).__name__}: {' '.join(str(text).split())}"


def _guarded(own: Own, part: str, function: Callable[..., Any]) -> Callable[..., Any]:
    """Return the function of a file for a part of a predicate; its errors and wrong results are errors of the scene."""
    fine, needed = FINE[part]
    place = _defined_at(own.file, function)

    @wraps(function)
    def guarded(*arguments: Any, **options: Any) -> Any:
        try:
            result = function(*arguments, **options)
            if part == "violations":
                result = list(result)
        except PragError:
            raise
        except (Exception, SystemExit) as error:
            raise SceneError(f"{_place(own.file, error)}: {own.name}: {_told(error)}; mend the file") from error
        if not fine(result):
            got = " ".join(repr(result).split())
            raise SceneError(f"{place}: the {part} of {own.name} {needed}; got {got}; mend the function")
        return result

    return guarded


def _guarded_violations(own: Own, function: Callable[..., Any]) -> Callable[..., Iterator[float]]:
    """Return violations of a file, each checked to be a number: one that is none would hold everywhere."""
    listed = _guarded(own, "violations", function)

    @wraps(function)
    def checked(situation: Situation, arguments: Arguments) -> Iterator[float]:
        return iter(listed(situation, arguments))

    return checked


def _defined_at(file: str, function: Callable[..., Any]) -> str:
    """Return where a function of a file begins, the first line of the file where it is from elsewhere."""
    inner = unwrap(function)
    while isinstance(inner, partial):
        inner = unwrap(inner.func)
    code = getattr(inner if hasattr(inner, "__code__") else type(inner).__call__, "__code__", None)
    return f"{file}:{code.co_firstlineno if code is not None and Path(code.co_filename) == Path(file) else 1}"


def _is_volume(result: object) -> bool:
    """Tell whether a value is a volume, none of whose bounds is not a number."""
    return isinstance(result, Volume) and not any(map(math.isnan, (*result.low, *result.high, *result.width)))


def _are_numbers(result: list[Any]) -> bool:
    """Tell whether all of at least one value are numbers."""
    return bool(result) and all(isinstance(value, Real) and not math.isnan(value) for value in result)


FINE: Mapping[str, tuple[Callable[[Any], bool], str]] = {
    "violations": (_are_numbers, "have to be numbers, at least one"),
    "volume": (_is_volume, "has to be a Volume, with numbers as its bounds"),
    "sentence": (lambda text: isinstance(text, str), "has to be a string"),
}
"""For each function of a predicate, whether a result is fine, and what is needed of it."""

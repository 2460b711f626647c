"""Dictionaries that cannot be changed, so that many tasks can share one."""

from __future__ import annotations

from collections.abc import Hashable
from typing import Any, NoReturn, TypeVar

Key = TypeVar("Key", bound=Hashable)
Value = TypeVar("Value", bound=Hashable)


class FrozenDict(dict[Key, Value]):
    """A dictionary that refuses every change, equals any dictionary with its items, and has a hash.

    It is a `dict` because reading it is then as fast as can be, and a copy of it (``dict(frozen)``) a plain one.
    """

    __slots__ = ("_hash",)
    _hash: int

    def __hash__(self) -> int:  # type: ignore[override]
        try:
            return self._hash
        except AttributeError:
            self._hash = hash(frozenset(self.items()))
            return self._hash

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (dict(self),)

    def __copy__(self) -> FrozenDict[Key, Value]:
        return self

    def __deepcopy__(self, memo: dict[int, Any]) -> FrozenDict[Key, Value]:
        return self

    def __repr__(self) -> str:
        return f"FrozenDict({dict(self)!r})"

    def _refuse(self, *arguments: object, **items: object) -> NoReturn:
        raise TypeError("it is shared between tasks and cannot be changed; change a copy, dict(...)")

    __setitem__ = __delitem__ = __ior__ = _refuse
    clear = pop = popitem = setdefault = update = _refuse

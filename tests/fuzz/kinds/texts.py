"""Change texts by tokens, and values by their types."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from pathlib import Path
from random import Random
from typing import Any

SEEDS = Path(__file__).parents[1] / "seeds"

TOKEN = re.compile(r"\w+|\s+|.", re.DOTALL)
CONTROLS = ["\x1b[31m", "\x07", "\x00", "\x7f", "\x9b2J", "\u202e", "\u2028", "\r", "\x0c", "\x1b]0;title\x07"]
"""What terminals obey."""

CHARACTERS = [*"().,:-%*\"'#@&|;{}[]~!?$<>=+/\\^_ \n\tX0é♥", "\U0001f600", "\ud7ff", *CONTROLS]
NUMBERS = [
    "0",
    "-1",
    "1",
    "2",
    "3",
    "99",
    "1000000",
    "2147483647",
    "2147483648",
    "-2147483649",
    "99999999999",
    "9" * 40,
    "1e999",
    "0.1",
    "1e-400",
    "0x10",
    "nan",
    "inf",
]


def changed(text: str, chance: Random, strange: Sequence[str], times: int = 4) -> str:
    """Return a text with a few of its tokens deleted, moved, doubled, misspelt, or replaced by strange ones."""
    tokens = TOKEN.findall(text) or [" "]
    for _ in range(chance.randint(1, times)):
        _change(tokens, chance, strange)
    return "".join(tokens)


def _at(tokens: list[str], chance: Random) -> int:
    """Return a position, mostly of a word."""
    for _ in range(4):
        at = chance.randrange(len(tokens))
        if not tokens[at].isspace():
            return at
    return chance.randrange(len(tokens))


def _change(tokens: list[str], chance: Random, strange: Sequence[str]) -> None:
    kind = chance.randrange(11)
    match kind:
        case 0:  # remove some
            at = _at(tokens, chance)
            tokens[at : at + chance.choice([1, 1, 1, 5, 30])] = [" "]
        case 1:  # copy one
            tokens[_at(tokens, chance)] = tokens[_at(tokens, chance)]
        case 2 | 3:  # swap two, or move some
            at, other = _at(tokens, chance), _at(tokens, chance)
            if kind == 2:
                tokens[at], tokens[other] = tokens[other], tokens[at]
            else:
                tokens[other:other] = tokens[at : at + chance.choice([1, 5, 30])]
        case 4:
            tokens.insert(_at(tokens, chance), chance.choice(strange))
        case 5:
            new = chance.choice(strange)
            tokens[_at(tokens, chance)] = new
        case 6:  # misspell one
            at = _at(tokens, chance)
            cut = chance.randrange(len(tokens[at]) + 1)
            tokens[at] = tokens[at][:cut] + chance.choice(["a", "b", "X", "1", "_", ""]) + tokens[at][cut + 1 :]
        case 7:
            found = [i for i, token in enumerate(tokens) if token.isdigit()]
            new = chance.choice(NUMBERS)
            tokens[chance.choice(found) if found else _at(tokens, chance)] = new
        case 8:  # rename one everywhere
            old, new = tokens[_at(tokens, chance)], tokens[_at(tokens, chance)]
            tokens[:] = [new if token == old else token for token in tokens]
        case _:  # remove a line, or have it twice
            lines = "".join(tokens).split("\n")
            at = chance.randrange(len(lines))
            lines[at : at + 1] = chance.choice([[], [lines[at], lines[at]]])
            tokens[:] = TOKEN.findall("\n".join(lines)) or [" "]


def broken(content: bytes, chance: Random) -> bytes:
    """Return bytes of which some are others, are left out, or come twice."""
    found = bytearray(content)
    for _ in range(chance.randint(1, 3)):
        at = chance.randrange(len(found) + 1)
        match chance.randrange(5):
            case 0:
                del found[at:]
            case 1:
                del found[at : at + chance.randint(1, 40)]
            case 2:
                found[at:at] = chance.randbytes(chance.choice([1, 4, 40]))
            case 3:
                found[at : at + 1] = bytes([chance.choice([0, 10, 34, 127, 128, 0xC3, 0xFF])])
            case _:
                found[at:at] = found[: chance.randint(0, 2000)]
    return bytes(found)


VALUES: Sequence[Any] = (
    None,
    True,
    False,
    0,
    1,
    -1,
    2**31,
    2**63,
    2**64,
    -(2**70),
    10**400,
    0.0,
    -0.0,
    0.5,
    1e-320,
    1e308,
    float("nan"),
    float("inf"),
    float("-inf"),
    "",
    " ",
    "x",
    "panda",
    "1",
    "é",
    "x" * 5000,
    "../../outside/secret.lp",
    "/etc/passwd",
    "/dev/zero",
    *(f"a{each}b" for each in CONTROLS),
    [],
    [0],
    [[]],
    {},
    {"": 0},
    {"x": None},
    [None] * 3,
    [1e9] * 3,
    [0.1] * 2,
    {"a\x1b[1m\nb": 1},
)


def exchanged(value: Any, chance: Random) -> Any:
    """Return a value of JSON or TOML in which something at some depth is another, is gone, or has another name."""
    holders = [path for path, each in _inner(value) if isinstance(each, (dict, list)) and each]
    if not holders:
        return chance.choice(VALUES)
    # Those near the top are as likely as the many deep ones.
    depth = chance.randrange(1 + max(map(len, holders)))
    near = [path for path in holders if len(path) == depth] or holders
    return _exchanged_at(value, chance.choice(near), chance)


def _inner(value: Any, path: tuple[Any, ...] = ()) -> list[tuple[tuple[Any, ...], Any]]:
    found = [(path, value)]
    pairs = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, each in pairs:
        found += _inner(each, (*path, key))
    return found


def _exchanged_at(value: Any, path: tuple[Any, ...], chance: Random) -> Any:
    if path:
        copy = value.copy()
        copy[path[0]] = _exchanged_at(value[path[0]], path[1:], chance)
        return copy
    copy = value.copy()
    key = chance.choice(list(value) if isinstance(value, dict) else range(len(value)))
    match chance.randrange(8):
        case 0:
            del copy[key]
        case 1:
            if isinstance(copy, dict):
                name = chance.choice([changed(str(key), chance, CHARACTERS, 1), chance.choice(CONTROLS), "é", ""])
                copy[name] = copy.pop(key)
            else:
                copy += copy
        case 2:
            other = chance.choice(list(value.values()) if isinstance(value, dict) else value)
            copy[key] = other
        case 3:
            copy[key] = [copy[key]] if chance.random() < 0.5 else {"x": copy[key]}
        case 4 if isinstance(copy[key], (int, float)) and not isinstance(copy[key], bool):
            number = copy[key]
            whole = number if isinstance(number, float) and not math.isfinite(number) else int(number)
            more = number * 11 // 10 if isinstance(number, int) else number * 1.1
            copy[key] = chance.choice([-number, more, number * 10**6, whole, str(number)])
        case 5 if isinstance(copy[key], str):
            copy[key] = changed(copy[key], chance, CHARACTERS, 1)
        case _:
            copy[key] = chance.choice(VALUES)
    return copy

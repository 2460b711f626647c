"""What is wrong with how a command answered: this is where it is defined what an answer has to be.

A command ends with one of the exit codes of the page about them. Where the code is not 0, it says why: in exactly one
line on stderr, but

- a check of a domain prints a line for each problem, and each of these begins with ``file:line: `` and is another;
- a line that says how many warnings there are, and one that begins with ``note: ``, may come before it, and warnings
  with their names in brackets, and what `generate` says of its folder;
- with code 1, `validate`, `explain`, `sample` and `verify` have answered on stdout, and their figures are on stderr;
  where `sample` found nothing, its figures are followed by the line that says so.

No line on stderr is longer than 500 characters, or has a character that a terminal would obey.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path

from tests.fuzz.isolated import Ran
from tests.fuzz.mutant import SECRET, Mutant

LONGEST_LINE = 500
MEMORY = 2 * 10**9
PAGE = Path(__file__).parents[2] / "docs" / "reference" / "exit_codes.md"
CODES = frozenset(map(int, re.findall(r"^\| (\d+) \|", PAGE.read_text(encoding="utf-8"), re.MULTILINE))) - {5, 130, 143}
"""The exit codes that there are, but those of workers that died and of interruptions: nobody interrupts a mutant."""

PLACE = re.compile(r".+?:\d+: \S.*")
FOLDER = r"holds the tasks that were found|already has \d+ tasks?|continues an interrupted run.*"
"""What `generate` says of its folder."""

BESIDE = re.compile(rf"\d+ warnings? about .*|note: .*|.*: warning: .* \[[a-z-]+\]|.*: ({FOLDER})")
"""Lines that may stand beside the one that says why."""

FIGURES = ("validate", "explain", "sample", "verify")
"""Commands that answer on stdout even where the code is 1."""

OBEYED = re.compile(r"[\x00-\x09\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028\u2029\u202a-\u202e\u2066-\u2069\ufeff]")
"""Characters that a terminal obeys, or that turn what is written around."""


def fault(ran: Ran, arguments: Sequence[str], mutant: Mutant) -> str:
    """Return what is wrong with how a command answered, nothing where nothing is; its first word is the kind."""
    err = ran.err.decode("utf-8", "replace")
    lines = err.splitlines()
    return _first(_bad_ends(ran, err)) or _first(_bad_texts(ran, err)) or _lacks_reason(ran, lines, arguments, mutant)


def _first(checks: Mapping[str, bool]) -> str:
    """Return the first fault that a check has found, if any."""
    return next((what for what, is_so in checks.items() if is_so), "")


def _bad_ends(ran: Ran, err: str) -> Mapping[str, bool]:
    last = (err.strip().splitlines() or [""])[-1]
    places = re.findall(r'File ".*?/(prag_asp/[^"]*)", line (\d+)', err)
    return {
        f"hang after {ran.seconds:.0f} s": ran.hung,
        f"memory {ran.peak_bytes / 1e9:.1f} GB": "MemoryError" in err or "bad_alloc" in err or ran.peak_bytes > MEMORY,
        f"signal {-ran.code}": ran.code < 0,
        f"traceback {':'.join(places[-1]) if places else ''} {last[:100]}": "Traceback (most recent call last)" in err,
        "outlived: a process is left over": ran.outlived,
        f"code {ran.code}": ran.code not in CODES,
    }


def _bad_texts(ran: Ran, err: str) -> Mapping[str, bool]:
    obeyed, longest = OBEYED.search(err), max(map(len, err.split("\n")))
    return {
        f"control character {obeyed and obeyed[0]!r} on stderr": obeyed is not None,
        f"long line of {longest} characters": longest > LONGEST_LINE,
        "leak of what is outside of the folder": SECRET in err or SECRET.encode() in ran.out,
    }


def _lacks_reason(ran: Ran, lines: Sequence[str], arguments: Sequence[str], mutant: Mutant) -> str:
    if ran.code == 0:
        return "silence: accepted without output" if mutant.owes_output and not ran.out else ""
    found_nothing = any(line.startswith("only 0 of ") for line in lines)
    if ran.code == 1 and arguments[0] in FIGURES and (ran.out or found_nothing):
        return ""
    why = [line for line in lines if not BESIDE.fullmatch(line)]
    placed = [bool(PLACE.fullmatch(line)) for line in why]
    checks = {
        f"silence: code {ran.code} without a word": not why,
        f"lines: {len(why)} where one is due, {why[:1]}": len(why) > 1 and not all(placed),
        "lines: the same one twice": len(set(why)) < len(why),
        f"placeless: no file and line, {why[:1]}": mutant.placed and ran.code == 2 and not all(placed),
    }
    return _first(checks)

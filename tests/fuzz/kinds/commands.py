"""Mutants of command lines."""

from __future__ import annotations

from random import Random

from tests.fuzz.kinds.domains import files_of
from tests.fuzz.kinds.texts import CHARACTERS, CONTROLS, NUMBERS, SEEDS, changed
from tests.fuzz.mutant import Mutant

LINES = [
    ["count", "closed", "-n", "3"],
    ["count", "timed", "-n", "1..3", "--by", "skeleton"],
    ["count", "closed", "-n", "3", "--where", "has at least 1 move, nontrivial"],
    ["count", "closed", "-n", "3", "--prefix", "look(a)"],
    ["count", "timed", "-n", "3", "-c", "capacity=3", "--engine", "sat"],
    ["count", "timed/domain.lp", "-n", "2", "--rule", "no_undo"],
    ["count", "-", "-n", "2", "--memory", "1GB", "--time", "10s"],
    ["enumerate", "closed", "-n", "2", "--format", "jsonl"],
    ["task", "timed", "-n", "2", "--index", "3"],
    ["task", "timed", "-n", "1", "--rank-of", "take(arm,cup(1))"],
    ["sample", "closed", "-n", "2", "--count", "3", "--weight", "move=2", "--temperature", "0.5"],
    ["sample", "timed", "-n", "2..3", "--count", "2", "--over", "goals", "--seed", "3", "--format", "sentences"],
    ["task", "scene", "-n", "1", "--index", "0", "--format", "instructions", "--language", "en", "--level", "exact"],
    ["split", "timed", "-n", "3", "train=0.8", "test=0.2"],
    ["split", "timed", "-n", "3", "--hold-out", "pour", "--count", "2", "-o", "parts"],
    ["stats", "timed", "-n", "3", "--format", "json"],
    ["stats", "closed", "-n", "3", "--by", "plan", "--weight", "look>move=1/3"],
    ["explain", "closed", "look(a)", "move(a,left,right)"],
    ["export", "closed", "-n", "2"],
    ["check", "scene", "--settings", "closed/domain.toml"],
    ["check", "closed", "--rule", "at_most(move,2)", "--strict"],
    ["generate", "closed", "-n", "2", "--no-physics", "--tasks", "2", "--split", "a=1/2,b=1/2", "-o", "data"],
    ["generate", "timed", "-n", "1..2", "--no-physics", "--tasks", "2", "--max-draws", "9", "-o", "data"],
    ["verify", "closed"],
    ["domains"],
    ["new", "fresh"],
    ["completion", "bash"],
    ["learn", "scene", "-n", "1", "--count", "0"],
    ["render", "tasks.jsonl", "1", "--as", "state", "--state", "1", "--size", "16x16", "-o", "one.png"],
    ["validate", "tasks.jsonl", "--witness-only", "--where", "uses cube"],
]
WORDS = [
    "",
    " ",
    "-",
    "--",
    "-n",
    "--length",
    "--help",
    "--where",
    "--nope",
    "-5",
    "1..",
    "3..1",
    "1..2..3",
    "a=b",
    "=",
    "grasp",
    "uses ghost",
    "avoids a",
    "begins look",
    "ends seen(a)",
    "achieves seen(a)",
    "starts at(a,left)",
    "nontrivial",
    "loop-free",
    "matches look move*",
    "matches ((",
    "matches .*.*.*look",
    "after 3: seen(a)",
    "has at least 99999999999 move",
    "has no",
    "not",
    "and or not",
    "move(a",
    "f(" * 3000,
    "f(" * 400 + "a" + ")" * 400,
    "(" * 2000,
    "x" * 3000,
    "move>",
    ">",
    "1/0",
    "-1/3",
    "inf",
    "0",
    "/dev/null",
    "/nowhere/x",
    "..",
    ".",
    "closed",
    "closed/domain.toml",
    "tasks.jsonl",
    "/etc/passwd",
    "%s{}",
    "{0.__class__}",
    "*",
    "~",
    "$HOME",
    *CONTROLS[:2],
    *CONTROLS[3:],
]


def command_line(chance: Random, number: int) -> Mutant:
    """Change the words of a command line."""
    words = [*chance.choice(LINES)]
    for _ in range(chance.choice([1, 1, 2, 3])):
        at = chance.randrange(len(words))
        match chance.randrange(6):
            case 0:
                del words[at : at + 1]
                words = words or ["count"]
            case 1:
                words[at] = chance.choice([*WORDS, *NUMBERS])
            case 2:
                words.insert(at, chance.choice([*WORDS, *chance.choice(LINES)]))
            case 3:
                other = chance.choice(LINES)
                words += other[chance.randrange(1, len(other)) :] if len(other) > 1 else other
            case 4:
                words[at], words[-1] = words[-1], words[at]
            case _:
                words[at] = changed(words[at], chance, [*WORDS, *CHARACTERS, *NUMBERS], 2)
    words = [word.replace("\0", "") for word in words]
    files = {**files_of(SEEDS / "closed", "closed"), **files_of(SEEDS / "timed", "timed")}
    files |= {**files_of(SEEDS / "scene", "scene"), "tasks.jsonl": (SEEDS / "tasks.jsonl").read_bytes()}
    # Whether there is output depends on the options, and a file in place of stdout is none.
    return Mutant("command", number, files, (tuple(words),), given=files["closed/domain.lp"], owes_output=False)

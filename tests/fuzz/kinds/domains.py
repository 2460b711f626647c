"""Mutants of domains: of the logic by tokens, of the settings by types."""

from __future__ import annotations

from pathlib import Path
from random import Random
from typing import Any

from prag_asp.program.paths import shipped_domains
from tests.fuzz.kinds.texts import CHARACTERS, NUMBERS, SEEDS, broken, changed, exchanged
from tests.fuzz.mutant import Command, Mutant
from tests.toml import tomllib

NAME = "own"
"""The folder of the domain in that of a mutant."""

LOGIC, SETTINGS = f"{NAME}/domain.lp", f"{NAME}/domain.toml"

STATEMENTS = [
    "not ",
    "%*",
    "*%",
    "#program step(t).",
    "#program check(t).",
    "#program step(k).",
    "#program base.",
    "#show.",
    "#show p/1.",
    "#const n = 3.",
    "#const capacity = 99999999999.",
    '#include "domain.lp".',
    '#include "../outside/secret.lp".',
    '#include "/etc/passwd".',
    "#include <incmode>.",
    "#external p.",
    "#minimize { 1 : p }.",
    "#script (python) #end.",
    "#script (lua) os.exit(3) #end.",
    "p(@f(1)).",
    "#theory x {}.",
    "&a{}.",
    "#false.",
    ":- .",
    "p :- p.",
    "p :- not p.",
    "{ p; q }.",
    "1 { p; q } 1.",
    "p ; q.",
    "-p.",
    "p(X) :- X = 1..3.",
    "p(1..99).",
    "p(X/0) :- X = 1.",
    "p(2147483647+1).",
    "p(99999999999).",
    'p("a\\"b").',
    'p("\x1b[31m").',
    "p((1,2)).",
    "p(()).",
    "p(#inf).",
    "p(#sup).",
    "p(f(a),g(X)) :- X = a.",
    "#sum { X : p(X) } = 3.",
    ":- #count { X : class(X) } > 9.",
    "class(robot).",
    "entity(robot, robot).",
    "entity(zz, robot).",
    "fluent(f(a)).",
    "fluent(f(b)). fluent(f(c)).",
    "action(nothing).",
    "exclusive(F,G) :- fluent(F), fluent(G), F < G.",
    "implies(F,G) :- fluent(F), fluent(G).",
    "impossible(F,G) :- fluent(F), fluent(G), F < G.",
    "goal(F,true) :- fluent(F).",
    "goal(F,false) :- fluent(F).",
    "initially(F,true) :- fluent(F).",
    "initially(F,false) :- fluent(F).",
    "initially(F,unknown) :- fluent(F).",
    "postcondition(A,F,unknown) :- action(A), fluent(F).",
    "precondition(A,F,true) :- action(A), fluent(F).",
    "postcondition(A,F,V) :- action(A), fluent(F), V = (true;false).",
    "composite(c(A)) :- action(A). stage(c(A),1,A) :- action(A).",
    "free(A) :- action(A).",
    "composite(c). stage(c,1,c).",
    "class(a,b). class(b,a).",
    "at_most(look,1).",
    "action(A) :- fluent(A).",
    "entity(1..9, robot).",
    "#program step(t). :- occurs(A,t), occurs(A,t-1).",
    "#program step(t). seen(A,t) :- occurs(A,t). seen(A,t) :- seen(A,t-1).",
    "#program step(t). n(N+1,t) :- n(N,t-1).",
    "#program step(t). :- holds(F,true,t), holds(F,true,t-2).",
    "#program step(t). { coin(t) }.",
    "#program step(t). a(t) :- not b(t). b(t) :- not a(t).",
    "n(0). n(X+1) :- n(X), X < 50.",
    "#program check(t). :- holds(F,true,t), fluent(F).",
    "occurs(look(a),1).",
    "holds(F,true,0) :- fluent(F).",
    "t",
    "-1",
    "true",
    "unknown",
    "..",
    "#inf",
    "#sum{",
    "&a{}",
    "(1;2)",
    "occurs(A,t)",
    "holds(F,V,t-1)",
    "f(" * 30 + "a" + ")" * 30 + ".",
    "x" * 3000,
    "p" + "," * 20,
    "% lint: allow unused",
    "% lint: allow all",
]
COUNTS = tuple(
    ("count", NAME, "--length", length, "--by", by, "--no-cache")
    for by in ("task", "plan", "skeleton")
    for length in ("0", "1", "2")
)


def files_of(folder: Path, name: str = NAME) -> dict[str, bytes]:
    """Return the files of a domain, however deep, as those of a folder of a mutant."""
    found = (path for path in sorted(folder.rglob("*")) if path.is_file() and path.name != "counts.toml")
    return {f"{name}/{path.relative_to(folder)}": path.read_bytes() for path in found}


def any_domain(chance: Random, *, scene: bool = False) -> dict[str, bytes]:
    """Return the files of a domain, mostly of a small one."""
    shipped = shipped_domains()
    small = [SEEDS / name for name in (("scene",) if scene else ("closed", "timed", "closed", "timed", "scene"))]
    large = [shipped[name] for name in (("tabletop", "kitchen") if scene else ("blocks", "hanoi", "prag", "tabletop"))]
    return files_of(chance.choice(small if chance.random() < 0.8 else large))


def logic(chance: Random, number: int) -> Mutant:
    """Change the logic of a domain; where it is accepted, the engines count the same."""
    files = any_domain(chance)
    text = files[LOGIC].decode()
    way = chance.random()
    if way < 0.5:
        lines = text.split("\n")
        for _ in range(chance.choice([1, 1, 2])):
            lines.insert(chance.randrange(len(lines)), _statement(text, chance))
        content = "\n".join(lines).encode()
    elif way < 0.95:
        content = changed(text, chance, [*STATEMENTS, *CHARACTERS, *NUMBERS], chance.choice([1, 2, 4])).encode()
    else:
        content = broken(text.encode(), chance)
    files[LOGIC] = content
    return Mutant("logic", number, files, (("check", NAME), *_counts(chance)), placed=True)


def _statement(text: str, chance: Random) -> str:
    """Return a statement that refers to what a domain has."""
    if chance.random() < 0.5:
        return chance.choice([each for each in STATEMENTS if each.endswith(".")])
    lines = [line for line in text.split("\n") if line.endswith(".") and not line.startswith(("%", "#"))]
    line = chance.choice(lines)
    edits = [
        ("true", "false"),
        ("false", "true"),
        ("true", "unknown"),
        ("precondition", "postcondition"),
        (" < ", " != "),
        ("postcondition", "precondition"),
        ("exclusive", "implies"),
        ("implies", "exclusive"),
        ("initially", "goal"),
        ("exclusive", "impossible"),
        ("goal", "initially"),
        (", t)", ", t-1)"),
        (", t-1)", ", t)"),
        ("not ", ""),
        (":- ", ":- not "),
    ]
    old, new = chance.choice([each for each in edits if each[0] in line] or [(".", ".")])
    return line.replace(old, new)


def _counts(chance: Random) -> tuple[Command, ...]:
    """Return the same count by three engines."""
    count = (*chance.choice(COUNTS), *(["--flat"] if chance.random() < 0.1 else []))
    return tuple((*count, "--engine", engine) for engine in ("automaton", "clingo", "sat"))


def settings(chance: Random, number: int) -> Mutant:
    """Change the settings of a domain by their types, or by tokens."""
    files = any_domain(chance, scene=chance.random() < 0.7)
    text = files.get(SETTINGS, b'title = "None"\n').decode()
    if chance.random() < 0.7:
        table = tomllib.loads(text)
        for _ in range(chance.choice([1, 1, 1, 2, 3])):
            table = exchanged(table, chance)
        content = written(table).encode("utf-8", "surrogatepass")
    else:
        strange = [
            "[scene]",
            "[[weights]]",
            "[a.b.c]",
            "= nan",
            "'''",
            '"""',
            "= {}",
            "= []",
            "1979-05-27",
            *CHARACTERS,
            *NUMBERS,
        ]
        content = changed(text, chance, strange).encode()
    files[SETTINGS] = content
    then: tuple[Command, ...] = ()
    if chance.random() < 0.3:
        then = (("sample", NAME, "-n", "1", "--count", "1", "--no-physics", "--format", "instructions"),)
    return Mutant("settings", number, files, (("check", NAME), *then), placed=True, owes_output=not then)


def written(table: Any) -> str:
    """Return a table as TOML, those on its first two levels with headers."""
    if not isinstance(table, dict):
        return f"value = {_value(table)}\n"
    return "".join(_section(table, ()))


def _section(table: dict[str, Any], path: tuple[str, ...]) -> list[str]:
    lines = [f"[{'.'.join(map(_key, path))}]\n"] if path else []
    inner = {key: value for key, value in table.items() if isinstance(value, dict) and len(path) < 2}
    lines += [f"{_key(key)} = {_value(value)}\n" for key, value in table.items() if key not in inner]
    for key, value in inner.items():
        lines += _section(value, (*path, key))
    return lines


def _key(key: str) -> str:
    return key if key and all(c.isascii() and (c.isalnum() or c in "_-") for c in key) else _string(key)


def _string(text: str) -> str:
    escaped = "".join(c if c.isprintable() and c not in '"\\' else f"\\u{ord(c):04x}" for c in text)
    return f'"{escaped}"'


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, (int, float)):
        return repr(value)
    if isinstance(value, str):
        return _string(value)
    if isinstance(value, list):
        return f"[{', '.join(map(_value, value))}]"
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{_key(key)} = {_value(each)}" for key, each in value.items()) + " }"
    return "1979-05-27T07:32:00Z"

"""Read the BDDL of LIBERO, LIBERO-PRO and BEHAVIOR-1K.

The grammars are those of https://github.com/Lifelong-Robot-Learning/LIBERO, ``libero/envs/bddl_utils.py``, and of
https://github.com/StanfordVL/bddl, ``bddl/parsing.py``: nested lists in upper or lower case, with sections in any
order, and classes after a ``-``. Variables, and in BEHAVIOR also objects, may begin with ``?``.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from prag_asp.bddl.bddl_problem import (
    TRUE,
    BddlFact,
    BddlFormula,
    BddlProblem,
    Connective,
    Quantifier,
    Rectangle,
    Region,
)
from prag_asp.errors import DomainError
from prag_asp.pddl.syntax.expressions import Expression, Word, parse_expressions
from prag_asp.program.sources import read_text
from prag_asp.wording import did_you_mean, plural

BDDL = ".bddl"
"""The extension of BDDL files."""

PARTS = {"and": (0, None), "or": (0, None), "not": (1, 1), "imply": (2, 2)}
"""The connectives, each with its smallest and its largest number of parts."""

QUANTIFIERS = {"forall": False, "exists": False, "forn": True, "forpairs": False, "fornpairs": True}
"""The quantifiers, each with a flag that is true if a number precedes the variables."""

PAIRS = ("forpairs", "fornpairs")
"""The quantifiers over two lists of variables."""

SECTIONS = (
    ":domain", ":language", ":regions", ":fixtures", ":objects", ":obj_of_interest", ":init", ":goal",
    ":requirements", ":scene_properties",
)  # fmt: skip
IGNORED = (":requirements", ":scene_properties")
REGION_KEYS = (":target", ":ranges", ":yaw_rotation", ":rgba")

PI = re.compile(r"(?P<sign>[-+]?)(?:(?P<times>[0-9.]+)\*)?(?:np\.|math\.)?pi(?:(?P<by>[*/])(?P<number>[0-9.]+))?")
"""The pattern of a multiple of pi, because LIBERO evaluates a yaw as a Python expression."""

DOMAIN_FILE = re.compile(rb"(?:\s|;[^\n]*\n)*\(\s*define\s*\(\s*domain\b", re.IGNORECASE)
"""The beginning of a file that is not a problem but declares the predicates of a dialect."""

LONGEST_HEAD = 10_000
"""The number of bytes in which the beginning of a domain is searched for, after comments."""

Item = Expression | Word


def bddl_files(folder: Path) -> list[Path]:
    """Return the BDDL files in a folder and its subfolders, except files that define domains."""
    files = sorted(folder.rglob(f"*{BDDL}"))
    return [each for each in files if not DOMAIN_FILE.match(each.read_bytes()[:LONGEST_HEAD])]


def read_bddl(path: str | Path) -> BddlProblem:
    """Read a problem from a BDDL file.

    Raises:
        DomainError: the file cannot be read or is not a BDDL problem; the message gives the line.
    """
    path = Path(path)
    return parse_bddl(read_text(path), path)


def parse_bddl(text: str, path: str | Path = "<bddl>") -> BddlProblem:
    """Return the problem that a BDDL text describes; messages give `path` as its file.

    Raises:
        DomainError: the text is not a BDDL problem; the message gives the line.
    """
    return _Reading(Path(path)).problem(text)


@dataclass
class _Reading:
    """A reader of one text, which collects remarks on the parts that it ignores."""

    path: Path
    remarks: list[tuple[int, str]] = field(default_factory=list)

    def problem(self, text: str) -> BddlProblem:
        found = parse_expressions(self.path, text, keep_case=True)
        if not found or found[0].head.lower() != "define":
            raise self.error(
                found[0].line if found else 1, "not a problem of BDDL; begin it with (define (problem NAME)"
            )
        if len(found) > 1:
            raise self.error(found[1].line, "this list follows the problem; look for an extra ')' before it")
        name, sections = self.sections(found[0])
        parsers: Mapping[str, Callable[[Expression], object]] = {
            ":objects": lambda each: self.typed(each, "object"),
            ":fixtures": lambda each: self.typed(each, "fixture"),
            ":regions": self.regions,
            ":obj_of_interest": lambda each: tuple(map(self.name, each.rest)),
            ":init": self.initial,
            ":goal": self.goal,
            ":domain": lambda each: " ".join(map(self.name, each.rest)),
            ":language": lambda each: _sentence(each.rest),
        }
        fields = {":obj_of_interest": "interest", ":init": "initial"}
        values = {
            fields.get(head, head[1:]): parsers[head](section)
            for head, section in sections.items()
            if head not in IGNORED
        }
        return BddlProblem(name, **{"domain": "", **values}, remarks=tuple(self.remarks))  # type: ignore[arg-type]

    def sections(self, whole: Expression) -> tuple[str, dict[str, Expression]]:
        """Return the name of the problem, and its sections by their heads."""
        name, sections = "", dict[str, Expression]()
        for each in whole.rest:
            if isinstance(each, Word):
                raise self.error(each.line, f"{str(each)!r} is not expected here; look for a missing '(' before it")
            head = each.head.lower()
            if head == "problem":
                name = " ".join(map(self.name, each.rest))
            elif head == "domain":
                raise self.error(each.line, "this is a domain; give its problems, which begin with (define (problem")
            elif head in sections:
                raise self.error(
                    each.line, f"a second ({head} ...); merge it with the one in line {sections[head].line}"
                )
            elif head in SECTIONS:
                sections[head] = each
            else:
                hint = did_you_mean(head, SECTIONS, "remove it")
                self.remarks.append((each.line, f"({head or '('} ...) is not a section of BDDL and is ignored; {hint}"))
        if not name:
            raise self.error(whole.line, "the problem has no name; write (define (problem NAME)")
        if ":goal" not in sections:
            raise self.error(whole.end, "the problem has no (:goal ...); add it")
        return name, sections

    def typed(self, section: Expression, kind: str) -> dict[str, str]:
        """Return the classes of names; names without a class belong to the class `kind`."""
        classes, open_names, seen = dict[str, str](), list[Word](), dict[str, int]()
        words = [self.word(each) for each in section.rest]
        position = 0
        while position < len(words):
            word = words[position]
            if word != "-":
                open_names.append(word)
                position += 1
                continue
            if position + 1 == len(words) or words[position + 1] == "-":
                raise self.error(word.line, "no class follows this '-'; write NAMES - CLASS")
            if not open_names:
                raise self.error(word.line, "no name stands before this '-'; write NAMES - CLASS")
            of_class = self.name(words[position + 1])
            if of_class in seen:
                note = f"class {of_class} is listed again after line {seen[of_class]}; LIBERO reads only the last list"
                self.remarks.append((word.line, f"{note}; merge them"))
            seen[of_class] = word.line
            self.declare(classes, open_names, of_class)
            open_names.clear()
            position += 2
        self.declare(classes, open_names, kind)
        return classes

    def declare(self, classes: dict[str, str], names: Sequence[Word], of_class: str) -> None:
        """Add names that belong to a class; a name may be repeated with the same class."""
        for each in names:
            name = self.name(each)
            if classes.setdefault(name, of_class) != of_class:
                raise self.error(
                    each.line, f"{name} is of class {of_class} here, but of {classes[name]} before; keep one"
                )

    def regions(self, section: Expression) -> tuple[Region, ...]:
        return tuple(map(self.region, map(self.list, section.rest)))

    def region(self, item: Expression) -> Region:
        """Return one region, such as ``(cook_region (:target flat_stove_1))``."""
        target, ranges, yaw = "", tuple[Rectangle, ...](), None
        if not item.head:
            raise self.error(item.line, "a region has no name; write (NAME (:target FIXTURE) ...)")
        for attribute in map(self.list, item.rest):
            key = attribute.head.lower()
            if key not in REGION_KEYS:
                hint = did_you_mean(key, REGION_KEYS)
                self.remarks.append((attribute.line, f"({key} ...) of a region is ignored; {hint}"))
            elif key == ":target" and len(attribute.rest) == 1:
                target = self.name(attribute.rest[0])
            elif key == ":target":
                raise self.error(attribute.line, "a region has one target; write (:target FIXTURE)")
            elif key == ":ranges":
                rows = [row for each in attribute.rest for row in self.rows(each)]
                ranges = tuple(self.rectangle(each) for each in rows)
            elif key == ":yaw_rotation":
                for row in (row for each in attribute.rest for row in self.rows(each)):
                    low, *rest = [self.number(each) for each in row.parts] or [0.0]
                    yaw = (low, rest[-1] if rest else low)
        if not target:
            raise self.error(item.line, f"region {item.head} has no target; add (:target FIXTURE)")
        return Region(self.name(item.head), target, ranges, yaw, item.line)

    def rows(self, item: Item) -> list[Expression]:
        """Return the rows of numbers in a list of rows; a single row need not be enclosed in a list."""
        whole = self.list(item)
        return (
            [whole]
            if any(isinstance(each, Word) for each in whole.parts)
            else [self.list(each) for each in whole.parts]
        )

    def rectangle(self, row: Expression) -> Rectangle:
        numbers = [self.number(each) for each in row.parts]
        if len(numbers) != 4:
            raise self.error(
                row.line, f"a range has {plural(len(numbers), 'number')}; write (X Y X Y), its two corners"
            )
        low_x, low_y, high_x, high_y = numbers
        return low_x, low_y, high_x, high_y

    def number(self, item: Item) -> float:
        word = self.word(item)
        try:
            value = float(word)
        except ValueError:
            match = PI.fullmatch(word.lower())
            if match is None:
                raise self.error(word.line, f"{str(word)!r} is not a number; write it in decimals") from None
            value = math.pi * float(match["times"] or 1)
            factor = float(match["number"] or 1)
            value = -value if match["sign"] == "-" else value
            value = value / factor if match["by"] == "/" and factor else value * factor
        if not math.isfinite(value):
            raise self.error(word.line, f"{str(word)!r} is not a finite number; write it in decimals")
        return value

    def initial(self, section: Expression) -> tuple[tuple[BddlFact, bool], ...]:
        literals: list[tuple[BddlFact, bool]] = []
        for each in map(self.list, section.rest):
            formula = self.formula(each, {})
            whole = formula.parts if isinstance(formula, Connective) and formula.kind == "and" else (formula,)
            for part in whole:
                positive = not (isinstance(part, Connective) and part.kind == "not")
                fact = part.parts[0] if isinstance(part, Connective) and not positive else part
                if not isinstance(fact, BddlFact):
                    raise self.error(each.line, "the initial state has facts and (not FACT) only; write one of them")
                literals.append((fact, positive))
        return tuple(literals)

    def goal(self, section: Expression) -> BddlFormula:
        """Return the goal; several lists form a conjunction, as does a list of lists."""
        parts = [self.formula(self.list(each), {}) for each in section.rest]
        return TRUE if not parts else parts[0] if len(parts) == 1 else Connective("and", tuple(parts))

    def formula(self, item: Expression, scope: Mapping[str, str]) -> BddlFormula:
        """Return a formula; `scope` are the variables of the quantifiers around it, with their classes."""
        kind = item.head.lower()
        if not item.parts:
            return TRUE
        if not kind:
            return Connective("and", tuple(self.formula(self.list(each), scope) for each in item.parts))
        if kind in QUANTIFIERS:
            return self.quantifier(item, kind, scope)
        if kind not in PARTS:
            return BddlFact(kind, tuple(self.term(each, scope) for each in item.rest), item.line)
        least, most = PARTS[kind]
        if len(item.rest) < least or (most is not None and len(item.rest) > most):
            raise self.error(item.line, f"({kind} ...) has {plural(len(item.rest), 'part')}, not {least}")
        return Connective(kind, tuple(self.formula(self.list(each), scope) for each in item.rest))

    def quantifier(self, item: Expression, kind: str, scope: Mapping[str, str]) -> Quantifier:
        parts, number = list(item.rest), None
        needed = 1 + QUANTIFIERS[kind] + (2 if kind in PAIRS else 1)
        if len(parts) != needed:
            number_text = "(N) " if QUANTIFIERS[kind] else ""
            lists = "(?X - CLASS) (?Y - CLASS)" if kind in PAIRS else "(?X - CLASS)"
            raise self.error(
                item.line, f"({kind} ...) has {plural(len(parts), 'part')}; write ({kind} {number_text}{lists} FORMULA)"
            )
        if QUANTIFIERS[kind]:
            number = self.whole_number(parts.pop(0))
        variables: list[tuple[str, str]] = []
        for each in parts[:-1]:
            typed = self.typed(Expression((Word("", item.line), *self.list(each).parts), item.line, item.end), "object")
            variables += ((name.lstrip("?"), of_class) for name, of_class in typed.items())
        if not variables or (kind in PAIRS and len(variables) != 2):
            raise self.error(item.line, f"({kind} ...) has {plural(len(variables), 'variable')}; write ?X - CLASS")
        part = self.formula(self.list(parts[-1]), {**scope, **dict(variables)})
        return Quantifier(kind, tuple(variables), part, number)

    def whole_number(self, item: Item) -> int:
        """Return a number, which may be in parentheses."""
        words = [item] if isinstance(item, Word) else list(item.all_words)
        if len(words) != 1 or not re.fullmatch(r"[0-9]{1,6}", words[0]):
            raise self.error(item.line, "a number of objects is needed here; write it as (2)")
        return int(words[0])

    def term(self, item: Item, scope: Mapping[str, str]) -> str:
        """Return a term: ``?`` and the name of a variable in scope, or the name of an object."""
        name = self.name(item).lstrip("?")
        return f"?{name}" if name in scope else name

    def name(self, item: Item) -> str:
        return self.word(item).lower()

    def word(self, item: Item) -> Word:
        if not isinstance(item, Word):
            raise self.error(item.line, "a list is not expected here; look for a misplaced parenthesis before it")
        return item

    def list(self, item: Item) -> Expression:
        if isinstance(item, Word):
            raise self.error(item.line, f"{str(item)!r} is not expected here; look for a missing '(' before it")
        return item

    def error(self, line: int, problem: str) -> DomainError:
        return DomainError(f"{self.path}:{line}: {problem}")


def _sentence(items: Sequence[Item]) -> str:
    """Return the words of a sentence without its parentheses, separated by single blanks."""
    words = [str(word) for item in items for word in ([item] if isinstance(item, Word) else item.all_words)]
    return re.sub(r" \?(?=\s|$)", "?", " ".join(words))

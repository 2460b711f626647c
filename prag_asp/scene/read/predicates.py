"""Read ``[scene.own]``, the spatial predicates that a domain adds, and collect everything that is wrong with them.

[scene.own.in_corner]           # of boxes around the second argument: metres, in its axes, heights from its bottom
arguments = ["object", "object"]
boxes = [{ x = [0.05, 0.12], y = [0.03, 0.10] }]
sentence = "{0} {is} in the corner of {1}"

[scene.own.faces]               # or in Python
arguments = ["object", "object"]
python = "predicates.py"
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from string import Formatter
from typing import Any

from prag_asp.safe_reading import is_inside
from prag_asp.scene.predicate_names import PREDICATE_ROLES
from prag_asp.scene.read.report import Report, is_number
from prag_asp.scene.scene import IGNORED, Bounds, Own
from prag_asp.wording import did_you_mean

ROLES = tuple(dict.fromkeys(role for roles in PREDICATE_ROLES.values() for role in roles))
"""What an argument of a spatial predicate can be."""

BOX_KEYS = ("arguments", "boxes", "inside", "around", "sentence")
PYTHON_KEYS = ("arguments", "python")
INSIDE = ("centre", "whole")
AXES = ("x", "y", "z")
PAIR = 2
NAME = re.compile(r"[a-z]\w*")
EXAMPLE = '"{0} {is} in the corner of {1}"'
ENDLESS = (-math.inf, math.inf)


def read_own(report: Report, value: object) -> dict[str, Own]:
    """Return the predicates of a ``[scene.own]`` table by their names, those with mistakes left out."""
    return _OwnReader(report).read(value)


class _OwnReader:
    """Reads a ``[scene.own]`` table, and reports what is wrong with it instead of stopping."""

    def __init__(self, report: Report) -> None:
        self.report = report
        self.add = report.add

    def read(self, value: object) -> dict[str, Own]:
        """Return the predicates by their names, those with mistakes left out."""
        if not isinstance(value, Mapping):
            self.add("scene.own", f"needs a table for each predicate, such as [scene.own.in_corner]; got {value!r}")
            return {}
        found = {}
        for name, table in value.items():
            before = len(self.report.problems)
            own = self.predicate(f"scene.own.{name}", name, table)
            if own is not None and len(self.report.problems) == before:
                found[name] = own
            else:
                self.report.doubtful.add(name)
        return found

    def predicate(self, key: str, name: str, table: object) -> Own | None:
        """Return one predicate; where something is wrong with it, a problem has been added."""
        if not isinstance(table, Mapping):
            self.add(key, f"needs a table with arguments, and boxes or python; got {table!r}")
            return None
        if name in PREDICATE_ROLES or name == IGNORED:
            self.add(key, f"{name} is there already; choose another name")
        elif not NAME.fullmatch(name):
            self.add(key, "is no name of a fluent; begin with a small letter, go on with letters, digits and _")
        if ("python" in table) == ("boxes" in table):
            which = "boxes and python" if "python" in table else "neither boxes nor python"
            self.add(key, f"has {which}; define it by one of them")
            return None
        known = PYTHON_KEYS if "python" in table else BOX_KEYS
        self.report.unknown(key, table, known)
        roles = self.roles(f"{key}.arguments", table.get("arguments"), ROLES)
        if "python" in table:
            return Own(name, roles, file=self.file(f"{key}.python", table["python"]))
        return self.composed(key, name, table, roles)

    def roles(self, key: str, value: object, known: tuple[str, ...]) -> tuple[str, ...]:
        """Return what the arguments of a predicate have to be."""
        if isinstance(value, list) and value and all(role in known for role in value):
            return tuple(value)
        self.add(key, f'needs a list of {", ".join(known)}, such as ["object", "object"]; got {value!r}')
        return ()

    def composed(self, key: str, name: str, table: Mapping[str, Any], roles: tuple[str, ...]) -> Own:
        """Return a predicate made of boxes."""
        around = table.get("around")
        if roles and set(roles) != {"object"}:
            self.add(f"{key}.arguments", f"of boxes can only be objects; got {', '.join(roles)}")
        elif around is None and len(roles) not in (0, PAIR):
            text = (
                "need two objects, the second with the boxes around it; or one, and `around`, the entity of the boxes"
            )
            self.add(f"{key}.arguments", text)
        elif around is not None and len(roles) != 1:
            self.add(f"{key}.around", "stands in for a second argument; give it one object as its arguments")
        elif around is not None and str(around) not in self.report.entities:
            self.add(f"{key}.around", f"unknown entity; {did_you_mean(str(around), self.report.entities)}")
        inside = table.get("inside", INSIDE[0])
        if inside not in INSIDE:
            self.add(f"{key}.inside", f"needs one of {', '.join(INSIDE)} (what is in a box); got {inside!r}")
        return Own(
            name,
            roles,
            boxes=self.boxes(f"{key}.boxes", table["boxes"]),
            whole=inside == "whole",
            around=None if around is None else str(around),
            sentence=self.sentence(f"{key}.sentence", table.get("sentence")),
        )

    def boxes(self, key: str, value: object) -> tuple[Bounds, ...]:
        """Return the boxes of a predicate, at least one."""
        if not isinstance(value, list) or not value:
            self.add(key, f"needs a list of boxes like {{ x = [0.05, 0.12], z = [0, 0.1] }}; got {value!r}")
            return ()
        return tuple(self.box(f"{key}.{i}", box) for i, box in enumerate(value, 1))

    def box(self, key: str, value: object) -> Bounds:
        """Return a box; along an axis that it does not name nothing bounds it."""
        if not isinstance(value, Mapping) or not value:
            self.add(key, f"needs a table like {{ x = [0.05, 0.12], y = [0, 0.1] }}; got {value!r}")
            return Bounds((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
        for name in value:
            if name not in AXES:
                self.add(f"{key}.{name}", f"unknown key; {did_you_mean(name, AXES)}")
        ends = [self.ends(f"{key}.{axis}", value.get(axis, list(ENDLESS))) for axis in AXES]
        (ax, bx), (ay, by), (az, bz) = ends
        return Bounds((ax, ay, az), (bx, by, bz))

    def ends(self, key: str, value: object) -> tuple[float, float]:
        """Return the low and the high end of a box along an axis in metres."""
        if isinstance(value, list) and len(value) == PAIR and all(map(_is_length, value)):
            low, high = map(float, value)
            if low < high and low < math.inf and high > -math.inf:
                return low, high
        self.add(key, f"needs a low and a high end in metres; got {value!r}")
        return ENDLESS

    def sentence(self, key: str, value: object) -> str:
        """Return the template of a sentence: {0}, {1} and {is}, each of the two arguments at most."""
        if isinstance(value, str) and value.strip():
            try:
                fields = [field for _, field, _, _ in Formatter().parse(value) if field is not None]
            except ValueError:
                fields = [""]
            wrong = [field for field in fields if field not in ("0", "1", "is")]
            if wrong:
                self.add(key, f"has braces that name no argument; use {{0}}, {{1}} and {{is}}, as in {EXAMPLE}")
            elif "is" not in fields or "0" not in fields:
                self.add(key, f"needs {{0}}, and {{is}} for is or is not, as in {EXAMPLE}")
            return value
        got = "" if value is None else f"; got {value!r}"
        self.add(key, f"{'missing: write' if value is None else 'needs'} a sentence like {EXAMPLE}{got}")
        return ""

    def file(self, key: str, value: object) -> str:
        """Return the path of a Python file within the folder of the domain."""
        if not isinstance(value, str) or not value.endswith(".py"):
            self.add(key, f'needs the name of a Python file of the domain, such as "predicates.py"; got {value!r}')
        else:
            path = self.report.folder / value
            if not is_inside(path, self.report.folder):
                self.add(key, f"{value} lies outside of the folder of the domain; move it there")
            elif not path.is_file():
                self.add(key, f"{value} is not in the folder of the domain; write it, or mend the name")
            else:
                return str(path.resolve())
        return ""


def _is_length(value: object) -> bool:
    """Tell whether a TOML value is a number, which may be infinite."""
    return is_number(value) or (isinstance(value, float) and math.isinf(value))

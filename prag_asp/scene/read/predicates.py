"""Read ``[scene.own]``: the spatial predicates that a domain adds.

[scene.own.in_corner]           # boxes around the second argument: metres, in its frame, z from its lowest point
arguments = ["object", "object"]
boxes = [{ x = [0.05, 0.12], y = [0.03, 0.10] }]
sentence = "{0} {is} in the corner of {1}"

[scene.own.faces]               # or a Python file
arguments = ["object", "object"]
python = "predicates.py"
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from pathlib import Path
from string import Formatter

from prag_asp.safe_reading import is_inside
from prag_asp.scene.predicate_names import PREDICATE_ROLES
from prag_asp.scene.read.scene_values import DomainNames
from prag_asp.scene.scene import IGNORED, BoxBounds, Own
from prag_asp.tables.report import TableEntry, is_number

ROLES = tuple(dict.fromkeys(role for roles in PREDICATE_ROLES.values() for role in roles))
"""The roles that an argument of a spatial predicate may have."""

BOX_KEYS = ("arguments", "boxes", "inside", "around", "sentence")
PYTHON_KEYS = ("arguments", "python")
INSIDE = ("centre", "whole")
AXES = ("x", "y", "z")
NAME = re.compile(r"[a-z]\w*")
EXAMPLE = '"{0} {is} in the corner of {1}"'


def read_own(section: TableEntry, names: DomainNames) -> dict[str, Own]:
    """Return the valid predicates of a ``[scene.own]`` table by name."""
    if not section.is_table("for each predicate, such as [scene.own.in_corner]"):
        return {}
    predicates = {}
    for name, entry in section.entries():
        own = _predicate(entry, name, names)
        if own is not None and entry.is_sound:
            predicates[name] = own
        else:
            section.report.doubtful.add(name)
    return predicates


def _predicate(entry: TableEntry, name: str, names: DomainNames) -> Own | None:
    """Return a predicate, or None if the table does not make clear how it is defined."""
    if not entry.is_table("with arguments, and boxes or python"):
        return None
    if name in PREDICATE_ROLES or name == IGNORED:
        entry.add(f"{name} already exists; choose another name")
    elif not NAME.fullmatch(name):
        entry.add("is not a valid name of a fluent; use a lower-case letter, then letters, digits and _")
    by_python = "python" in entry.value
    if by_python == ("boxes" in entry.value):
        entry.add(f"has {'boxes and python' if by_python else 'neither boxes nor python'}; give one of the two")
        return None
    entry.require_known(PYTHON_KEYS if by_python else BOX_KEYS)
    roles, value = (), entry.at("arguments").value
    if isinstance(value, list) and value and all(role in ROLES for role in value):
        roles = tuple(value)
    else:
        entry.at("arguments").needs(f'a list of {", ".join(ROLES)}, such as ["object", "object"]')
    if by_python:
        return Own(name, roles, file=_file(entry.at("python"), names.folder))
    return _composed(entry, name, roles, names)


def _composed(entry: TableEntry, name: str, roles: tuple[str, ...], names: DomainNames) -> Own:
    """Return a predicate defined by boxes."""
    arguments, around = entry.at("arguments"), entry.at("around")
    if roles and set(roles) != {"object"}:
        arguments.add(f"are {', '.join(roles)}, but a predicate of boxes takes only objects; define it in Python")
    elif around.missing and len(roles) not in (0, 2):
        arguments.needs(
            "two objects, the second with the boxes around it; or one, and `around`, the entity of the boxes"
        )
    elif not around.missing and len(roles) != 1:
        around.add('replaces the second argument; write arguments = ["object"]')
    elif not around.missing:
        names.has_entity(around, str(around.value))
    boxes = entry.at("boxes")
    if not isinstance(boxes.value, list) or not boxes.value:
        boxes.needs("a list of boxes like { x = [0.05, 0.12], z = [0, 0.1] }")
    return Own(
        name,
        roles,
        boxes=tuple(map(_box, boxes.items())),
        whole=entry.at("inside", INSIDE[0]).choice(INSIDE, "what is in a box") == "whole",
        around=None if around.missing else str(around.value),
        sentence=_sentence(entry.at("sentence")),
    )


def _box(entry: TableEntry) -> BoxBounds:
    """Return a box; it is unbounded along each axis that its table omits, and its ends may be infinite."""
    if not isinstance(entry.value, Mapping) or not entry.value:
        entry.needs("a table like { x = [0.05, 0.12], y = [0, 0.1] }")
        return BoxBounds((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    entry.require_known(AXES)
    bounds = []
    for axis in AXES:
        ends = entry.at(axis, [-math.inf, math.inf])
        value = ends.value if isinstance(ends.value, list) and len(ends.value) == 2 else [0.0, 0.0]
        low, high = value if all(is_number(each) or each in (-math.inf, math.inf) for each in value) else (0.0, 0.0)
        if not low < high:
            ends.needs("a low and a high end in metres")
        bounds.append((float(low), float(high)))
    (ax, bx), (ay, by), (az, bz) = bounds
    return BoxBounds((ax, ay, az), (bx, by, bz))


def _sentence(entry: TableEntry) -> str:
    """Return the template of a sentence, with {0}, {1} and {is}."""
    if not isinstance(entry.value, str) or not entry.value.strip():
        entry.needs(f"a sentence like {EXAMPLE}")
        return ""
    try:
        fields = [field for _, field, _, _ in Formatter().parse(entry.value) if field is not None]
    except ValueError:
        fields = [""]
    if not {"0", "1", "is"}.issuperset(fields):
        entry.add(f"has braces that name no argument; use {{0}}, {{1}} and {{is}}, as in {EXAMPLE}")
    elif "is" not in fields or "0" not in fields:
        entry.add(f"lacks {{0}} or {{is}}, which becomes is or is not; write both, as in {EXAMPLE}")
    return entry.value


def _file(entry: TableEntry, folder: Path) -> str:
    """Return the path of a Python file inside the folder of the domain."""
    value = entry.value
    if not isinstance(value, str) or not value.endswith(".py"):
        entry.needs('the name of a Python file of the domain, such as "predicates.py"')
    elif not is_inside(folder / value, folder):
        entry.add(f"{value} is outside the folder of the domain; move it there")
    elif not (folder / value).is_file():
        entry.add(f"{value} is not in the folder of the domain; create it, or correct the name")
    else:
        return str((folder / value).resolve())
    return ""

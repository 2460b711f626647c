"""Read the ``[scene]`` table of a domain.

In the file, lengths are metres and angles are degrees.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import replace
from itertools import combinations, islice
from typing import Any

from prag_asp.scene.colours import WHITE, more_colours
from prag_asp.scene.colours import apart as colour_distance
from prag_asp.scene.footprint import TOUCHING, Footprint, apart
from prag_asp.scene.predicate_names import PREDICATE_ROLES
from prag_asp.scene.read.camera_reader import read_cameras
from prag_asp.scene.read.layout import check_places, read_fixed, read_table, read_workspace
from prag_asp.scene.read.predicates import read_own
from prag_asp.scene.read.scene_values import DomainNames, color
from prag_asp.scene.read.shapes import read_shapes
from prag_asp.scene.robots import ROBOTS
from prag_asp.scene.scene import BALANCE, IGNORED, Material, Mount, Own, Ranges, Scene, Shape, TableTop, only_robot
from prag_asp.tables.report import TableEntry, is_number, shown
from prag_asp.wording import did_you_mean

FRAMES = ("robot", "viewer")
SCENE_KEYS = (
    "robot",
    "robots",
    "frame",
    "workspace",
    "table",
    "shapes",
    "materials",
    "colors",
    "fixed",
    "predicates",
    "rotations",
    "own",
    "cameras",
    "vary",
    "balance",
)

FACTORS = (0.05, 20.0)
"""The smallest and the largest factor for friction and for mass; this range covers all materials."""

LARGEST_RANGES: Mapping[str, tuple[float, str]] = {
    "light": (80.0, "degrees"),
    "camera": (0.4, "a share of the distance from the camera to its target"),
    "colour": (60.0, "Delta E in CIELAB"),
}
"""The largest range of each kind, and its unit."""

FARTHEST_BASE = 2.0
"""The largest distance of a robot's base from the origin along x and y, in metres; no table is larger."""

CLOSEST_BASES = 0.4
"""The smallest distance between the bases of two robots, in metres."""

LARGEST_BALANCE = 0.1
"""The largest balance margin in metres, which is more than half the width of most objects."""

MATERIAL_LIMITS: Mapping[str, tuple[float, float, str]] = {
    "density": (1.0, 25000.0, "kilograms per cubic metre"),
    "friction": (0.0, 10.0, "a coefficient"),
    "rolling": (0.0, 0.1, "metres"),
}
"""The smallest and the largest value of each property of a material, and its unit."""

PALETTE = ("#e4572e", "#2e86ab", "#f2b134", "#3a9d5d", "#8e5bb5", "#d64577", "#4bb3b8", "#a0714f")
CONTAINER_COLOR, FURNITURE_COLOR, ROBOT_COLOR = "#b9c4cc", "#b08457", "#edf0f2"
AROUND = (CONTAINER_COLOR, FURNITURE_COLOR, TableTop().color, "#f7f9fc", "#40434a")
"""The colours that surround objects: those of containers, furniture, the table, the sky, and the dark parts of robots.
"""

DISTINCT = 20.0
"""The smallest Delta E in CIELAB at which people can distinguish two colours."""


def read_scene(root: TableEntry, names: DomainNames) -> Scene:
    """Return the scene that a ``[scene]`` table defines; invalid values are reported and replaced by their defaults."""
    report = root.report
    root.require_known(SCENE_KEYS)
    if not isinstance(root.value.get("shapes", {}), Mapping) or (*root.keys, "shapes") in report.misspelt:
        report.doubtful |= set(names.entities)
    own = read_own(root.at("own", {}), names)
    sizes = read_shapes(root.section("shapes"), names)
    shapes = {entity: several[-1] for entity, several in sizes.items()}
    usual = root.at("robot", next(iter(ROBOTS))).choice(tuple(ROBOTS)) or next(iter(ROBOTS))
    arms = {entity: shape for entity, shape in shapes.items() if shape.kind == "robot"}
    robots = _robots(root.section("robots"), shapes, usual)
    top = read_table(root.section("table"))
    fixed = read_fixed(root.section("fixed"), names, shapes)
    materials = _materials(root.section("materials"), names)
    shapes |= _weighed(root.section("shapes"), names, shapes, materials)
    shapes |= _resting(root.section("shapes"), names, shapes, fixed)
    scene = Scene(
        shapes=shapes,
        robots=robots,
        frame=root.at("frame", FRAMES[0]).choice(FRAMES) or FRAMES[0],
        workspace=read_workspace(root.section("workspace")),
        table=top,
        colors=_colors(root.section("colors"), names, shapes, top.color),
        fixed=fixed,
        predicates=_predicates(root.section("predicates"), own),
        rotations=_rotations(root.section("rotations")),
        materials=materials,
        own=own,
        cameras=read_cameras(root.section("cameras"), {**robots, **arms}),
        vary=_ranges(root.section("vary")),
        balance=_balance(root.at("balance", BALANCE)),
        ranges={entity: several for entity, several in sizes.items() if len(several) > 1},
    )
    if not report.problems:
        _check_bodies(root, scene, names)
    return scene


def _check_bodies(root: TableEntry, scene: Scene, names: DomainNames) -> None:
    """Report bodies in impossible places.

    These are bodies larger than the table, fixed bodies that are off the table or overlap each other or a robot, and
    furniture without a place.
    """
    report, shapes, places = root.report, root.section("shapes"), root.section("fixed")
    for entity, shape in scene.shapes.items():
        if shape.traits.furniture and entity not in scene.fixed:
            places.at(entity).needs(f"the place of {entity}, because a {shape.kind} does not move")
    for entity, shape in scene.shapes.items():
        if not shape.traits.body:
            continue
        owner = next(name for name in names.line(entity) if name in shapes.value)
        sides, room = sorted(shape.size[:2]), sorted(scene.table.size)
        if sides[0] > room[0] or sides[1] > room[1]:
            text = f"{sides[1]:g} x {sides[0]:g} m is larger than the table, which is {room[1]:g} x {room[0]:g} m"
            shapes.at(owner).add(f"{text}; make it smaller")
            report.doubtful.add(entity)
    fixed = {entity: place for entity, place in scene.fixed.items() if entity not in report.doubtful}
    check_places(places, scene.table, scene.shapes, fixed)
    check_bases(places, replace(scene, fixed=fixed))


def _balance(entry: TableEntry) -> float:
    """Return the balance margin in metres."""
    margin = entry.number(0.0, LARGEST_BALANCE, "metres")
    return BALANCE if margin is None else margin


def _weighed(
    section: TableEntry, names: DomainNames, shapes: Mapping[str, Shape], materials: Mapping[str, Material]
) -> dict[str, Shape]:
    """Return the shapes, with the density of their material for meshes that have neither a mass nor a density."""
    found = {}
    for entity, shape in shapes.items():
        owner = next(name for name in names.line(entity) if name in section.value)
        own = section.value[owner]
        if shape.model is not None and shape.kind == "mesh" and "mass" not in own and "density" not in own:
            density = materials.get(entity, Material()).density
            found[entity] = shape._replace(model=shape.model.with_mass(shape.model.mass * density))
    return found


def _resting(
    section: TableEntry, names: DomainNames, shapes: Mapping[str, Shape], fixed: Collection[str]
) -> dict[str, Shape]:
    """Return the shapes at rest of the movable bodies that have a model; report bodies that do not come to rest."""
    models = {entity: shape for entity, shape in shapes.items() if shape.model is not None and entity not in fixed}
    if not models:
        return {}
    from prag_asp.scene.read.body import resting  # noqa: PLC0415 - few domains have bodies with a model

    found = {shape: resting(shape) for shape in set(models.values())}
    fallen: dict[str, str] = {}
    for entity, shape in models.items():
        if found[shape] is None:
            fallen.setdefault(next(name for name in names.line(entity) if name in section.value), entity)
    for owner, entity in fallen.items():
        text = f"{entity} does not come to rest: it is round, or its base is too small; widen it, or fix its place"
        section.at(owner).at("path").add(text)
    return {entity: rest for entity, shape in models.items() if (rest := found[shape]) is not None}


def _predicates(section: TableEntry, own: Mapping[str, Own]) -> dict[str, str]:
    """Return the spatial predicate of each fluent name."""
    names = [*PREDICATE_ROLES, *own, IGNORED]
    for _, entry in section.entries():
        if entry.value not in names and str(entry.value) not in section.report.doubtful:
            entry.add(f"unknown spatial predicate {shown(entry.value)}; {did_you_mean(str(entry.value), names)}")
    return {fluent: str(entry.value) for fluent, entry in section.entries()}


def _rotations(section: TableEntry) -> dict[str, float]:
    """Return the yaw of each rotation in radians."""
    rotations = {}
    for name, entry in section.entries():
        if is_number(entry.value):
            rotations[name] = math.radians(entry.value)
        else:
            entry.needs("a yaw in degrees")
    return rotations


def _ranges(section: TableEntry) -> Ranges:
    """Return the ranges of domain randomization; missing ranges have their defaults."""
    usual, (low, high) = Ranges(), FACTORS
    section.require_known(Ranges._fields)
    ranges: dict[str, Any] = {}
    what = f"a low and a high factor from {low:g} to {high:g}, such as [0.8, 1.2]"
    for name in ("friction", "mass"):
        entry = section.at(name, list(getattr(usual, name)))
        pair = entry.numbers(2, what, low, high)
        if pair is not None and pair[0] > pair[1]:
            entry.needs(what)
        ranges[name] = pair or getattr(usual, name)
    for name, (most, unit) in LARGEST_RANGES.items():
        number = section.at(name, getattr(usual, name)).number(0.0, most, unit)
        ranges[name] = getattr(usual, name) if number is None else number
    return Ranges(**ranges)


def _materials(section: TableEntry, names: DomainNames) -> dict[str, Material]:
    """Return the material of each entity whose class or nearest ancestor has one; missing values have defaults."""
    by_class = {}
    for name, entry in section.entries():
        if names.has_class(entry, name):
            usual = by_class[name] = Material()
            if entry.is_table("like { density = 700, friction = 0.5 }", tuple(MATERIAL_LIMITS)):
                numbers = {
                    key: entry.at(key, getattr(usual, key)).number(*limits) for key, limits in MATERIAL_LIMITS.items()
                }
                by_class[name] = usual._replace(**{key: each for key, each in numbers.items() if each is not None})
    materials = {entity: names.inherited(entity, by_class) for entity in names.entities}
    return {entity: material for entity, material in materials.items() if material is not None}


def _colors(section: TableEntry, names: DomainNames, shapes: Mapping[str, Shape], top: str) -> dict[str, str]:
    """Return the colour of each entity: its own, that of its class, or one that differs visibly from all others.

    `top` is the colour of the table.
    """
    own_colors = {name: color(entry) for name, entry in section.entries()}
    for name, entry in section.entries():
        if name not in names.entities and name not in names.known_classes:
            hint = did_you_mean(name, [*names.entities, *names.known_classes])
            entry.add(f"unknown entity or class; {hint}")
    colors: dict[str, str | None] = {}
    for entity, shape in shapes.items():
        own = next((own_colors[name] for name in (entity, *names.line(entity)) if name in own_colors), None)
        if own is None and shape.traits.hollow:
            own = FURNITURE_COLOR if shape.traits.furniture else CONTAINER_COLOR
        own = WHITE if own is None and _is_painted(shape) else own
        colors[entity] = own or {"table": top, "robot": ROBOT_COLOR}.get(shape.kind)
    taken = (*dict.fromkeys(each for each in colors.values() if each is not None), *AROUND)
    count = list(colors.values()).count(None)
    distinct = (each for each in PALETTE if all(colour_distance(each, other) >= DISTINCT for other in taken))
    chosen = list(islice(distinct, count))
    if len(chosen) < count:
        chosen += more_colours((*taken, *chosen), count - len(chosen))
    others = iter(chosen)
    return {entity: each or next(others) for entity, each in colors.items()}


def _is_painted(shape: Shape) -> bool:
    """Return whether a body has its own colours."""
    if shape.model is None or not shape.model.looks:
        return False
    from prag_asp.scene.read.looks.surfaces import is_painted  # noqa: PLC0415 - few domains have bodies with a model

    return is_painted(shape)


def _robots(section: TableEntry, shapes: Mapping[str, Shape], usual: str) -> dict[str, Mount]:
    """Return the mount of each robot by its entity; an empty table means one robot at the origin.

    `usual` is the kind of robot for a table that does not name one.
    """
    entities = [entity for entity, shape in shapes.items() if shape.kind == "robot"]
    mounts = {}
    for entity, entry in section.entries():
        if entity in section.report.doubtful:
            continue
        if entity not in entities:
            entry.add(f"is not an entity with the shape of a robot; the scene has {', '.join(entities) or 'none'}")
        elif entry.is_table("like { base = [0.0, 0.4, 0] }", ("kind", "base")):
            kind = entry.at("kind", usual).choice(tuple(ROBOTS)) or usual
            base = entry.at("base", [0.0, 0.0, 0.0])
            x, y, yaw = base.numbers(3, "x and y in metres and a yaw in degrees") or (0.0, 0.0, 0.0)
            if max(abs(x), abs(y)) > FARTHEST_BASE:
                base.add(f"is more than {FARTHEST_BASE:g} m from the origin; move it nearer")
            if entry.is_sound:
                mounts[entity] = Mount(kind, x, y, math.radians(yaw))
    if (section.value or len(entities) > 1) and section.is_sound:
        for entity in entities:
            if entity not in section.value:
                section.at(entity).needs("{ base = [x, y, yaw] }, in metres and degrees")
    for one, two in combinations(mounts, 2):
        distance = math.hypot(mounts[one].x - mounts[two].x, mounts[one].y - mounts[two].y)
        if distance < CLOSEST_BASES:
            text = f"is {distance:g} m from that of {one}; move it to a distance of at least {CLOSEST_BASES:g} m"
            section.at(two).at("base").add(text)
    return mounts or only_robot(shapes, usual)


def check_bases(section: TableEntry, scene: Scene) -> None:
    """Report fixed bodies of a scene that overlap the base of a robot; the section is ``scene.fixed``."""
    for entity, place in scene.fixed.items():
        shape = scene.shapes[entity]
        for robot, mount in scene.robots.items() if shape.traits.body else ():
            cosine, sine = math.cos(mount.yaw), math.sin(mount.yaw)
            for piece in ROBOTS[mount.kind].footprint:
                x, y, yaw = piece.place
                there = (mount.x + cosine * x - sine * y, mount.y + sine * x + cosine * y, mount.yaw + yaw)
                if not apart(Footprint(shape, place), piece._replace(place=there), TOUCHING):
                    section.at(entity).add(f"{entity} stands on the base of {robot}; move it")
                    break

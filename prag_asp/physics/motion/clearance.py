"""Check that, on a path, an arm and its load keep `CLEARANCE` from all bodies that are not close at either end."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple

from prag_asp.physics.bullet import pybullet
from prag_asp.physics.situation import Situation
from prag_asp.physics.witness import Arm
from prag_asp.physics.world.collisions import BASE_LINK
from prag_asp.physics.world.simulator import COLLISION, Simulator
from prag_asp.scene.boxes import Corners, around, touch, widened

CLEARANCE = 0.01
"""The distance in metres that an arm and its load keep from bodies that the arm does not handle."""

SLACK = 0.0005
"""The distance in metres by which a body may come closer to another body than at an end of the path."""

ARM, TABLE = "the arm", "the table"
Gaps = Mapping[tuple[str, str], float]
"""The distances in metres between bodies that are closer than `CLEARANCE`, by pairs of names."""


class ArmPassage(NamedTuple):
    """A point on the path of the acting arm: the situation, the arm's state, and the bodies moving with the gripper."""

    situation: Situation
    arm: Arm
    carried: Sequence[str]


def gaps(simulator: Simulator, passage: ArmPassage) -> Gaps:
    """Return the distances between the acting arm and its load, and the distances from both to all other bodies.

    Contacts of the fingers with a held object are ignored, and so are the base, which never moves, and pairs of links
    of one arm that cannot collide.
    """
    distances: dict[tuple[str, str], float] = {}
    for one, two, gap in _near(simulator, passage):
        if gap < distances.get((one, two), CLEARANCE):
            distances[one, two] = gap
    return distances


def keeps_clear(start: Gaps, way: Sequence[Gaps], goal: Gaps) -> bool:
    """Return whether a path keeps clear: it is close to a body only right after its start or right before its goal.

    There, the arm comes no closer to the body than it is at that end of the path.
    """
    since, until = _uneased(start, way), reversed(_uneased(goal, way[::-1]))
    return all(one.isdisjoint(two) for one, two in zip(since, until, strict=True))


def _uneased(end: Gaps, way: Sequence[Gaps]) -> list[set[tuple[str, str]]]:
    """Return the pairs that are too close at each point of a path, except pairs that have been close since `end`."""
    since, result = dict(end), []
    for here in way:
        since = {pair: gap for pair, gap in since.items() if pair in here}
        result.append({pair for pair, gap in here.items() if gap < max(COLLISION, since.get(pair, CLEARANCE) - SLACK)})
    return result


def _near(simulator: Simulator, passage: ArmPassage) -> Iterator[tuple[str, str, float]]:
    """Yield pairs of bodies whose bounding boxes are close, and their distances in metres."""
    situation, arm, carried = passage
    simulator.place(situation.poses, situation.openings)
    acting, table = simulator.arm, simulator.table
    whole = dict(zip(acting.robot.links, acting.link_boxes(arm.joints, arm.width), strict=True))
    boxes = {link: corners for link, corners in whole.items() if link > BASE_LINK}
    acting.pose(arm.joints, arm.width)
    low = [link for link, ((_, _, z), _) in boxes.items() if z < CLEARANCE]
    yield from _distances(simulator, (ARM, TABLE), acting.body, table, low)
    for entity, body in situation.bodies:
        links = _beside((body.low, body.high), boxes)
        if entity in (arm.held, *carried):
            links = [link for link in links if link not in acting.robot.finger_links]
        yield from _distances(simulator, (ARM, entity), acting.body, simulator.body(entity), links)
    for one, two in acting.robot.self_pairs:
        if _wide(whole[one], whole[two]):
            yield from _distances(simulator, (ARM, "itself"), acting.body, acting.body, [one], two)
    for name, other in situation.arms.items():
        if name != simulator.acting:
            yield from _near_arm(simulator, passage, name, other, boxes)
    for entity in carried:
        load, own = simulator.body(entity), situation.body(entity)
        if own.low[2] < CLEARANCE:
            yield from _distances(simulator, (entity, TABLE), load, table)
        for other_entity, near in situation.bodies:
            if other_entity not in carried and _wide((own.low, own.high), (near.low, near.high)):
                yield from _distances(simulator, (entity, other_entity), load, simulator.body(other_entity))


def _near_arm(
    simulator: Simulator, passage: ArmPassage, name: str, other: Arm, boxes: Mapping[int, Corners]
) -> Iterator[tuple[str, str, float]]:
    """Yield the distances from the acting arm and its load to another arm."""
    there = simulator.arms[name]
    whole = dict(zip(there.robot.links, there.link_boxes(other.joints, other.width), strict=True))
    there.pose(other.joints, other.width)
    links = [link for link in _beside(around(whole.values()), boxes) if _beside(boxes[link], whole)]
    yield from _distances(simulator, (ARM, name), simulator.arm.body, there.body, links)
    for entity in passage.carried:
        body = passage.situation.body(entity)
        links = _beside((body.low, body.high), whole)
        if entity == other.held:
            links = [link for link in links if link not in there.robot.finger_links]
        yield from _distances(simulator, (entity, name), there.body, simulator.body(entity), links)


def _distances(
    simulator: Simulator,
    names: tuple[str, str],
    one: int,
    two: int,
    links: Iterable[int] | None = None,
    other_link: int | None = None,
) -> Iterator[tuple[str, str, float]]:
    """Yield names and distances below `CLEARANCE`, in metres, between some or all links of two bodies."""
    ends = {} if other_link is None else {"linkIndexB": other_link}
    chosen = [ends] if links is None else [{"linkIndexA": link, **ends} for link in links]
    for each in chosen:
        points = pybullet.getClosestPoints(one, two, CLEARANCE, physicsClientId=simulator.client, **each)
        yield from ((*names, point[8]) for point in points)


def _beside(corners: Corners, boxes: Mapping[int, Corners]) -> list[int]:
    """Return the links whose bounding boxes are within `CLEARANCE` of another box."""
    return [link for link, each in boxes.items() if _wide(corners, each)]


def _wide(one: Corners, two: Corners) -> bool:
    """Return whether two bounding boxes are within `CLEARANCE` of each other along every axis."""
    return touch(widened(one, CLEARANCE), two)

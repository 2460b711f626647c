"""Bystanders: objects of the scene that a task does not name, at rest at places that the task does not need.

A witness holds only the objects of its task. A picture also shows other objects. They stand on the table, away from all
bodies, and away from the robots in all states and at all waypoints, and they hide nothing that the task moves.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain

import numpy as np
from numpy.typing import NDArray

from prag_asp.physics.filming.studio import Studio
from prag_asp.physics.pictures.sight import Boxes, Sight, boxes_of
from prag_asp.physics.pictures.views import View
from prag_asp.physics.robot.kinematics import tool_pose
from prag_asp.physics.search.attempt import Failure, Search
from prag_asp.physics.search.placement import PlacementRequest, sample_pose
from prag_asp.physics.situation import Situation
from prag_asp.physics.symbolic_facts import PhysicalTask
from prag_asp.physics.witness import Arm, Moment, Witness
from prag_asp.physics.world.simulator import Simulator
from prag_asp.physics.world.support import TABLE
from prag_asp.scene.boxes import Corners
from prag_asp.scene.geometry import Pose, compose
from prag_asp.scene.robots import robot_of
from prag_asp.scene.scene import Scene

SEED = 0
"""The seed for the places of bystanders, so that they are the same in all pictures of a witness."""

MOST, TRIES = 12, 24
"""The maximum number of bystanders, and the number of places that are tried for each."""

CLEAR = 0.02
"""The distance in metres between a bystander and everything that moves."""

BENEATH = 0.12
"""The height in metres of the space below a hand in which no bystander stands in any state, because the hand might seem
to hold it."""


def absent_objects(scene: Scene, present: Mapping[str, Pose]) -> list[str]:
    """Return the movable objects of a scene that are not present, at most `MOST`, large ones first."""
    known = {*present, *scene.fixed}
    absent = [name for name, shape in scene.shapes.items() if shape.traits.body and name not in known]
    return sorted(absent, key=lambda name: -scene.shapes[name].size[0] * scene.shapes[name].size[1])[:MOST]


def place_bystanders(
    physical: PhysicalTask, moments: Sequence[Moment], passed: Iterable[Moment], simulator: Simulator, sight: Sight
) -> dict[str, Pose]:
    """Return the poses of bystanders, as many as there is room for, in the scene of a simulator.

    `moments` has one moment for each state of the task, and `passed` has the moments at the waypoints between them.
    The bystanders lie entirely within the camera image of `sight`, hide nothing in it, and do not change the value of
    any fact.
    """
    scene = simulator.scene
    room = Room.of(moments, passed, simulator)
    situations = [situation_of_moment(scene, moment) for moment in moments]
    values = [_values(physical, k, situation) for k, situation in enumerate(situations)]
    search = Search(simulator, (), np.random.default_rng(SEED), {})
    found: dict[str, Pose] = {}
    for entity in absent_objects(scene, moments[0].poses):
        around = situations[0].with_poses({**moments[0].poses, **found})
        for pose in _candidates(search, around, entity):
            body = around.with_pose(entity, pose).body(entity)
            box = (body.low, body.high)
            if not sight.shows(box) or sight.is_hidden_by(box) or not room.has_place(entity, pose, boxes_of([box])):
                continue
            trials = (each.with_poses({**each.poses, **found, entity: pose}) for each in situations)
            if all(_values(physical, k, trial) == values[k] for k, trial in enumerate(trials)):
                found[entity] = pose
                break
    return found


def visible_bystanders(
    poses: Mapping[str, Pose],
    moments: Iterable[Moment],
    studio: Studio,
    scene: Scene,
    view: tuple[View, tuple[int, int]],
) -> dict[str, Pose]:
    """Return the bystanders that hide nothing in a view of the given moments; the view includes the picture's size."""
    sight, situation = Sight.of(studio, view, moments), Situation(scene, poses)
    boxes = {entity: (body.low, body.high) for entity, body in situation.bodies}
    return {entity: pose for entity, pose in poses.items() if not sight.is_hidden_by(boxes[entity])}


def waypoint_moments(witness: Witness, scene: Scene) -> Iterator[Moment]:
    """Yield the moments at the waypoints of a witness, with the objects that the robots carry there."""
    for k, motion in enumerate(witness.motions):
        before, after = witness.moments[k], witness.moments[k + 1]
        for point in motion:
            poses, arm = dict(before.poses), Arm(point.joints, point.width, point.held)
            for other in (before.arms[point.robot], after.arms[point.robot]):
                if point.held is not None and other.held == point.held and other.grasp is not None:
                    poses[point.held] = compose(tool_pose(robot_of(scene, point.robot), point.joints), other.grasp)
            yield Moment(poses, {**before.arms, point.robot: arm}, before.openings)


@dataclass(frozen=True)
class Room:
    """The room that objects and robots leave in the given moments.

    `bodies` are the bounding boxes of all objects and of the space beneath hands, and `links` are those of all links;
    `owners` holds, for each of `links`, its robot, its number, and the arm to which it belongs.
    """

    simulator: Simulator
    bodies: Boxes
    links: Boxes
    owners: Sequence[tuple[str, int, Arm]]

    @classmethod
    def of(cls, moments: Sequence[Moment], passed: Iterable[Moment], simulator: Simulator) -> Room:
        """Return the room in the moments of the states, and in further moments through which the robots pass."""
        bodies, links, owners = list[Corners](), list[Corners](), list[tuple[str, int, Arm]]()
        for k, moment in enumerate(chain(moments, passed)):
            bodies += [(body.low, body.high) for _, body in situation_of_moment(simulator.scene, moment).bodies]
            for name, arm in moment.arms.items():
                robot, boxes = simulator.arms[name].robot, simulator.arms[name].link_boxes(arm.joints, arm.width)
                links += boxes
                owners += [(name, link, arm) for link in robot.links]
                if k < len(moments):
                    hand = [box for box, link in zip(boxes, robot.links, strict=True) if link >= robot.flange_link]
                    bodies += [((*low[:2], low[2] - BENEATH), high) for low, high in hand]
        return cls(simulator, boxes_of(bodies), boxes_of(links), owners)

    def has_place(self, entity: str, pose: Pose, box: Boxes) -> bool:
        """Return whether an object at a pose, with its bounding box, keeps clear of everything."""
        if _near(box, self.bodies).any():
            return False
        close = np.flatnonzero(_near(box, self.links))
        if close.size:
            self.simulator.place({entity: pose})
        for i in close.tolist():
            name, link, arm = self.owners[i]
            self.simulator.arms[name].pose(arm.joints, arm.width)
            if self.simulator.arms[name].contacts(self.simulator.body(entity), [link], CLEAR):
                return False
        return True


def _near(box: Boxes, others: Boxes) -> NDArray[np.bool_]:
    """Return which of the other boxes are closer to a box than `CLEAR` along all axes."""
    near: NDArray[np.bool_] = np.all((box[:, 0] - CLEAR <= others[:, 1]) & (others[:, 0] <= box[:, 1] + CLEAR), axis=1)
    return near


def situation_of_moment(scene: Scene, moment: Moment) -> Situation:
    """Return a moment as a situation, for predicates and bounding boxes."""
    return Situation(scene, moment.poses, moment.arms, moment.openings)


def _candidates(search: Search, situation: Situation, entity: str) -> Iterator[Pose]:
    """Yield random poses at which an object can stand on the table, given the other objects in a situation."""
    for _ in range(TRIES):
        try:
            yield sample_pose(search, situation, PlacementRequest(entity, TABLE, (), 0))
        except Failure:
            return


def _values(physical: PhysicalTask, state: int, situation: Situation) -> list[bool]:
    """Return for each known fact of a state whether a situation satisfies it."""
    return [fact.is_satisfied(situation) for fact in physical.states[state]]

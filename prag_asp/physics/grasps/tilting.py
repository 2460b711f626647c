"""The load with which the weight of a body, such as a plate held at its rim, tilts it out of the pads.

Friction bears the torque about the line through both pads, and pressure bears the rest. A pad presses with a force F
somewhere on its patch. If one pad presses at the upper end of its patch and the other pad at the lower end of its
patch, the two forces form a couple of F times the difference in height; no grip bears a larger torque about the
horizontal axis along the pads. The same holds for the torque about the direction of the fingers, with the ends of the
patches along the pads. An inclined rim is therefore held best by fingers with the same inclination: upright pads touch
such a rim at the bottom on the inside and at the top on the outside, so their forces help to tilt it.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from prag_asp.physics.grasps.body_grasps import body_grasps
from prag_asp.physics.grasps.pads import ParallelGripper
from prag_asp.scene.geometry import Pose, matrix
from prag_asp.scene.scene import Shape
from prag_asp.scene.surfaces import in_frame, mesh_states, surface

SHORTEST = 1e-4
"""The smallest lever arm of a couple in metres, because pads are not more exact than that."""


class TiltingLoad(NamedTuple):
    """The torque of a body's weight as a share of the largest torque that the pads bear by pressure, or in total.

    The `total` includes the torque that the pads bear by friction. Both shares assume that each pad presses with a
    force equal to the weight of the body.
    """

    pressure: float
    total: float


def tilting_loads(shape: Shape, gripper: ParallelGripper, friction: float) -> NDArray[np.float64]:
    """Return the tilting loads of all grasps of a body, in the order of `body_grasps`, shape (n, 2).

    The columns are the fields of `TiltingLoad`; `friction` is the coefficient between pad and body.

    Raises:
        SceneError: a mesh cannot be read.
    """
    return _loads(shape, gripper, friction, mesh_states(shape))


@lru_cache(maxsize=256)
def _loads(
    shape: Shape, gripper: ParallelGripper, friction: float, files: tuple[tuple[int, int], ...]
) -> NDArray[np.float64]:
    """Return the loads of all grasps; the states of the body's files are part of the cache key."""
    grasps = body_grasps(shape, gripper, friction)
    return np.array([grip_tilting(shape, gripper, friction, grasp.tool) for grasp in grasps]).reshape(-1, 2)


def grip_tilting(shape: Shape, gripper: ParallelGripper, friction: float, tool: Pose) -> TiltingLoad:
    """Return the tilting load of an upright body held by a tool; the pose of the tool is in the body's frame.

    Raises:
        SceneError: a mesh cannot be read.
    """
    centre = (0.0, 0.0, 0.0) if shape.model is None else shape.model.centre
    return tilting_load(surface(shape), centre, gripper, tool, friction)


def tilting_load(
    triangles: NDArray[np.float64],
    centre: tuple[float, float, float],
    gripper: ParallelGripper,
    tool: Pose,
    friction: float,
) -> TiltingLoad:
    """Return the tilting load of an upright body in a grasp, or 0 if there is nothing between the pads.

    `triangles`, shape (n, 3, 3), form the body's surface, and `centre` is its centre of mass, both in the body's frame.
    """
    polygons = gripper.between(in_frame(triangles, tool))
    if not len(polygons.corners):
        return TiltingLoad(0.0, 0.0)
    frame = matrix(tool)
    offset, down = frame[:3, :3].T @ (centre - frame[:3, 3]), frame[:3, :3].T @ (0.0, 0.0, -1.0)
    about_x, _, about_z = np.cross(offset, down).tolist()
    ends = polygons.corners[:, :, 1]
    low, high = float(ends.min()), float(ends.max())
    one, two = (polygons.touched(end, side).corners.reshape(-1, 3) for end, side in ((low, -1.0), (high, 1.0)))
    # The pad at the larger y turns the body about x by z F and about z by -x F, the other one by -z F and x F.
    pressures, totals = list[float](), list[float]()
    for torque, a, b in ((about_x, one[:, 2], two[:, 2]), (-about_z, one[:, 0], two[:, 0])):
        upper, lower = (a, b) if torque > 0.0 else (b, a)
        couple = float(upper.max(initial=-math.inf) - lower.min(initial=math.inf))
        pressures.append(abs(torque) / max(couple, SHORTEST))
        totals.append(abs(torque) / max(couple + friction * (high - low), SHORTEST))
    return TiltingLoad(max(pressures), max(totals))

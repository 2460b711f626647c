"""What the pads of a gripper touch, against shapes of which it is known."""

import math

import numpy as np
import pytest

from prag_asp.physics.grasps.antipodal import GraspProblem, sampled_grasps
from prag_asp.physics.grasps.pads import ParallelGripper
from prag_asp.scene.geometry import Pose, compose, multiply, yaw_quaternion
from prag_asp.scene.robots.panda import PANDA
from prag_asp.scene.scene import Shape
from prag_asp.scene.surfaces import in_frame, part_surfaces, surface

GRIPPER = ParallelGripper.of(PANDA)
DOWN = (1.0, 0.0, 0.0, 0.0)


def tool(x: float = 0.0, y: float = 0.0, z: float = 0.0, yaw: float = 0.0) -> Pose:
    return Pose((x, y, z), multiply(yaw_quaternion(yaw), DOWN))


@pytest.mark.parametrize("yaw", [0.0, 0.1, 0.3, math.pi / 4])
def test_a_turned_box_is_as_wide_as_its_part_between_the_pads(yaw: float) -> None:
    box = Shape("box", (0.2, 0.04, 0.05))
    contact = GRIPPER.contact(in_frame(surface(box), tool(yaw=yaw)))
    assert contact is not None
    # The sides of the strip leave the pads where they are half a pad from the middle.
    expected = (0.04 + 2 * GRIPPER.half_x * math.sin(yaw)) / math.cos(yaw)
    assert contact.width == pytest.approx(expected, abs=1e-9)


def test_a_flat_contact_has_the_area_and_radius_of_the_pad() -> None:
    contact = GRIPPER.contact(in_frame(surface(Shape("box", (0.1, 0.04, 0.1))), tool()))
    assert contact is not None
    length = GRIPPER.high_z - GRIPPER.low_z
    for patch in contact.patches:
        assert patch.area == pytest.approx(2 * GRIPPER.half_x * length, rel=1e-9)
        assert patch.gyration == pytest.approx(math.hypot(2 * GRIPPER.half_x, length) / math.sqrt(12), rel=1e-6)
        assert patch.slope == pytest.approx(1.0)


def test_a_cylinder_is_touched_along_two_lines() -> None:
    contact = GRIPPER.contact(in_frame(surface(Shape("cylinder", (0.06, 0.06, 0.1))), tool(yaw=0.4)))
    assert contact is not None
    assert contact.width == pytest.approx(0.06, rel=0.01)
    assert min(patch.area for patch in contact.patches) > 1e-4


def test_nothing_is_between_the_pads_beside_a_body() -> None:
    assert GRIPPER.contact(in_frame(surface(Shape("box", (0.04, 0.04, 0.04))), tool(x=0.1))) is None


def test_the_wall_of_a_tray_is_gripped_and_the_tray_is_not() -> None:
    tray = Shape("container", (0.2, 0.2, 0.06), wall=0.006)
    grasps = sampled_grasps(GraspProblem(part_surfaces(tray), (0.0, 0.0, 0.0), 0.9), GRIPPER)
    assert grasps
    assert all(grasp.width < 0.01 for grasp in grasps)


def test_a_body_wider_than_the_opening_has_no_grasp() -> None:
    cube = Shape("box", (0.1, 0.1, 0.1))
    assert not sampled_grasps(GraspProblem(part_surfaces(cube), (0.0, 0.0, 0.0), 0.9), GRIPPER)


def test_grasps_close_on_both_sides_and_keep_the_hand_free() -> None:
    box = Shape("box", (0.15, 0.03, 0.05))
    found = sampled_grasps(GraspProblem(part_surfaces(box), (0.0, 0.0, 0.0), 0.9), GRIPPER)
    assert found == sampled_grasps(GraspProblem(part_surfaces(box), (0.0, 0.0, 0.0), 0.9), GRIPPER)
    for grasp in found:
        contact = GRIPPER.contact(in_frame(surface(box), grasp.tool))
        assert contact is not None
        assert (contact.low, contact.high) == pytest.approx((-grasp.width / 2, grasp.width / 2), abs=1e-9)
        corners = np.array([compose(grasp.tool, Pose((0.0, y, GRIPPER.high_z))).position for y in (-0.04, 0.04)])
        assert corners[:, 2].min() > -0.025

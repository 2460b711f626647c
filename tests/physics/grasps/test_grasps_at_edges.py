"""Grasps between an edge and a face, or between two edges: where there are any, and what an independent check says."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from prag_asp.physics.grasps.antipodal import GraspProblem, sampled_grasps
from prag_asp.physics.grasps.pads import ParallelGripper
from prag_asp.scene.geometry import matrix
from prag_asp.scene.read.convex import convex_hull
from prag_asp.scene.robots.panda import PANDA
from tests.independent.convex import Part
from tests.independent.frames import Frame
from tests.independent.grips import grip
from tests.independent.hulls import hull_of

Floats = NDArray[np.float64]

GRIPPER = ParallelGripper.of(PANDA)
STEEL = 0.42


def prism(corners: int, radius: float, height: float, lying: bool = False) -> Floats:
    """Return the triangles of a prism over a regular polygon, upright, or lying on a side with an edge above it."""
    turns = 2 * math.pi * np.arange(corners) / corners + math.pi / 2
    points = np.array([(radius * math.cos(a), radius * math.sin(a), z) for a in turns for z in (0.0, height)])
    return convex_hull(points[:, [2, 0, 1]] if lying else points)


def problem(*parts: Floats, friction: float = STEEL) -> GraspProblem:
    """Return the problem of holding a body whose centre of mass is the middle of its corners."""
    x, y, z = np.unique(np.concatenate(parts).reshape(-1, 3).round(9), axis=0).mean(0).tolist()
    return GraspProblem(parts, (x, y, z), friction)


def solids(*parts: Floats) -> list[tuple[Part, Frame]]:
    """Return convex parts as the independent check has them."""
    found = []
    for part in parts:
        corners = np.unique(part.reshape(-1, 3).round(9), axis=0)
        low, high = corners.min(0), corners.max(0)
        middle = (low + high) / 2
        hull = Part("hull", (high - low) / 2, middle, hull_of(corners - middle, 1.0))
        found.append((hull, Frame(np.eye(3), np.zeros(3))))
    return found


PRISMS = {
    "a triangular prism": (prism(3, 0.0404, 0.12), 0.0606),
    "a low triangular prism": (prism(3, 0.0404, 0.06), 0.0606),
    "a pentagonal prism": (prism(5, 0.035, 0.05), 0.0633),
}


@pytest.mark.parametrize("friction", [0.07, STEEL, 0.98])
@pytest.mark.parametrize("name", PRISMS)
def test_a_prism_without_parallel_sides_is_held_between_an_edge_and_a_side(name: str, friction: float) -> None:
    part, width = PRISMS[name]
    found = sampled_grasps(problem(part, friction=friction), GRIPPER)
    assert len(found) >= 8
    for grasp in found:
        assert grasp.at_edge
        frame = matrix(grasp.tool)
        met = grip(solids(part), Frame(frame[:3, :3], frame[:3, 3]), GRIPPER.opening)
        assert met is not None and met.leans(friction) <= math.atan(friction)
        assert met.width == pytest.approx(grasp.width, abs=0.001)
    assert min(grasp.width for grasp in found) == pytest.approx(width, abs=0.001)


def test_a_lying_prism_over_a_pentagon_is_held_from_above_between_two_edges() -> None:
    part = prism(5, 0.035, 0.12, lying=True)
    found = sampled_grasps(problem(part), GRIPPER)
    assert found and all(grasp.at_edge for grasp in found)
    # The widest chord of the pentagon.
    assert found[0].width == pytest.approx(2 * 0.035 * math.cos(math.pi / 10), abs=0.001)
    assert found[0].tilt == pytest.approx(0.0, abs=0.4)


def test_grasps_at_faces_come_first_and_where_there_are_enough_none_at_edges_are_sampled() -> None:
    found = sampled_grasps(problem(prism(6, 0.035, 0.05)), GRIPPER)
    edges = [grasp.at_edge for grasp in found]
    assert any(edges) and not edges[0] and edges == sorted(edges)
    assert not any(grasp.at_edge and grasp.tilt < 1.2 for grasp in found)


def test_pads_hold_no_edge_if_the_line_between_the_contacts_is_outside_the_friction_cones() -> None:
    # A block between opposite edges, turned by an angle about them: their offset is its tangent times their distance.
    held = {}
    for degrees in (0.0, 15.0, 30.0):
        c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
        block = (prism(4, 0.015, 0.04) - (0.0, 0.0, 0.02)) @ np.array([(c, s, 0.0), (-s, c, 0.0), (0.0, 0.0, 1.0)])
        contact = GRIPPER.contact(block)
        met = grip(solids(block), Frame(np.eye(3), np.zeros(3)), GRIPPER.opening)
        assert contact is not None and met is not None
        held[degrees] = min(contact.cosines(STEEL)) >= math.cos(math.atan(STEEL))
        assert held[degrees] == (met.leans(STEEL) <= math.atan(STEEL))
    assert held == {0.0: True, 15.0: True, 30.0: False}


def test_pads_do_not_hold_the_slopes_of_a_notch() -> None:
    # The tips of the notch are beside the pad, so that the pad touches its slopes, which are too steep for friction.
    left = convex_hull(
        np.array([(x, y, z) for x, y in ((-0.02, 0.0), (-0.02, 0.03), (0.0, 0.0)) for z in (-0.03, 0.03)])
    )
    right = left[:, ::-1] * (-1.0, 1.0, 1.0)
    block = convex_hull(np.array([(x, y, z) for x in (-0.02, 0.02) for y in (-0.02, 0.0) for z in (-0.03, 0.03)]))
    triangles = np.concatenate([left, right, block])
    contact = GRIPPER.contact(triangles)
    assert contact is not None
    low, high = contact.cosines(STEEL)
    assert low == pytest.approx(1.0) and high < math.cos(math.atan(STEEL))
    met = grip(solids(left, right, block), Frame(np.eye(3), np.zeros(3)), GRIPPER.opening)
    assert met is not None and met.leans(STEEL) > math.atan(STEEL)

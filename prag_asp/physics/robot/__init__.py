"""The robots: one file each, behind one small description that the rest of physics reads."""

from __future__ import annotations

from collections.abc import Mapping

from prag_asp.physics.robot.kuka import KUKA
from prag_asp.physics.robot.model import Hand, Joints, Robot, Solver
from prag_asp.physics.robot.panda import PANDA

ROBOTS: Mapping[str, Robot] = {"panda": PANDA, "kuka": KUKA}
"""Every robot by the name that it has in a scene."""

__all__ = ["KUKA", "PANDA", "ROBOTS", "Hand", "Joints", "Robot", "Solver"]

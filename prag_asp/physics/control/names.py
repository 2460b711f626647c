"""The names of control conventions, and the rates of actions."""

from __future__ import annotations

from typing import Literal, get_args

from prag_asp.physics.world.time_step import STEPS_A_SECOND

StateName = Literal["joint_position", "ee_position"]
ControlName = Literal["joint_position", "joint_delta", "ee_position", "ee_delta", "ee_delta_upright"]
CONTROLS: tuple[ControlName, ...] = get_args(ControlName)

UPRIGHT: ControlName = "ee_delta_upright"
"""The convention for agents that move an upright tool; it has the fewest numbers."""

RECORDED = CONTROLS[:4]
"""The conventions that can express recordings, in which tools tilt."""

STATES: tuple[StateName, ...] = get_args(StateName)
"""The conventions in which a state can be described: those with absolute numbers."""

RATES = tuple(rate for rate in range(1, STEPS_A_SECOND + 1) if STEPS_A_SECOND % rate == 0)
"""The possible numbers of actions per second: those for which an action lasts a whole number of simulation steps."""

USUAL_RATE = 20
"""The default number of actions per second, the same as in recordings."""

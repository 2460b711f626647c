"""Every tolerance of the check, with its reason."""

from __future__ import annotations

import numpy as np

DEEPEST = 0.00155
"""Metres by which bodies may be in each other. The product allows 1.5 mm, for bodies that touch are not apart by
rounding alone; the rest is PyBullet's, whose depths of boxes and cylinders are off by some hundredths of a millimetre.
"""

MOVED, TURNED = 1e-4, 1e-3
"""Metres and radians by which a body may be off the place where it has to be: inverse kinematics is within 0.01 mm."""

ROUNDING = 1e-9
"""By how much a number may be beyond its limits, or differ from one that is copied: it is read back from decimals."""

SLACK = 1e-6
"""Metres and radians by which two ways to compute the same number may differ: on an edge either value is right."""

CONTACT = 0.002
"""Metres between surfaces that touch: the product takes a body so far from a surface to stand on it."""

SAME = 0.002
"""Metres over its lowest point up to which a body from a file is taken to stand on what it has there."""

UPRIGHT = 1e-3
"""By how much the vertical part of a standing body's axis may be less than 1, which is a lean of 2.6 degrees."""

BALANCED = 1e-5
"""What share of the heaviest body's weight may be left over where forces balance: 10 micrometres of its lever."""

GRIP_FORCE, STRAINED = 12.0, 1.08
"""Newtons with which a finger presses, and how many times what friction bears a torque may be: 5 % of the definition,
and the spread of what lines between the pads see of a contact.
"""

LIGHT = 50.0
"""How many times its weight a finger presses at most on a body from a file, for thin walls give way to more."""

HANDLE = 1e-3
"""Metres and radians by which the gripper may be off the handle that it pulls, and turn on it: the rubber gives way."""

ABOVE = 0.10
"""Metres from which the gripper comes straight down to a body, and to which it leaves it."""

SLIDE, SWING = 0.05 + ROUNDING, 0.2 + ROUNDING
"""Metres or radians by which furniture moves at most between two waypoints."""

STRIDE, RUNG = 0.1, 0.026
"""Radians by which a joint turns at most between two waypoints of a way, and metres by which the tool moves straight up
or down: a way is given in steps of 0.06 rad, the last of them up to half longer, or a quarter of 10 cm."""

FINE = 0.02
"""Radians between the places of the arm that are looked at on a way: the gripper moves by less than 2 cm."""

SPACING = 0.015
"""Metres between the points on the links of an arm that are looked at; a third of it on gripper and objects."""

TILT = float(np.radians(10))
"""By how much a heading or an axis may be off, in radians: what the product calls rotated, or upright."""

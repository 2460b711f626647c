"""Grasps of a parallel gripper on the geometry of a body, in the body's frame, without an arm or a scene."""

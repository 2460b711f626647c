"""Grasps of a body by a parallel gripper, in the body's frame, without an arm or a scene."""

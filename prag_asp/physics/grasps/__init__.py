"""Grasps of a parallel gripper on the geometry of a body, in the body's own frame, without an arm or a scene."""

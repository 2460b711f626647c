"""Collision-free paths of an arm, and their timing."""

"""A second opinion on witnesses: NumPy alone, no PyBullet, no line of the library's physics.

`check.problems` takes a task and its witness as they stand in a file, and says what is wrong with them.
"""

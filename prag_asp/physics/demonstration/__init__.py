"""The execution of tasks by the robots in a dynamic simulation."""

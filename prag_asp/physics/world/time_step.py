"""The time step of dynamic simulations."""

STEPS_A_SECOND = 120
"""Simulation steps per second; twice as many cost twice as much and do not raise the share of tasks that succeed."""

TIME_STEP = 1 / STEPS_A_SECOND
"""The time step in seconds."""

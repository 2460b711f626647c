"""Checks that stop clingo when numbers are out of range or terms grow endlessly."""

"""Checks that stop clingo at numbers out of range and at ever larger terms."""

"""Checks that stop clingo at numbers out of range and at endlessly growing terms."""

"""Enumeration of answer sets by clingo, without limits or with limited work."""

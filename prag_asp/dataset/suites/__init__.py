"""Suites: the parts of a benchmark over one task space, proved disjoint by exact counts."""

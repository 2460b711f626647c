"""Suites: the parts of a benchmark over one space of tasks, apart by exact counts."""

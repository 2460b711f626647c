"""Suites: benchmarks whose parts are sets of tasks of one domain, proved disjoint by exact counts."""

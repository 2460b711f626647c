"""The unrolled program as clauses, with solvers and model counters."""

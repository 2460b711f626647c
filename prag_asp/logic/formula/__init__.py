"""The unrolled program as clauses, and what solves and counts them."""

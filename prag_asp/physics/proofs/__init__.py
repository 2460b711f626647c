"""Proofs that a task is infeasible, and the rules that the logic learns from them."""

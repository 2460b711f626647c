"""Proofs that a task cannot be done, and what they teach the logic."""

"""Strata of task spaces, and the allocation of samples to them."""

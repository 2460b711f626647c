"""Tasks as orbits of plans, by brute force."""

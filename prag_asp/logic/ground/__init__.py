"""Ground programs: one step of a domain, or all of them."""

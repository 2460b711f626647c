"""Sets and functions of states as decision diagrams, and the step of a domain on them."""

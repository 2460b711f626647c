"""Sets of states, and functions of states, as decision diagrams; the step of a domain on them."""

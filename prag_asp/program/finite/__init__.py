"""What clingo would not stop at: numbers out of range, and terms without end."""

"""What makes a task more probable than others."""

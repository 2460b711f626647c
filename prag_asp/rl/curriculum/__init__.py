"""Which task comes next, and which of its subgoals: values that say how, and the courses that keep the score."""

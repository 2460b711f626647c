"""Questions about all answer sets: which are optimal, what tells them apart, and why there is none."""

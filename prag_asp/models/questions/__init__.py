"""Questions about all answer sets: which are optimal, in which atoms they differ, and why there is none."""

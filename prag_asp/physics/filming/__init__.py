"""What cameras of a scene see of an episode."""

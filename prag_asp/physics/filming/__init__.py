"""Camera images of an episode."""

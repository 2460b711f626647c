"""Sample many words at once, with exact probabilities."""

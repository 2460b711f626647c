"""Sampling of words with exact probabilities, many at once."""

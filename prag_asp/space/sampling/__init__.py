"""Sampling of many words at once, with exact probabilities."""

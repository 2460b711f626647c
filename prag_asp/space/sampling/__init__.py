"""Words drawn with exact probabilities, many at once."""

"""Pages of a data set for people: its card, with film strips."""

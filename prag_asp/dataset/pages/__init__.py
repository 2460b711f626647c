"""Pages of a dataset for people: its card, with film strips."""

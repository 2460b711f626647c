"""The card of a dataset, with film strips."""

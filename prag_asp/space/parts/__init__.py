"""Parts of a space: ranges of ranks, shuffles, splits."""

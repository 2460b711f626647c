"""Tasks that are compared, and the files that comparisons write."""

"""The author's physical table: what the entities look like and where they stand, and the geometry of that."""

"""A dataset as a folder: tables in Parquet, what they are of, and how they are read."""

"""A dataset as a folder: Parquet tables, a manifest that describes them, and their readers and writers."""

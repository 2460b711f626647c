"""A folder on disk made into a Domain: read, checked, and written anew."""

"""Tasks written to files and read from them; one format a file."""

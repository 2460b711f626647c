"""Read the tasks to compare, and write the results to files."""

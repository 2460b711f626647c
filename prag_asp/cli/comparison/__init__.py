"""Read the tasks to be compared, and write the results to files."""

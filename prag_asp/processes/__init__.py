"""Worker processes and their limits, the memory of the machine, and progress events."""
